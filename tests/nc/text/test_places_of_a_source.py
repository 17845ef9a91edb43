"""A program text with its places: lines, columns, what is blanked, and the line of an error."""

import pytest

from axisrig.kernel.nc.text.source import BRACKET_DEPTH_MAX, EXCERPT_WIDTH, Source


def faults(text: str) -> list[tuple[int | None, int | None, str]]:
    return [(each.line, each.column, each.message) for each in Source(text, "p.nc").faults]


def shown(text: str, column: int) -> tuple[str, str]:
    """The line of an excerpt without its margin, and what the caret marks."""
    line, marks = (part[8:] for part in Source(text, None).excerpt(1, column).split("\n"))
    begin = marks.index("^")
    return line, line[begin : begin + marks.count("^")]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_every_end_of_a_line_counts_once(end: str) -> None:
    source = Source(end.join(["G0", "X1 Y2", "", "M30"]), None)
    places = [source.place(source.text.index(word)) for word in ("G0", "X1", "Y2", "M30")]
    assert places == [(1, 1), (2, 1), (2, 4), (4, 1)]
    assert [source.line(number) for number in (1, 2, 3, 4)] == ["G0", "X1 Y2", "", "M30"]


def test_a_place_and_its_offset_lead_to_each_other() -> None:
    source = Source("G0\n\nX1 Y2\nM30\n", None)
    for offset in range(len(source.text)):
        assert source.offset(*source.place(offset)) == offset


# The excerpt


@pytest.mark.parametrize("length", [1, 51, 80, EXCERPT_WIDTH])
def test_a_line_that_fits_is_shown_whole_wherever_the_place_is(length: int) -> None:
    text = "ABCDE " * 20
    for column in (1, 2, length):
        line, marked = shown(text[:length], column)
        assert line == text[:length]
        assert text[column - 1 :].startswith(marked)


def test_of_a_longer_line_the_part_around_the_place_is_shown() -> None:
    text = "".join(f"X{number:03}" for number in range(100))
    half = EXCERPT_WIDTH // 2
    for column in (1, half, half + 1, half + 2, 200, 399):
        begin = max(0, column - 1 - half)
        line, _ = shown(text, column)
        assert line == text[begin : begin + EXCERPT_WIDTH]


@pytest.mark.parametrize(
    ("text", "column", "marked"),
    [
        ("G1 X1.5Y2 F100", 4, "X1.5Y2"), ("G1 SINE[3]", 4, "SINE"), ("G1 X=?", 6, "?"),
        ("G1 [", 4, "["), ("V.P.NAME == 1", 1, "V.P.NAME"), ("#CS ON", 1, "#"),
    ],
)  # fmt: skip
def test_the_marks_are_under_the_whole_word(text: str, column: int, marked: str) -> None:
    assert shown(text, column) == (text, marked)


def test_marks_end_with_the_part_that_is_shown() -> None:
    """A word of 500 letters is marked as far as it is there; the end of a line has one mark."""
    for column in (1, 300):
        excerpt = Source("A" * 500, None).excerpt(1, column)
        line, marks = excerpt.split("\n")
        assert len(marks) <= len(line)
    assert Source("G1", None).excerpt(1, 3).split("\n")[1] == "      |   ^"


# What is blanked


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("G1 (c) X1", "G1     X1"), ("G1 (a (b) c) X1", "G1           X1"),
        ("G1 ((a) b) X1", "G1         X1"), ("G1 (a X1", "G1      "),
        ("G1 ; (a) X1", "G1         "), ("G1 ) X1", "G1 ) X1"),
        ("X=[1 (c) + 2]", "X=[1     + 2]"), ("X=[1\n+2]", "X=[1 +2]"),
        ('#MSG ["a (b) ; c"]', '#MSG ["a (b) ; c"]'), ("G1 \\\nX1", "G1   X1"),
        ("G1 \\\nN20 X1", "G1       X1"), ("X1\n(a\nY1", "X1\n  \nY1"),
    ],
)  # fmt: skip
def test_what_is_no_code_becomes_blanks_of_the_same_length(text: str, code: str) -> None:
    source = Source(text, None)
    assert (source.code, source.faults) == (code, [])


