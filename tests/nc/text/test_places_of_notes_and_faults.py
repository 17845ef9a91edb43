"""Where a word stands that does not act, and what is blanked around a fault over several lines."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import Command
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.nc.text.source import Source
from axisrig.kernel.nc.text.words import commands

XYZ = ("X", "Y", "Z")


def notes(text: str) -> list[tuple[str, str, int, int]]:
    blocks = parse_program(text, file="p.nc", axes=XYZ).blocks
    return [(n.word, n.what, n.line, n.column) for block in blocks for n in block.not_acting]


# Words that do not act


@pytest.mark.parametrize(
    ("text", "name", "words"),
    [
        ("X[INDP_SYN G0 POS=1 DRY_RUN]", "<axis>INDP_SYN", ("DRY_RUN",)),
        ("X[INDP_ASYN DRY_RUN G0 POS=1]", "<axis>INDP_ASYN", ("DRY_RUN",)),
        ("N10 #MEAS [TRIGGER]", "MEAS", ("TRIGGER",)),
        ("#DRIVE WR SYN [AX=X KEY=A MOTOR=1 VAL=1 PARAM_SET=2]", "DRIVE WR SYN",
         ("MOTOR", "PARAM_SET")),
        ("  #DIST CTRL [ON AX2=Y MIN_MEAS_DIST=0.5]", "DIST CTRL", ("AX2", "MIN_MEAS_DIST")),
        ("Y[DIST_CTRL ON MAX_MEAS_DIST=5 AX1=X]", "<axis>DIST_CTRL", ("MAX_MEAS_DIST", "AX1")),
        ("L CYCLE [NAME=A.NC MODAL_MOVE]", "L CYCLE", ("MODAL_MOVE",)),
    ],
)  # fmt: skip
def test_each_keyword_that_does_not_act_is_noted_where_it_stands(
    text: str, name: str, words: tuple[str, ...]
) -> None:
    found = notes(f"G0 X1\n{text}\nG0 X2")
    assert [(what, line, column) for _, what, line, column in found] == [
        (commands()[name][word].meaning, 2, text.index(word) + 1) for word in words
    ]
    assert [shown.rpartition("[")[2] for shown, *_ in found] == [f"{word}]" for word in words]


@pytest.mark.parametrize(
    ("text", "name", "shown"),
    [
        ("#WAIT SYN [ID=1 CH=2 P=3]", "WAIT", "#WAIT"),
        ("#SIGNAL [ID=5 CH=1]", "SIGNAL", "#SIGNAL"),
        ("#ROTATION ON [ANGLE=45 CENTER1=2]", "ROTATION ON", "#ROTATION ON"),
        ("X[MC_TOUCHPROBE CHANNEL=1 MODE=2]", "<axis>MC_TOUCHPROBE", "X[MC_TOUCHPROBE]"),
    ],
)
def test_a_command_that_does_not_act_is_one_note_whatever_its_keywords(
    text: str, name: str, shown: str
) -> None:
    assert notes(f"G0 X1\nN5 {text}") == [(shown, commands()[name][""].meaning, 2, 4)]


@pytest.mark.parametrize(
    "text",
    [
        "X[INDP_SYN G0 POS=1]", "#MEAS [AX=X EDGE=POS]", "#DRIVE WR SYN [AX=X KEY=A VAL=1]",
        "#DIST CTRL [ON]", "L CYCLE [NAME=A.NC @P1=2]",
    ],
)  # fmt: skip
def test_what_acts_is_not_noted(text: str) -> None:
    assert notes(text) == []


@pytest.mark.parametrize("word", ["O", "o"])
def test_a_letter_o_is_no_nought_in_either_case(word: str) -> None:
    with pytest.raises(UserError) as caught:
        parse_program(f"#KIN ID [{word}]", file="p.nc", axes=XYZ)
    assert (caught.value.column, caught.value.value, caught.value.hint) == (10, word, "0 meant?")


@pytest.mark.parametrize(
    ("text", "word", "column"),
    [
        ("Y[DIST_CTRL ON OFF]", "OFF", 16), ("Y[DIST_CTRL OFF ON]", "ON", 17),
        ("Y[DIST_CTRL ON OFF OFF]", "OFF", 16), ("Y[DIST_CTRL ON ON OFF OFF ON]", "OFF", 19),
    ],
)  # fmt: skip
def test_the_first_place_of_a_word_counts_that_excludes_another_one(
    text: str, word: str, column: int
) -> None:
    with pytest.raises(UserError, match="exclude each other") as caught:
        parse_program(text, file="p.nc", axes=XYZ)
    assert (caught.value.value, caught.value.column) == (word, column)


# What a message quotes


@pytest.mark.parametrize(
    ("text", "offset", "found"),
    [
        ("X10 (note) Y2", 0, "X10"), ("X10 (note) Y2", 4, ""), ("X10 (note) Y2", 5, ""),
        ("X10 (note) Y2", 11, "Y2"), ("X10 ;note", 4, ""), ("X10 ;note", 5, ""),
        ("X10\nY2", 3, ""), ("#COMMENT BEGIN\nX1\n#COMMENT END", 15, ""), ("X=?", 2, "?"),
    ],
)  # fmt: skip
def test_a_comment_is_nothing_that_is_found(text: str, offset: int, found: str) -> None:
    assert Source(text, None).found(offset) == found


# A fault over several lines


def lines(text: str) -> tuple[list[str], list[tuple[str, int | None]]]:
    source = Source(text, "p.nc")
    assert len(source.code) == len(source.text)
    return source.code.split("\n"), [(fault.message, fault.line) for fault in source.faults]


def blocks_of(text: str) -> list[str]:
    source = Source(text, None)
    return [source.text[begin:end] for begin, end in source.blocks()]


NOT_CLOSED = "text is not closed on its line"


@pytest.mark.parametrize("more", [0, 1, 2])
def test_a_fault_inside_an_open_bracket_takes_all_its_lines_along(more: int) -> None:
    """Neither the lines before it nor the block after it are in it."""
    middle = "EDGE=POS\n" * more
    text = f'G0 X1\n#MEAS [AX=X\n{middle}"abc\nG0 X2 (note)\nG0 X3'
    _, faults = lines(text)
    assert faults == [(NOT_CLOSED, 3 + more)]
    assert [block.split(" (")[0] for block in blocks_of(text)] == ["G0 X1", "G0 X2", "G0 X3"]


@pytest.mark.parametrize("text", ['G0 X1\n#MSG ["abc\nG0 X2\nG0 X3', 'G0 X1\n"abc\nG0 X2\nG0 X3'])
def test_a_fault_of_one_line_blanks_that_line_alone(text: str) -> None:
    code, faults = lines(text)
    assert faults == [(NOT_CLOSED, 2)]
    assert [line.strip() for line in code] == ["G0 X1", "", "G0 X2", "G0 X3"]


def test_each_of_several_faults_is_in_its_own_line() -> None:
    text = 'X1]\nG0 X1\n#MEAS [AX=X\n"abc\nG0 X2\nY "d\n]\nG0 X3'
    assert lines(text)[1] == [
        ("no bracket is open here", 1), (NOT_CLOSED, 4), (NOT_CLOSED, 6),
        ("no bracket is open here", 7),
    ]  # fmt: skip
    assert blocks_of(text) == ["G0 X1", "G0 X2", "G0 X3"]


@pytest.mark.parametrize(("text", "columns"), [("G0 X[1\nN20 G0 X2", [5]), ("#A [B[\nN2 X1", [6])])
def test_the_innermost_open_bracket_is_the_one_that_is_not_closed(
    text: str, columns: list[int]
) -> None:
    source = Source(text, None)
    assert [fault.column for fault in source.faults] == columns
    assert blocks_of(text) == [text.split("\n")[1]]


# Signs between and around words


@pytest.mark.parametrize("between", [" ", "\t", " \t ", ""])
def test_blanks_and_tabs_may_stand_between_an_address_and_its_number(between: str) -> None:
    (block,) = parse_program(f"G{between}1 X{between}10 F{between}5", file=None, axes=XYZ).blocks
    (same,) = parse_program("G1 X10 F5", file=None, axes=XYZ).blocks
    assert block.statement == same.statement


@pytest.mark.parametrize("text", ["W[INDP_SYN G0 POS=1]", "G1 W5", "#MEAS [AX=W EDGE=POS]"])
def test_axes_are_proposed_as_the_rig_spells_them(text: str) -> None:
    with pytest.raises(UserError, match="the rig has no such axis") as caught:
        parse_program(text, file=None, axes=("x", "Y", "z"))
    assert caught.value.allowed == "x, Y, z"


@pytest.mark.parametrize("text", ["G0 X1 N10", "X1 N=5"])
def test_a_block_number_is_at_the_beginning_alone(text: str) -> None:
    with pytest.raises(UserError, match="a block number is only allowed at the beginning"):
        parse_program(text, file=None, axes=XYZ)


@pytest.mark.parametrize(
    "words", ["ON VAL1=5", "ON", "ON WAIT", "VAL1=5 VAL2=7", "OFF WAIT NO_MOVE", "ON SET_DIST=1"]
)
def test_words_without_brackets_are_what_they_are_inside(words: str) -> None:
    """Flags before keywords with values too."""
    (loose,) = parse_program(f"#DIST CTRL {words}", file=None, axes=XYZ).blocks
    (inside,) = parse_program(f"#DIST CTRL [{words}]", file=None, axes=XYZ).blocks
    assert isinstance(loose.statement, Command)
    assert loose.statement == inside.statement
    assert [name for name, _ in loose.statement.options] == [
        word.partition("=")[0] for word in words.split()
    ]
