"""The documents as a command shows them: a list, a page, the notebook."""

from pathlib import Path

import pytest

from axisrig.bench.tools.listings import documents
from axisrig.kernel.errors import UserError

DOCS = Path(__file__).parents[2] / "docs"


def test_each_page_is_listed_with_its_title() -> None:
    known = documents.pages()
    assert set(known) == {path.stem for path in DOCS.glob("*.md")}
    assert known["report"] == "The report"
    assert all(known.values())
    folder = Path(documents.listing().splitlines()[0])  # of the checkout, or of the wheel
    assert folder == documents.page("report").parent


def test_a_page_is_found_by_its_name_and_a_wrong_one_has_near_names() -> None:
    found = documents.page("plans")
    assert found == documents.page("plans.md")
    assert found.read_bytes() == (DOCS / "plans.md").read_bytes()
    with pytest.raises(UserError, match="no such page") as error:
        documents.page("planz")
    assert "plans" in str(error.value)


def test_the_notebook_is_copied_and_overwrites_nothing(tmp_path: Path) -> None:
    path = documents.copy_notebook(tmp_path)
    assert path.read_bytes() == (DOCS / "results.ipynb").read_bytes()
    with pytest.raises(UserError, match="there already"):
        documents.copy_notebook(path)


@pytest.mark.interpreted
def test_pages_are_listed_in_alphabetical_order_below_their_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Titles begin in one column, behind the longest name; a page without one has none."""
    for name, text in (
        ("rigs", "# Rigs and all that\n\n# Another\n"), ("a-long-name", "words\n# Long\n"),
        ("bare", "no title\n"), ("index", "# Here\n"),
    ):  # fmt: skip
        (tmp_path / f"{name}.md").write_text(text, encoding="utf-8")
    (tmp_path / "notes.txt").write_text("# No page\n", encoding="utf-8")
    monkeypatch.setattr(documents, "folder", lambda: tmp_path)
    assert [line.rstrip() for line in documents.listing().splitlines()] == [
        str(tmp_path), "a-long-name  Long", "bare", "index        Here",
        "rigs         Rigs and all that",
    ]  # fmt: skip


@pytest.mark.parametrize("name", ["planz", "planz.md"])
def test_only_near_pages_are_offered_for_a_wrong_name(name: str) -> None:
    with pytest.raises(UserError, match="no such page") as error:
        documents.page(name)
    offered = str(error.value.allowed).split(", ")
    assert "plans" in offered
    assert len(offered) < 5 < len(documents.pages())
    assert error.value.value == name
    with pytest.raises(UserError, match="no such page") as error:
        documents.page("qqqqqqqqqqqq")
    assert error.value.allowed is None
    assert error.value.hint == "`axisrig docs` lists the pages"


def test_the_notebook_goes_into_a_folder_or_a_file_of_its_own_name(tmp_path: Path) -> None:
    """What is there already is named, in a folder too, and stays as it is."""
    own = tmp_path / "own.ipynb"
    assert documents.copy_notebook(own) == own
    assert documents.copy_notebook(tmp_path) == tmp_path / "results.ipynb"
    for into, there in ((tmp_path, tmp_path / "results.ipynb"), (own, own)):
        there.write_text("mine", encoding="utf-8")
        with pytest.raises(UserError, match="there already") as error:
            documents.copy_notebook(into)
        assert error.value.file == str(there)
        assert there.read_text(encoding="utf-8") == "mine"


def test_a_wheel_has_them_inside_the_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(documents.resources, "files", lambda _: tmp_path)
    (tmp_path / "documents").mkdir()
    (tmp_path / "documents" / "index.md").write_text("# Here\n", encoding="utf-8")
    assert documents.pages() == {"index": "Here"}
    (tmp_path / "documents" / "index.md").unlink()
    with pytest.raises(UserError, match="documents are missing"):
        documents.folder()


@pytest.mark.parametrize(
    ("text", "title"),
    [
        ("# One\n\n## Part\n", "One"),
        ("A word before.\n\n## Part\n\n# One\n\n# Two\n", "One"),
        ("#no title\n# One # two\n", "One # two"),
        ("## Part\n\nwithout one\n", ""),
        ("", ""),
    ],
)
def test_the_title_of_a_page_is_its_first_heading_of_the_highest_level(
    text: str, title: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(documents.resources, "files", lambda _: tmp_path)
    (tmp_path / "documents").mkdir()
    (tmp_path / "documents" / "index.md").write_text(text, encoding="utf-8")
    assert documents.pages() == {"index": title}
    assert documents.listing().splitlines() == [str(tmp_path / "documents"), f"index  {title}"]
