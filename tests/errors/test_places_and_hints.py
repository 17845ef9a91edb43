"""How errors name a place, several things that are wrong, and what may have been meant."""

from pathlib import Path

import pytest

from axisrig.kernel.errors import (
    Alarm,
    UserError,
    catalogue,
    cell_name,
    near_files,
    nearest,
    place_text,
    printable,
    same_cause,
    together,
    why_unread,
)


@pytest.mark.parametrize(
    ("row", "column", "name"),
    [
        (1, 1, "A1"), (7, 2, "B7"), (1, 25, "Y1"), (1, 26, "Z1"), (3, 27, "AA3"), (3, 52, "AZ3"),
        (3, 53, "BA3"), (9, 702, "ZZ9"), (9, 703, "AAA9"), (1048576, 16384, "XFD1048576"),
    ],
)  # fmt: skip
def test_a_cell_has_the_name_that_its_program_shows(row: int, column: int, name: str) -> None:
    """The last one is the last cell that a workbook of Excel may have."""
    assert cell_name(row, column) == name


@pytest.mark.parametrize(
    ("file", "line", "column", "place"),
    [
        ("plan.csv", 3, 1, "plan.csv:3:1"), ("plan.csv", 3, None, "plan.csv:3"),
        ("plan.csv", None, None, "plan.csv"), (None, 3, 1, "3:1"), (None, None, None, ""),
        ("plan.xlsx", 3, 1, "plan.xlsx:A3"), ("plan.ods", 3, 28, "plan.ods:AB3"),
        ("PLAN.XLSX", 3, 2, "PLAN.XLSX:B3"), ("plan.xlsx", 3, None, "plan.xlsx:3"),
        ("plan.xlsx", None, None, "plan.xlsx"), ("plan.xlsx.csv", 3, 1, "plan.xlsx.csv:3:1"),
    ],
)  # fmt: skip
def test_a_place_is_written_as_its_reader_finds_it(
    file: str | None, line: int | None, column: int | None, place: str
) -> None:
    assert place_text(file, line, column) == place
    error = UserError("it is wrong", file=file, line=line, column=column)
    assert str(error) == (f"{place}: it is wrong" if place else "it is wrong")


@pytest.mark.parametrize(
    ("details", "text"),
    [
        ({"value": "x"}, "wrong; found 'x'"), ({"value": 0}, "wrong; found 0"),
        ({"value": ""}, "wrong; found ''"), ({"allowed": "1 .. 2"}, "wrong; allowed: 1 .. 2"),
        ({"allowed": ["a", 2]}, "wrong; allowed: a, 2"), ({"hint": "do so"}, "wrong; do so"),
        ({"allowed": nearest("drip", ["drop", "x"])}, "wrong; did you mean: drop"),
        ({"value": 1.5, "allowed": "2", "hint": "do so"},
         "wrong; found 1.5; allowed: 2; do so"),
    ],
)  # fmt: skip
def test_what_is_known_is_written_in_its_order(details: dict[str, object], text: str) -> None:
    assert str(UserError("wrong", **details)) == text  # type: ignore[arg-type]


@pytest.mark.parametrize("length", [77, 78, 79, 200])
def test_a_long_value_is_cut_after_80_signs(length: int) -> None:
    """With its quotes; 78 letters have room."""
    shown = str(UserError("wrong", value="x" * length)).removeprefix("wrong; found ")
    assert shown == (f"'{'x' * length}'" if length <= 78 else f"'{'x' * 79}...")


def test_errors_of_one_file_are_all_in_the_first_in_their_order() -> None:
    """Also those that an error has behind it already."""
    a, b, c, d = (UserError(name) for name in "abcd")
    b.further = (c,)
    whole = together([a, b, d])
    assert whole is a
    assert [error.message for error in whole.further] == ["b", "c", "d"]
    assert together([d]) is d
    assert d.further == ()


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("plain äµ€", "plain äµ€"), ("a\tb\nc", "a b c"), ("\x1b[31mred", " [31mred"),
        ("a\u202eb", "a b"), ("a\u00a0b", "a b"), ("", ""),
    ],
)  # fmt: skip
def test_a_foreign_text_steers_no_terminal_and_keeps_its_length(text: str, shown: str) -> None:
    assert printable(text) == shown
    assert len(printable(text)) == len(text)


