"""Import paths that users write: a page lists them, and they are there."""

import importlib
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| `(axisrig\.[a-z_.]+)` \| (.*?) \| ", PAGE, re.MULTILINE)
# Where users see an import of ours: pages, plans with their PLC programs, the rig of a new project
SHOWN = ("docs/*.md", "docs/*.ipynb", "testplans/**/*.py", "bench/**/template/**/*.py")
IMPORT = re.compile(r"from (axisrig\.[a-z_.]+) import (\([^)]*\)|[^\n\\\"#]+)")


@pytest.mark.parametrize(("path", "names"), ROWS)
def test_the_paths_of_the_page_are_there(path: str, names: str) -> None:
    module = importlib.import_module(path)
    for name in re.findall(r"`(\w+)`", names):
        assert hasattr(module, name), name


def test_what_users_are_shown_is_on_the_page() -> None:
    known = {(path, name) for path, names in ROWS for name in re.findall(r"`(\w+)`", names)}
    assert known
    for pattern in SHOWN:
        for file in ROOT.glob(pattern):
            text = file.read_text(encoding="utf-8")
            for path, names in IMPORT.findall(text):
                of_file = {(path, name) for name in re.findall(r"\w+", names)}
                missing = {pair for pair in of_file if path not in dict(ROWS)}
                assert missing == set(), file
