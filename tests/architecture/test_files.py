"""What holds for every file: no path of one machine, and every table is read and rectangular."""

import ast
import csv
import functools
import os
import re
import sys
import tempfile
from pathlib import Path

import pytest
from tests.architecture.sources import FOLDERS, ROOT, Function, package_of, trees


def _files(*suffixes: str) -> list[Path]:
    """Files of the project: those of its folders and those directly in the root."""
    folders = [*FOLDERS, "testplans", "tests", "docs", ".ci"]
    found = [path for path in ROOT.iterdir() if path.is_file() and path.name != ".git"]
    for folder in folders:
        found += (path for path in (ROOT / folder).rglob("*") if path.is_file())
    return [
        path
        for path in sorted(found)
        if "__pycache__" not in path.parts and (not suffixes or path.suffix in suffixes)
    ]


def _machine_paths() -> list[str]:
    """Folders of whatever machine this runs on; only those deep enough to be no common word."""
    candidates = {ROOT, Path.home(), Path(sys.prefix), Path(sys.base_prefix)}
    candidates.add(Path(tempfile.gettempdir()) / "w")
    return sorted(str(path) for path in candidates if len(path.parts) > 2)


# A home folder with a user's name in it, on any system
HOME = re.compile(r"(?<![\w.])(?:/(?:home|Users)/[a-z]\w*|[A-Za-z]:\\\\?Users\\)")


@pytest.mark.long
def test_no_file_names_a_folder_of_one_machine() -> None:
    known = _machine_paths()
    found = []
    for path in _files():
        text = path.read_bytes().decode("utf-8", errors="replace")
        for number, line in enumerate(text.splitlines(), 1):
            if any(name in line for name in known) or HOME.search(line):
                found.append(f"{path.relative_to(ROOT)}:{number}")
    assert found == []


@pytest.mark.skipif(os.name != "posix", reason="files have no run bit")
def test_a_file_that_begins_with_an_interpreter_can_be_run() -> None:
    scripts = [
        path
        for path in {*_files(), *(ROOT / "findings").iterdir()}
        if path.suffix in ("", ".sh") and path.read_bytes()[:2] == b"#!"
    ]
    assert len(scripts) > 1
    assert [str(path) for path in scripts if not os.access(path, os.X_OK)] == []


@pytest.mark.parametrize(
    ("line", "hit"),
    [
        ("see " + "/".join(["", "home", "anna", "rigs"]), True),
        ("C:" + "\\" + "Users" + "\\anna", True),
        ("docs/home/index.md", False),
        ("https://example.org/users/anna", False),
    ],
)
def test_home_folders_are_recognised(line: str, hit: bool) -> None:
    assert (HOME.search(line) is not None) is hit


@functools.cache
def _texts(package: str) -> set[str]:
    """The string constants in the code of a package, docstrings excepted."""
    found: set[str] = set()
    for module, tree in trees().items():
        if package_of(module) != package:
            continue
        described = {
            id(node.body[0].value)
            for node in ast.walk(tree)
            if isinstance(node, Function | ast.ClassDef | ast.Module)
            and node.body
            and isinstance(node.body[0], ast.Expr)
        }
        found |= {
            node.value.rpartition("/")[2]
            for node in ast.walk(tree)
            if isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and id(node) not in described
        }
    return found


# Reference results of the Modelica examples are for other tools (tests/fmus/test_examples.py)
FOR_OTHERS = "ReferenceResults"
TABLES = [
    path
    for path in _files(".csv")
    if path.relative_to(ROOT).parts[0] in FOLDERS and path.parent.name != FOR_OTHERS
]


@pytest.mark.parametrize("table", TABLES, ids=lambda path: path.name)
def test_every_table_that_ships_is_read_by_its_package(table: Path) -> None:
    assert table.name in _texts("axisrig." + table.relative_to(ROOT).parts[0])


@pytest.mark.parametrize("table", TABLES, ids=lambda path: path.name)
def test_every_table_has_a_rectangular_form(table: Path) -> None:
    rows = list(csv.reader(table.read_text(encoding="utf-8").splitlines()))
    assert len(rows) > 1
    assert len(set(rows[0])) == len(rows[0])
    assert {len(row) for row in rows} == {len(rows[0])}


def _always_true(line: str) -> bool:
    """Whether `assert a == b if c else [d]` stands for a value, not for a comparison, in a case."""
    try:
        (statement,) = ast.parse(line.strip()).body
    except SyntaxError:
        return False  # it goes on in the next line
    test = statement.test if isinstance(statement, ast.Assert) else None
    values = ast.List | ast.Tuple | ast.Dict | ast.Set | ast.Constant
    return isinstance(test, ast.IfExp) and any(
        isinstance(part, values) for part in (test.body, test.orelse)
    )


@pytest.mark.parametrize(
    ("line", "is_one"),
    [
        ("assert a == b if c else [d]", True),
        ("assert [d] if c else a == b", True),
        ("assert a == (b if c else [d])", False),
        ("assert a == b if c else d == e", False),
    ],
)
def test_an_assert_that_is_a_value_in_one_case_is_found(line: str, is_one: bool) -> None:
    assert _always_true(line) is is_one


def test_every_assert_of_a_choice_can_fail_on_both_sides() -> None:
    choice = re.compile(r"^ *assert .* if .* else .*$", re.MULTILINE)
    texts = {path: path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py")}
    found = {
        str(path.relative_to(ROOT)): line.strip()
        for path, text in texts.items()
        for line in choice.findall(text)
        if _always_true(line)
    }
    assert found == {}
