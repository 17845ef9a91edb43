"""What pages say is true of the tables: what is missing, files, counts, licences."""

import re
import subprocess
import tomllib
from collections import defaultdict
from pathlib import Path

import pytest
from tests.docs.test_docs import DOCUMENTS

from axisrig.bench.plan.checks import known_metrics
from axisrig.bench.tools.listings.language import language_listing
from axisrig.fmus import MODELS

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text("utf-8")
# What a reader or a command makes: no file of the project
EXAMPLES = {"kernel.nc", "events.csv", "latches.csv", "ServoAxis_in.csv", "ServoAxis_ref.csv"}


def not_there_yet() -> dict[str, str]:
    """Rows of the README's table, by their subject."""
    section = README.partition("## What is not there yet")[2].partition("\n\nCAN adapters")[0]
    rows = [line.strip("| ").split(" | ") for line in section.splitlines() if line.startswith("| ")]
    return {row[0]: row[1] for row in rows if len(row) == 2}


def test_no_word_that_is_not_there_yet_acts() -> None:
    acting = {
        line.split("  ")[0].strip()
        for line in language_listing().splitlines()
        if line.strip() and "(-)" not in line
    }
    assert "#TRAFO" in acting  # else the test would see nothing
    named = set(re.findall(r"`([^`]+)`", " ".join(not_there_yet().values())))
    assert named
    assert not named & acting


def test_nothing_that_is_not_there_yet_has_metrics() -> None:
    """Each phrase of the table against the texts of the metrics."""
    texts = " ".join(
        " ".join(metric.meaning.lower().split()) for metric in known_metrics().values()
    )
    phrases = {
        re.sub(r"\(.*?\)|`.*?`", "", phrase).strip().lower()
        for row in not_there_yet().values()
        for phrase in re.split(r"[,;:]", row)
    }
    assert "3d distance control" in texts
    assert {phrase for phrase in phrases if len(phrase.split()) > 1 and phrase in texts} == set()


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_bare_file_name_is_one_file(path: Path) -> None:
    """One file of the project has it, or the page names the folder of the one it means."""
    if path.name == "CHANGELOG.md":
        pytest.skip("of what was")
    names = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    folders = defaultdict(set)
    for name in names:
        folder, _, last = name.rpartition("/")
        folders[last].add(folder)
    page = path.read_text("utf-8")
    bare = set(re.findall(r"`([\w-]+\.(?:py|mo|csv|toml|nc|lst|md|c|cyc|lark|jinja))`", page))
    for name in sorted(bare - EXAMPLES):
        here = folders[name]
        assert here, f"{name} is no file"
        named = [folder for folder in here if f"{folder.rpartition('/')[2]}/" in page]
        assert len(here) == 1 or named, f"{name}: which of {here}?"


COUNTED = r"\b(\d+|two|three|four|five|six|seven|eight|nine|ten|eleven|twelve|twenty)"


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_page_does_not_count_what_a_table_counts(path: Path) -> None:
    """A typed number of models, sources, profiles or plans is wrong after the next one."""
    if path.name in ("CHANGELOG.md", "performance.md") or "decisions" in path.parts:
        pytest.skip("of one day")
    page = path.read_text("utf-8")
    what = r"(shipped models|models of the library|signal sources|drive profiles|shipped plans)"
    assert re.findall(rf"{COUNTED} {what}\b", page) == []
    assert re.findall(rf"\ball {COUNTED} \|", page) == []
    assert re.findall(rf"\[{COUNTED} (?:sources|profiles|models|plans)\]", page) == []
    assert len(MODELS) > 1


def test_the_licences_are_those_of_the_packages() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    wanted = [*project["dependencies"]]
    for extra in project["optional-dependencies"].values():
        wanted += extra
    names = {re.split(r"[<>=\[ ]", line)[0].lower() for line in wanted}
    section = README.partition("## Licences")[2].lower()
    words = set(re.findall(r"[\w.-]+", section))
    assert {name for name in names if name not in words} == set()
