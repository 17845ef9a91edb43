"""The documents do not lead astray: links, test names and commands in them exist."""

import re
from pathlib import Path

import pytest

from axisrig.bench.cli.main import app

ROOT = Path(__file__).parents[2]
DOCUMENTS = sorted(
    path
    for path in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("fmus/*.md")]
    if ".venv" not in path.parts
)
TESTS = "\n".join(path.read_text("utf-8") for path in ROOT.glob("tests/**/test_*.py"))


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_relative_links_lead_somewhere(path: Path) -> None:
    text = path.read_text("utf-8")
    targets = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text)
    missing = [t for t in targets if "://" not in t and not (path.parent / t).exists()]
    assert not missing


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_tests_that_a_document_names_exist(path: Path) -> None:
    text = path.read_text("utf-8")
    functions = set(re.findall(r"`(test_\w+)`", text))
    assert {name for name in functions if f"def {name}" not in TESTS} == set()
    places = set(re.findall(r"`(tests/[\w./]+)`", text))
    assert {place for place in places if not (ROOT / place).exists()} == set()


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_files_that_a_document_names_exist(path: Path) -> None:
    text = path.read_text("utf-8")
    named = set(re.findall(r"`((?:kernel|bench|fmus|reports|testplans)/[\w./-]+\.\w+)`", text))
    assert {name for name in named if not (ROOT / name).exists()} == set()


def test_the_readme_leads_to_every_page() -> None:
    section = (ROOT / "README.md").read_text("utf-8").split("## Where to read on")[1]
    linked = re.findall(r"\]\((docs/[\w-]+\.md)\)", section.split("\n## ")[0])
    pages = [f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md")]
    assert sorted(linked) == sorted(pages)


def test_commands_in_the_readme_exist() -> None:
    known = {
        command.name or command.callback.__name__  # type: ignore[union-attr]
        for command in app.registered_commands
    } | {group.name for group in app.registered_groups}
    text = (ROOT / "README.md").read_text("utf-8")
    assert set(re.findall(r"axisrig ([a-z]+)\b", text)) - {"is"} <= known
