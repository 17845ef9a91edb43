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
