"""What each command loads: a heavy library costs every call of it a tenth of a second and more."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
HEAVY = (
    "can",
    "canopen",
    "fmpy",
    "jinja2",
    "lark",
    "matplotlib",
    "numpy",
    "pandas",
    "pyarrow",
    "pydantic",  # the parser of the command line loads it for options
    "rich",
    "rumoca",
    "scipy",
)
READING = {"lark", "numpy", "pydantic"}
RIG = {*READING, "can", "canopen"}
MACHINE = {*RIG, "fmpy", "pyarrow"}
PLANS, RIGS, PROGRAMS = "testplans", "testplans/rigs", "testplans/programs"

COMMANDS = [
    ("--help", set()),
    ("run --help", {"pydantic"}),
    ("errors", {"pydantic"}),
    ("explain 50059", {"pydantic"}),
    ("metrics", {"pydantic"}),
    ("objects", {"pydantic"}),
    ("drives", {"pydantic"}),
    ("faults", {"pydantic", "can", "canopen"}),
    ("language G100", {"pydantic", "lark"}),
    (f"nc --check {PROGRAMS}/meas1.nc", READING),
    ("params kenngr.messachse", RIG),
    ("fmu list", RIG),
    (f"check {RIGS}/probe-z.toml", MACHINE),
    (f"check {PLANS}/manual_examples.csv", MACHINE),
    (f"nc {PROGRAMS}/meas1.nc --rig {RIGS}/probe-xyz.toml --check", RIG),
]
RUN = f"run {PLANS}/distance_control.csv -k dead-2ms-1 --fresh -o"


@pytest.mark.long
@pytest.mark.parametrize(("line", "allowed"), COMMANDS, ids=[line for line, _ in COMMANDS])
def test_a_command_loads_no_more_than_it_needs(line: str, allowed: set[str]) -> None:
    assert loaded(line.split()) <= allowed


@pytest.mark.long
def test_a_run_with_its_report_does_without_pandas_and_scipy(tmp_path: Path) -> None:
    assert loaded([*RUN.split(), str(tmp_path / "out")]) <= {*MACHINE, "rich", "jinja2"}


def loaded(arguments: list[str]) -> set[str]:
    """Run a command in a process of its own and return what it has loaded of the heavy ones."""
    code = (
        "import sys\nfrom axisrig.bench.cli.main import main\n"
        f"sys.argv = {['axisrig', *arguments]}\n"
        f"try: main()\nexcept SystemExit as end: assert not end.code\n"
        f"print([name for name in {HEAVY} if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return set(ast.literal_eval(done.stdout.splitlines()[-1]))


def test_help_has_the_first_sentence_of_every_command_whole() -> None:
    command = [sys.executable, "-m", "axisrig.bench.cli", "--help"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    text = " ".join(done.stdout.split())
    assert "..." not in text.partition("Commands:")[2]
    assert "check Check plans, rigs and lists without running them" in text
