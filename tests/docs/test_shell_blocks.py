"""What README and docs/plans.md print can be typed: commands run, and tables are plans."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from axisrig.bench.plan.plan import read_plan

ROOT = Path(__file__).parents[2]
LINES_MAX = 150
_BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NOT_RUN = {
    "sudo": "installs packages of the system",
    "make": "its targets are those of the Makefile, which `make test` and `make demo` run",
    "python3": "makes an environment",
    ".venv/bin/pip": "loads packages from an index",
    "--interface": "serves until Ctrl-C; tests/hardware/two_processes runs it",
    "demo": "takes minutes; tests/cli/test_main_commands.py has its options",
}
"""A word of a command -> why it is not run here."""
FAILS = {"--set set:Z.kenngr.measure.edge=NEG": 1}
"""What the page says does not pass -> the exit code."""


def blocks(name: str) -> Iterator[tuple[str, str]]:
    """Language and text of the blocks of a page."""
    for match in _BLOCK.finditer((ROOT / name).read_text("utf-8")):
        yield match[1], match[2]


def commands(text: str) -> list[str]:
    """The command lines of a block without prompts and comments, as far as they are run here."""
    lines = [line.removeprefix("$ ") for line in text.splitlines()]
    found = [line.partition("  #")[0].strip() for line in lines if re.match(r"[\w./]+ ", line)]
    kept = [line for line in found if re.match(r"(\.venv/bin/)?\w+ ", line)]
    return [line for line in kept if not any(word in line.split() for word in NOT_RUN)]


def shell_blocks(name: str) -> list[list[str]]:
    """The commands of each block with some; a prompt, or `axisrig` at the begin, makes it one."""
    texts = [text for language, text in blocks(name) if language in ("", "sh", "bash")]
    shell = [
        text for text in texts if re.search(r"^(\$ |axisrig |\.venv/bin/)", text, re.MULTILINE)
    ]
    return [found for text in shell if (found := commands(text))]


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that looks like the checkout, with the command of this environment."""
    shutil.copytree(ROOT / "testplans", tmp_path / "testplans", ignore=lambda *_: {"__pycache__"})
    bin_folder = Path(sys.executable).parent
    (tmp_path / ".venv").mkdir()
    (tmp_path / ".venv" / "bin").symlink_to(bin_folder)
    monkeypatch.setenv("PATH", f"{bin_folder}{os.pathsep}{os.environ['PATH']}")
    return tmp_path


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="needs a shell of Unix")
@pytest.mark.parametrize(
    "name", ["README.md", "docs/plans.md", "docs/campaigns.md", "docs/install.md"]
)
def test_the_commands_of_a_page_run_as_printed(checkout: Path, name: str) -> None:
    for block in shell_blocks(name):
        script = "\n".join(["set -e", *block])
        done = subprocess.run(
            ["bash", "-c", script],
            cwd=checkout, capture_output=True, text=True, check=False, timeout=600,
        )  # fmt: skip
        expected = next((code for word, code in FAILS.items() if word in script), 0)
        assert done.returncode == expected, f"{script}\n{done.stdout}\n{done.stderr}"
        assert "Traceback" not in done.stderr


def test_the_readme_has_its_project_its_program_and_its_row() -> None:
    lines = [line for block in shell_blocks("README.md") for line in block]
    for begin in ("axisrig new", "axisrig run testplans/touch.csv", "axisrig drive",
                  ".venv/bin/axisrig nc", ".venv/bin/axisrig run"):  # fmt: skip
        assert any(line.startswith(begin) for line in lines), begin
    assert len((ROOT / "README.md").read_text("utf-8").splitlines()) < LINES_MAX


def test_the_tables_of_the_page_about_plans_are_plans(tmp_path: Path) -> None:
    tables = [text for _, text in blocks("docs/plans.md") if text.startswith("case,")]
    assert len(tables) >= 3
    for name in ("probe-z.nc", "probe-z.toml"):
        (tmp_path / name).touch()
    (tmp_path / "more").mkdir()
    (tmp_path / "more" / "edges.csv").write_text(
        "case,program\nneg,../probe-z.nc\n", encoding="utf-8"
    )
    for number, text in enumerate(tables):
        path = tmp_path / f"table{number}.csv"
        path.write_text(text, encoding="utf-8")
        assert read_plan(path).cases


def test_the_ci_file_of_a_project_installs_from_where_its_owner_says() -> None:
    template = ROOT / "bench/axisrig/bench/tools/project/template"
    text = (template / "dot-github/workflows/bench.yml").read_text("utf-8")
    installs = re.findall(r"pip install (.*)", text)
    assert installs == ['"$AXISRIG" pytest']
    assert "AXISRIG: ${{ vars.AXISRIG }}" in text