def test_a_long_comment_is_blanked_over_its_lines() -> None:
    source = Source("G1\n#COMMENT BEGIN\nX1 [\n# comment  end X2\nY1", None)
    assert source.code.split() == ["G1", "X2", "Y1"]
    assert [source.place(begin) for begin, _ in source.blocks()] == [(1, 1), (4, 16), (5, 1)]


# Faults


@pytest.mark.parametrize("depth", [1, BRACKET_DEPTH_MAX, BRACKET_DEPTH_MAX + 1])
def test_brackets_may_be_nested_so_deep_and_no_deeper(depth: int) -> None:
    text = "X=" + "[" * depth + "1" + "]" * depth
    too_deep = (1, 3 + BRACKET_DEPTH_MAX, "brackets are nested too deep")
    assert faults(text) == ([] if depth <= BRACKET_DEPTH_MAX else [too_deep])


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("X=[1+2\nN20 Y1", (1, 3)), ("X=[1+[2\nN20 Y1", (1, 6)), ("X=[1+[2]\nN20 Y1", (1, 3)),
        ("X=[1+2", (1, 3)), ("X=[1+[2", (1, 6)), ("G0\nX=[1+\n[2\nN5 Y1", (3, 1)),
        ("X=[1+[2]\nY=[3", (1, 3)),
    ],
)  # fmt: skip
def test_of_brackets_that_nothing_closes_the_innermost_is_named(
    text: str, place: tuple[int, int]
) -> None:
    """In its own line where all that follows would be inside."""
    found = faults(text)
    assert found[0] == (*place, "bracket is not closed in its block")


@pytest.mark.parametrize(
    ("text", "line", "column", "message"),
    [
        ("G0\nX1]", 2, 3, "no bracket is open here"),
        ('#MSG ["a]\nX1 "b"', 1, 7, "text is not closed on its line"),
        ('#MSG ["a', 1, 7, "text is not closed on its line"),
        ("G0\n#COMMENT END", 2, 1, "#COMMENT END without #COMMENT BEGIN"),
        ("G0\n #COMMENT BEGIN\nX1", 2, 2, "comment is not closed"),
        ("G0 \\ X1\nY1", 1, 4, "the block goes on with a line break after this sign only"),
        ("G0 \\", 1, 4, "the block goes on with a line break after this sign only"),
    ],
)
def test_each_fault_has_its_place(text: str, line: int, column: int, message: str) -> None:
    assert faults(text) == [(line, column, message)]


def test_the_line_of_a_fault_is_blanked_and_the_others_are_read() -> None:
    source = Source("G0 X1\nX2]\nG0 X3\nX=[1\nG0 X4\n", None)
    assert [fault.line for fault in source.faults] == [2, 4]
    assert source.code.split() == ["G0", "X1", "G0", "X3", "G0", "X4"]


def test_a_call_may_hold_backslashes() -> None:
    for text in ("L SUB\\PART.NC", "N10 L A\\B\\C.NC", "  l X\\Y"):
        assert Source(text, None).faults == []


@pytest.mark.parametrize(
    ("text", "blocks"),
    [
        ("G0 X1", ["G0 X1"]), ("  G0 X1  \n\n\tM30", ["G0 X1", "M30"]), ("", []), (" \n\n", []),
        ("X=[1\n +2] Y1\nM30", ["X=[1 +2] Y1", "M30"]), ("G0 \\\n  X1\nM30", ["G0 \\ X1", "M30"]),
        ("G0 X1 ; end", ["G0 X1"]),
    ],
)  # fmt: skip
def test_a_block_is_its_code_without_the_blanks_around_it(text: str, blocks: list[str]) -> None:
    source = Source(text, None)
    assert [source.block_text(*block) for block in source.blocks()] == blocks


@pytest.mark.parametrize(
    ("sign", "begin", "at"),
    [("$", 0, 4), ("$GOTO", 0, 10), ("$IF", 0, 4), ("?", 3, 3), ("X", 0, 0)],
)
def test_a_sign_is_looked_for_in_its_own_block(sign: str, begin: int, at: int) -> None:
    """Its begin where the block has none; the X is in the next block."""
    source = Source("N10 $if 1 $Goto [A]\nX1 $ELSE", None)
    assert source.place_of(sign, begin) == at
