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
    lines = path.read_text("utf-8").splitlines()
    # The first column of the changelog's tables has names that are gone
    text = "\n".join(
        line.partition(" | ")[2] if path.name == "CHANGELOG.md" else line for line in lines
    )
    named = set(re.findall(r"`((?:kernel|bench|fmus|reports|testplans)/[\w./-]+\.\w+)`", text))
    assert {name for name in named if not (ROOT / name).exists()} == set()


def test_the_index_leads_to_every_page() -> None:
    """Once each, the decisions too; the README leads to the index."""
    text = (ROOT / "docs" / "index.md").read_text("utf-8")
    linked = re.findall(r"^- \[.*?\]\(([\w./-]+\.md)\)", text, re.MULTILINE)
    inside = sorted(link for link in linked if not link.startswith("../"))
    pages = [path.relative_to(ROOT / "docs") for path in (ROOT / "docs").rglob("*.md")]
    assert inside == sorted(page.as_posix() for page in pages if page.name != "index.md")
    assert "(docs/index.md)" in (ROOT / "README.md").read_text("utf-8")


@pytest.mark.parametrize("name", ["README.md", "docs/commands.md", "docs/index.md"])
def test_commands_in_the_documents_exist(name: str) -> None:
    known = {
        (command.name or command.callback.__name__).replace("_", "-")  # type: ignore[union-attr]
        for command in app.registered_commands
    } | {group.name for group in app.registered_groups}
    text = (ROOT / name).read_text("utf-8")
    assert set(re.findall(r"(?:`|\$ |bin/|^)axisrig ([a-z-]+)", text, re.MULTILINE)) <= known


def test_targets_of_make_in_the_documents_exist() -> None:
    makefile = (ROOT / "Makefile").read_text("utf-8")
    for name in ("README.md", "CONTRIBUTING.md", "docs/index.md"):
        text = (ROOT / name).read_text("utf-8")
        for target in re.findall(r"(?:`|^)make ([a-z-]+)", text, re.MULTILINE):
            assert f"\n{target}:" in makefile, f"{name}: make {target}"


def test_the_first_screen_of_the_readme_answers_the_first_questions() -> None:
    """A verdict, a sample, one picture, three numbers with their proof, and the two commands."""
    first, _, rest = (ROOT / "README.md").read_text("utf-8").partition("\n## ")
    assert first.count("![") == 1
    assert "docs/sample-report/report.html" in first
    assert "make demo" in first
    assert "make test" in first
    assert rest.startswith("A virtual drive")


def test_the_numbers_of_the_readme_are_those_of_the_pages() -> None:
    first = (ROOT / "README.md").read_text("utf-8").partition("\n## ")[0]
    for number, name, proof in (
        ("0.5 ns", "architecture.md", "The 0.5 ns of axisrig"),
        ("63 runs", "reference-fmus.md", "all 63 runs are equal bit for bit"),
        ("83 620 scenarios", "reliability.md", "| `all` | 1 | 83620 |"),
        ("what no control can know", "measuring-sources.md", "## What no control can know"),
    ):
        assert number in first
        assert proof in (ROOT / "docs" / name).read_text("utf-8")
