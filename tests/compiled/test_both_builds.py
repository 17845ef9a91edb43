"""The compiled build does what the interpreted one does: every shipped run, and fault scenarios.

What they compare does not come from either: a run of one against the same run of the other, byte by
byte. The interpreted runs are those of `pytest testplans`, which judges every row, statistics too;
so `make test-rest` runs plans here only.

`make fast` makes the compiled build; without it, or when it is of other sources, these tests are
skipped; with `--by-compiled`, as `make test-rest` has it, they fail.
"""

import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PLANS = sorted((ROOT / "testplans").glob("*.csv"))
PARTS = 16
"""Plans of a part run in one process: starting one, and its report, take longer than many rows.

Not in few parts: one that begins at the end of the time of `--until` runs to its own end.
"""
COMPILED = ROOT / ".venv-fast/bin/python"
SCENARIOS, BLOCK = 300, 50
HASHES = Path(__file__).with_name("scenario_hashes.py")
POSES = Path(__file__).with_name("kinematics_hashes.py")

pytestmark = pytest.mark.long


def _output(python: Path, *words: object) -> str:
    ended = subprocess.run(
        [str(python), *map(str, words)], cwd=ROOT, capture_output=True, text=True, check=False,
        env={key: value for key, value in os.environ.items() if not key.startswith("PYTHON")},
    )  # fmt: skip
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


@cache
def _build(python: Path) -> tuple[bool, str]:
    """Whether a build is compiled, and the hash of its sources."""
    program = (
        "import json; from axisrig.bench.campaign.results import build_info as b;"
        " print(json.dumps([b.is_compiled(), b.sources_sha256()]))"
    )
    is_compiled, sources = json.loads(_output(python, "-c", program))
    return is_compiled, sources


@pytest.fixture(scope="module")
def builds(request: pytest.FixtureRequest) -> tuple[Path, Path]:
    """Return the interpreters of the interpreted and of the compiled build."""
    interpreted = Path(sys.executable)
    missing = pytest.fail if request.config.getoption("--by-compiled") else pytest.skip
    if not COMPILED.exists():
        missing("there is no compiled build: make fast")
    if _build(COMPILED)[1] != _build(interpreted)[1]:
        missing("the compiled build is of other sources: rm .venv-fast/.installed; make fast")
    assert [_build(interpreted)[0], _build(COMPILED)[0]] == [False, True]
    return interpreted, COMPILED


def _files(folder: Path) -> dict[str, bytes]:
    """What a campaign leaves of its runs, without what contains wall time."""
    kept = [folder / "results.csv"]
    for room in ("bus", "runs", "traces"):
        kept += (folder / room).iterdir()
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(kept)}


@pytest.mark.parametrize("part", range(PARTS))
def test_every_shipped_run_leaves_the_same_bytes(
    builds: tuple[Path, Path], part: int, tmp_path: Path
) -> None:
    """And every row of it passes."""
    plans = PLANS[part::PARTS]
    by_pytest, by_run = tmp_path / "interpreted", tmp_path / "compiled"
    pytest_words = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "tests.both_writers")
    _output(builds[0], *pytest_words, *plans, "--axisrig-out", by_pytest)
    _output(builds[1], "-m", "axisrig.bench.cli", "run", "-j", 1, *plans, "-o", by_run)
    interpreted, compiled = _files(by_pytest), _files(by_run)
    assert len(interpreted) > 3 * len(plans)
    assert interpreted.keys() == compiled.keys()
    assert [name for name in interpreted if interpreted[name] != compiled[name]] == []


@pytest.mark.parametrize("first", range(0, SCENARIOS, BLOCK))
def test_fault_scenarios_are_the_same(builds: tuple[Path, Path], first: int) -> None:
    interpreted, compiled = (_output(python, HASHES, first, BLOCK) for python in builds)
    assert len(interpreted.splitlines()) == BLOCK
    assert interpreted == compiled


def test_kinematics_give_the_same_bits(builds: tuple[Path, Path]) -> None:
    interpreted, compiled = (_output(python, POSES, 1000) for python in builds)
    assert len(interpreted.splitlines()) > 5
    assert interpreted == compiled
