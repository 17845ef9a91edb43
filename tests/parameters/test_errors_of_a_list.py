"""What is refused of a list: place, value and what to write, for each kind of line."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import Kind, Origin, ParameterSet, list_text, read_list

Refused = Callable[..., UserError]
Sections = Callable[..., list[ParameterSet]]
UNITS_PER_VALUE = "a list has no units after its values; it counts in "


@pytest.mark.parametrize(
    ("line", "column", "message", "value", "hint"),
    [
        ('  "Z" 1', 1, "no parameter name", '"Z" 1', None),
        ("  kenngr.messachse=1", 3, "no `=` between name and value", "kenngr.messachse=1",
         "write `kenngr.messachse 1`"),
        ("kopf.log_achs_name=A=B", 1, "no `=` between name and value", "kopf.log_achs_name=A=B",
         "write `kopf.log_achs_name A=B`"),
        ("kenngr.messachse = 1", 18, "no `=` between name and value", "=",
         "write `kenngr.messachse 1`"),
        ("kenngr.messachse  =1", 19, "no `=` between name and value", "=1",
         "write `kenngr.messachse 1`"),
        ("\tkenngr.messachse  # 1", 2, "no value after the name", "kenngr.messachse", None),
        ("kenngr.hub_messtaster 5 mm", 25, "more than one value after the name", "mm",
         f"{UNITS_PER_VALUE}0.1 um"),
        ("kenngr.vb_messen  5   mm/s ; fast", 23, "more than one value after the name", "mm/s",
         f"{UNITS_PER_VALUE}um/s"),
        ("kenngr.messachse 1 se", 20, "more than one value after the name", "se",
         "a list has no units after its values"),
        ("kenngr.hub_messtaster 5 6 mm", 25, "more than one value after the name", "6 mm", None),
        ("kenngr.messachse 1 1", 20, "more than one value after the name", "1", None),
        ("kenngr.measure.signal PLC TIMESTAMP", 27, "more than one value after the name",
         "TIMESTAMP", "it means PLC_TIMESTAMP"),
    ],
)  # fmt: skip
def test_a_line_that_is_none_has_its_place_and_what_to_write(
    refused: Refused, line: str, column: int, message: str, value: str, hint: str | None
) -> None:
    error = refused(f"# first\n\n{line}\n")
    assert (error.line, error.column) == (3, column)
    assert (error.message, error.value, error.hint) == (message, value, hint)


@pytest.mark.parametrize(
    "before",
    ["/* one line */", "/* two\nlines */", "kopf.achs_nr 1 /* to\n\nthe end */", "# a /* b */\n"],
)
def test_a_comment_of_several_lines_leaves_lines_and_columns(refused: Refused, before: str) -> None:
    """The name behind it is where the editor shows it."""
    error = refused(f"{before} kenngr.mesachse 1\n")
    last = before.rpartition("\n")[2]
    assert (error.line, error.column) == (1 + before.count("\n"), len(last) + 2)


@pytest.mark.parametrize("count", [1, 4, 5, 9])
def test_of_more_than_four_errors_the_last_one_says_how_to_go_on(
    refused: Refused, tmp_path: Path, count: int
) -> None:
    error = refused("kenngr.mesachse 1\n" * count)
    found = [error, *error.further]
    assert [each.line for each in found] == list(range(1, count + 1))
    own = "nearest names: kenngr.messachse"
    way = f"`axisrig params known {tmp_path / 'list.lst'} > NEW` makes comments of these {count}"
    for each in found:
        assert str(each.hint).startswith(own)
        assert (way in str(each.hint)) is (count > 4 and each is found[-1])


def test_an_error_without_a_hint_gets_the_way_alone(refused: Refused, tmp_path: Path) -> None:
    *_, last = refused("kenngr.messachse\n" * 5).further
    way = f"`axisrig params known {tmp_path / 'list.lst'} > NEW` makes comments of these 5 lines"
    assert last.hint == way


@pytest.mark.parametrize(
    ("kind", "line", "hint"),
    [
        ("axis", "kenngr.messachse 1", "keep one; kopf.achs_nr begins the next axis"),
        ("channel", "messtyp 1", "keep one"),
    ],
)
def test_a_name_twice_says_which_line_has_it_already(
    refused: Refused, kind: Kind, line: str, hint: str
) -> None:
    error = refused(f"\n{line}\n#\n   {line}\n", kind)
    assert (error.line, error.column, error.hint) == (4, 4, hint)
    assert error.message == "parameter is already set in line 2"
    assert error.value == line.split(maxsplit=1)[0]


def test_each_axis_of_a_list_may_set_what_the_one_before_has_set(sections: Sections) -> None:
    """From the second number on; the third axis as well."""
    axis = "kopf.achs_nr {}\nkenngr.messachse 1\nkenngr.hub_messtaster {}\n"
    parts = sections("".join(axis.format(n, 100 * n) for n in (1, 2, 3)))
    assert [part.integer("kenngr.hub_messtaster") for part in parts] == [100, 200, 300]


def test_axes_without_a_name_are_no_choice(tmp_path: Path) -> None:
    path = tmp_path / "axes.lst"
    text = "kopf.achs_nr 1\nkopf.achs_nr 2\nkopf.log_achs_name Y\nkopf.achs_nr 3\n"
    path.write_text(text)
    for axis, message in (("Z", "none of them is Z"), (None, "none of them is meant")):
        with pytest.raises(UserError, match=message) as caught:
            read_list(path, "axis", axis)
        assert (caught.value.allowed, caught.value.file) == ("Y", str(path))
        assert caught.value.hint == (
            "kopf.log_achs_name after kopf.achs_nr says which part belongs to which axis"
        )
    path.write_text("kopf.achs_nr 1\nkopf.achs_nr 2\n")
    with pytest.raises(UserError) as caught:
        read_list(path, "axis", "Z")
    assert caught.value.allowed is None


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("'a'", "a"), ('"it\'s"', "it's"), ('"a b"', "a b"), ('"', '"'), ("'a\"", "'a\""),
        ("\"a b'", None), ('"a"b', None),
    ],
)  # fmt: skip
def test_a_text_in_quotes_ends_with_the_sign_it_begins_with(
    sections: Sections, refused: Refused, text: str, word: str | None
) -> None:
    """What is in no quotes is one word, with the signs that it has; None: it is no one value."""
    line = f"antr.function[0].id {text}\n"
    if word is None:
        assert refused(line).message == "more than one value after the name"
    else:
        (only,) = sections(line)
        assert only.word("antr.function[0].id") == word


def test_axes_of_a_written_list_are_apart() -> None:
    """A blank line between them, none before the first; numbers beside what has one."""
    parts = []
    for number in (3, 4):
        part = ParameterSet("axis")
        part.load("kopf.achs_nr", str(number), Origin("here", 1))
        parts.append(part)
    row = f"{'kopf.achs_nr':<56} {{:<16}}  # P-AXIS-00016\n"
    assert list_text(parts[0]) == "# axis parameter list\n" + row.format(3)
    assert list_text(parts) == f"# axis parameter list\n{row.format(3)}\n{row.format(4)}"


def test_a_list_that_cannot_be_read_is_named_with_the_reason_or_what_is_near_it(
    tmp_path: Path,
) -> None:
    (tmp_path / "axis.lst").touch()
    for name, hint in (
        ("axsi.lst", "there is no such file; near it: axis.lst"),
        ("", "Is a directory"),
    ):
        path = tmp_path / name
        with pytest.raises(UserError, match="parameter list cannot be read") as caught:
            read_list(path, "axis")
        assert (caught.value.file, caught.value.hint) == (str(path), hint)