@pytest.mark.parametrize(
    ("word", "names"),
    [
        ("DROP", ["drop"]), ("aLTER", ["Alter"]), ("altr", ["Alter"]), ("zzz", []),
        ("tool_1", ["tool_1", "tool_2", "tool_3"]), ("limit", ["LIMIT"]), ("Limt", ["LIMIT"]),
    ],
)  # fmt: skip
def test_nearest_names_are_as_they_are_spelled_whatever_their_case(
    word: str, names: list[str]
) -> None:
    """Best first, three at most."""
    known = ["drop", "Alter", "LIMIT", "tool_3", "tool_2", "tool_1", "tool_4"]
    found = nearest(word, known)
    assert found[:1] == names[:1]
    assert len(found) == len(names)


def test_one_guess_may_be_asked_for() -> None:
    assert nearest("tool_1", ["tool_1", "tool_2"], count=1) == ["tool_1"]


# Files


def test_a_hint_for_a_missing_file_names_what_is_near_it(tmp_path: Path) -> None:
    (tmp_path / "rigs").mkdir()
    (tmp_path / "rigs" / "probe-z.toml").touch()
    assert near_files(tmp_path, "rigs/probe-y.toml") == "near it: probe-z.toml"
    assert near_files(tmp_path, "rigs/QQQ") == f"looked in {tmp_path / 'rigs'}"
    for folder in ("rigs", "rigs/", str(tmp_path / "rigs"), "."):
        assert near_files(tmp_path, folder) == "it is a folder"
    assert near_files(tmp_path, "rig") == "near it: rigs"
    assert near_files(tmp_path, "none/probe-z.toml") == f"looked in {tmp_path / 'none'}"
    assert near_files(tmp_path, "") == f"looked in {tmp_path}"  # and not: it is a folder


def test_a_path_with_backslashes_is_written_with_slashes(tmp_path: Path) -> None:
    (tmp_path / "rigs").mkdir()
    (tmp_path / "rigs" / "probe-z.toml").touch()
    right = "folders are separated by /: rigs/probe-z.toml"
    assert near_files(tmp_path, "rigs\\probe-z.toml") == right
    assert near_files(tmp_path, "rigs\\probe-y.toml") == "near it: probe-z.toml"
    assert near_files(tmp_path, "rigs/probe-z.toml") == "near it: probe-z.toml"


def test_why_a_file_is_not_read(tmp_path: Path) -> None:
    """The words of the system without its number; a missing one with what is near."""
    near = str(tmp_path / "a.toml")
    (tmp_path / "b.toml").touch()
    missing = why_unread(near, FileNotFoundError(2, "No such file or directory", near))
    assert missing == "there is no such file; near it: b.toml"
    assert why_unread(near, PermissionError(13, "Permission denied", near)) == "Permission denied"
    assert why_unread(near, IsADirectoryError(21, "Is a directory")) == "Is a directory"
    assert why_unread(near, OSError("odd")) == "odd"


# Alarms


def test_ids_of_one_cause_are_reported_under_the_older_one() -> None:
    for older, newer in ((70329, 310018), (110757, 110657), (110604, 315000)):
        assert same_cause(older) == same_cause(newer) == older
        assert catalogue()[older].relation == f"Newer builds report {newer}."
        assert catalogue()[newer].relation == f"Older builds report {older}."
    assert (same_cause(20008), catalogue()[20008].relation) == (20008, "")
    assert same_cause(123) == 123  # an unknown one


def test_a_place_is_given_to_an_alarm_once() -> None:
    alarm = Alarm(20008, word="G1")
    placed = alarm.at("N10")
    assert (alarm.place, placed.place, placed.at("N20").place) == (None, "N10", "N10")
    assert placed.at("N20") is placed
    assert (placed.id, placed.values) == (20008, {"word": "G1"})
    assert " (N10)." in str(placed)
    assert "(" not in str(alarm).partition(". ")[0]


@pytest.mark.parametrize("values", [{}, {"words": "G1"}])
def test_an_alarm_without_its_values_is_a_defect(values: dict[str, object]) -> None:
    with pytest.raises(KeyError):
        Alarm(20008, **values)
    with pytest.raises(KeyError):
        Alarm(1, word="G1")
