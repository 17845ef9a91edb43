"""Where the notebook about results is copied to, and that nothing is overwritten there."""

from pathlib import Path

import pytest

from axisrig.bench.tools.listings.documents import NOTEBOOK, copy_notebook, folder
from axisrig.kernel.errors import UserError

OWN = "what a user has written"


def test_into_a_folder_it_keeps_its_name(tmp_path: Path) -> None:
    path = copy_notebook(tmp_path)
    assert path == tmp_path / "results.ipynb"
    assert path.read_bytes() == (folder() / NOTEBOOK).read_bytes()
    assert list(tmp_path.iterdir()) == [path]


def test_a_path_that_is_no_folder_is_the_file_itself(tmp_path: Path) -> None:
    path = copy_notebook(tmp_path / "my study.ipynb")
    assert path == tmp_path / "my study.ipynb"
    assert path.read_bytes() == (folder() / NOTEBOOK).read_bytes()


@pytest.mark.parametrize("into", [".", NOTEBOOK, "mine.ipynb"])
def test_what_a_user_has_there_stays_as_it_is(tmp_path: Path, into: str) -> None:
    """Named as a folder, or as the file."""
    for name in (NOTEBOOK, "mine.ipynb"):
        (tmp_path / name).write_text(OWN, encoding="utf-8")
    there = tmp_path / (NOTEBOOK if into == "." else into)
    with pytest.raises(UserError, match="the file is there already") as caught:
        copy_notebook(tmp_path / into)
    assert caught.value.file == str(there)
    assert [path.read_text(encoding="utf-8") for path in sorted(tmp_path.iterdir())] == [OWN] * 2


def test_a_folder_of_the_name_of_the_notebook_is_one_that_it_goes_into(tmp_path: Path) -> None:
    """Where it would be inside once more, it is refused."""
    (tmp_path / NOTEBOOK).mkdir()
    with pytest.raises(UserError, match="there already"):
        copy_notebook(tmp_path)
    assert copy_notebook(tmp_path / NOTEBOOK) == tmp_path / NOTEBOOK / NOTEBOOK
    with pytest.raises(UserError, match="there already"):
        copy_notebook(tmp_path / NOTEBOOK)
