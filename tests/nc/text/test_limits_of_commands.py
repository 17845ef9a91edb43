"""What a command may say at its limits, what excludes what, and where a run is known to end."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.check import check_program

XYZ = ("X", "Y", "Z")


def errors(text: str) -> list[UserError]:
    return list(check_program(f"{text}\nM30", "p.nc", XYZ).errors)


def only(text: str) -> UserError:
    (error,) = errors(text)
    return error


def notes(text: str) -> list[tuple[int, int, str]]:
    found = check_program(f"{text}\nM30", "p.nc", XYZ)
    assert found.errors == ()
    return [(note.line, note.column, note.text) for note in found.notes]


# #MSG


@pytest.mark.parametrize(
    ("block", "column", "value"),
    [
        ('#MSG ["ab %q", 1]', 11, "%q"), ('N5 #MSG SYN ["%d %x", 1, 2]', 18, "%x"),
        ('#MSG["%w"]', 7, "%w"),
    ],
)  # fmt: skip
def test_a_wrong_format_element_has_its_place_in_its_own_block(
    block: str, column: int, value: str
) -> None:
    """Texts of blocks before it have places of their own."""
    error = only(f'#MSG ["first %d", 1]\nG0 X1\n{block}')
    assert (error.line, error.column, error.value) == (3, column, value)


# #MEAS


@pytest.mark.parametrize("channel", ["SIMU_OFFSET=1", "TRIGGER"])
@pytest.mark.parametrize(
    ("axis", "word"),
    [
        ("AX=X", "AX"), ("AXNR=1", "AXNR"), ("EDGE=NEG", "EDGE"), ("INPUT=1", "INPUT"),
        ("SIGNAL=DRIVE", "SIGNAL"), ("G107", "G107"), ("G108", "G108"),
        ("EDGE=NEG AX=X", "AX"),
    ],
)  # fmt: skip
def test_a_setting_of_the_channel_is_beside_none_of_an_axis(
    channel: str, axis: str, word: str
) -> None:
    """In either order; the axis is named before what belongs to it."""
    own = channel.partition("=")[0]
    for text in (f"#MEAS [{channel} {axis}]", f"#MEAS [{axis} {channel}]"):
        error = only(text)
        assert error.message == f"{own} and {word} of #MEAS exclude each other"
        assert (error.value, error.allowed) == (word, "one of them")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("#MEAS [SIMU_OFFSET=1 TRIGGER]", "SIMU_OFFSET and TRIGGER of #MEAS exclude each other"),
        ("#MEAS [TRIGGER SIMU_OFFSET=1]", "TRIGGER and SIMU_OFFSET of #MEAS exclude each other"),
        ("#MEAS [AX=X AXNR=1 EDGE=NEG]", "AX and AXNR of #MEAS exclude each other"),
        ("#MEAS [AX=X G108 G107]", "G108 and G107 of #MEAS exclude each other"),
        ("#MEAS [G107]", "#MEAS names no axis"), ("#MEAS [TYPE=1 EDGE=POS]", "#MEAS names no axis"),
        ("#MEAS PREPARE [AX=X AX=Y]", "keyword twice in one command"),
        ("#MEAS PREPARE", "#MEAS PREPARE names no axis"),
        ("#MEAS PREPARE []", "#MEAS PREPARE names no axis"),
    ],
)  # fmt: skip
def test_what_excludes_each_other_or_names_no_axis(text: str, message: str) -> None:
    assert only(text).message == message


CONTOURINGS = ("DEV", "DIST", "POS", "DIST_SOFT", "DIST_MASTER", "PTP")
INSTEAD_OF_A_VALUE = {
    "AX LINK OFF": "1", "DISABLE AX LINK": "1", "PUT AX": "X", "WAIT INDP": "X",
}  # fmt: skip


@pytest.mark.parametrize(
    ("command", "one", "other"),
    [("CHANNEL INIT", "CMDPOS", "ACTPOS"), ("CHANNEL INIT", "ACTPOS", "CMDPOS")]
    + [
        (f"CONTOUR MODE{on}", "PTP", word)
        for on in ("", " ON", " OFF")
        for word in CONTOURINGS[:-1]
    ]
    + [("CONTOUR MODE", word, "DEV") for word in CONTOURINGS[1:]],
)
def test_a_command_takes_one_of_its_kinds(command: str, one: str, other: str) -> None:
    text = f"#{command} [{one} {other}]"
    error = only(text)
    assert error.message == f"{one} and {other} of #{command} exclude each other"
    assert (error.column, error.value) == (text.index(f" {other}]") + 2, other)
    assert errors(f"#{command} [{one}]") == errors(f"#{command} [{other} {other}]") == []


@pytest.mark.parametrize(("command", "value"), INSTEAD_OF_A_VALUE.items())
def test_all_is_instead_of_a_value(command: str, value: str) -> None:
    for inside in (f"{value}, ALL", f"{value} ALL", f"ALL {value}", f"ALL, {value}"):
        error = only(text := f"#{command} [{inside}]")
        assert error.message == f"ALL and a value of #{command} exclude each other"
        assert (error.column, error.value) == (text.index("ALL") + 1, "ALL")
    assert errors(f"#{command} [ALL]") == errors(f"#{command} [{value}]") == []


@pytest.mark.parametrize(
    "text",
    ["#MEAS PREPARE [AX=X AXNR=2]", "#MEAS [TYPE=1 SIMU_OFFSET=2]",
     "#MEAS [TYPE=1 AX=X EDGE=NEG ERR_NO_SIGNAL=1]", "#MEAS MODE", "#MEAS MODE[]", "#MEAS MODE[7]"],
)  # fmt: skip
def test_what_may_be_together(text: str) -> None:
    """A preparation may name one axis by its name and another one by its number."""
    assert errors(text) == []


# #DRIVE and kinematics


@pytest.mark.parametrize("length", [1, 28, 29, 30, 60])
def test_the_name_of_a_drive_function_has_29_signs_at_most(length: int) -> None:
    """P-AXIS-00396."""
    for word in ("WR SYN", "RD"):
        more = "VAL=1" if word == "WR SYN" else "P=P1"
        found = errors(f"#DRIVE {word} [AX=Z KEY={'K' * length} {more}]")
        if length <= 29:
            assert found == []
        else:
            (error,) = found
            assert error.message == "KEY takes the name of one drive function"
            assert error.value == "K" * length
            assert error.column == len(f"#DRIVE {word} [AX=Z KEY=") + 1


@pytest.mark.parametrize("command", ["#KIN ID", "#TRAFO", "#TRAFO ON"])
@pytest.mark.parametrize(
    ("ids", "wrong"),
    [
        ("9", None), ("65535", None), ("9,98", None), ("65535,65535", None),
        ("65536", "65536"), ("9,70000", "70000"), ("70000,9", "70000"), ("9,65536,99999", "65536"),
    ],
)  # fmt: skip
def test_the_first_id_that_no_kinematic_can_have_is_named(
    command: str, ids: str, wrong: str | None
) -> None:
    """P-CHAN-00262 is UNS16."""
    found = errors(f"{command} [{ids}]")
    assert [(error.message, error.value) for error in found] == (
        [] if wrong is None else [("no kinematic has such an ID", f"{command} [{wrong}]")]
    )


# Brackets of axes


@pytest.mark.parametrize(
    ("text", "word"),
    [("Z[ON]", "ON"), ("Z[SET_POS=3]", "SET_POS"), ("Z[KP 3 OFF]", "KP"), ("X[FREEZE]", "FREEZE")],
)
def test_a_keyword_of_one_command_alone_says_which_is_lacking(text: str, word: str) -> None:
    error = only(text)
    assert error.message == "DIST_CTRL is written before its keywords"
    assert (error.value, error.allowed) == (word, f"{text[0]}[DIST_CTRL {word} ..]")
    assert error.column == 3


@pytest.mark.parametrize("text", ["X[POS=1]", "X[FEED=3]", "X[ACC_WEIGHT=5 POS=1]"])
def test_a_keyword_of_several_commands_says_what_may_be_there(text: str) -> None:
    """INDP_SYN and INDP_ASYN have it."""
    error = only(text)
    assert error.message == "a value or a command to axis X is needed in the bracket"
    assert "X[INDP_SYN ..], X[INDP_ASYN ..]" in str(error.allowed)


@pytest.mark.parametrize(
    "text", ["#PUT AX X", "#PUT AX[X]", "#PUT AX [X, Y]", "#WAIT INDP X", "#WAIT INDP[X, Z]",
             "#WAIT INDP", "#WAIT INDP []", "#WAIT INDP ALL"]
)  # fmt: skip
def test_axes_of_a_command_are_in_brackets_or_behind_it(text: str) -> None:
    assert errors(text) == []


@pytest.mark.parametrize("text", ["#TIME[]", "#TIME", "#MSG[]", "#KIN ID[]"])
def test_an_empty_bracket_is_no_value_where_one_is_needed(text: str) -> None:
    error = only(text)
    assert error.message == f"wrong values for {text.removesuffix('[]')}"


# Where a run ends


def test_constants_that_end_a_run_are_found_in_every_part_of_a_file() -> None:
    found = notes("%L UP\nM1000\nG4\nM17\n%L DOWN\nD-1\nM17\n%MAIN\nLL UP\nLL DOWN\nG4\nG2 X1 F1")
    assert [(line, text.partition("(")[2]) for line, _, text in found] == [
        (2, "ID 20160)"), (3, "ID 900171)"), (6, "ID 900155)"), (11, "ID 900171)"),
        (12, "I J K) nor a radius R (ID 20036)"),
    ]  # fmt: skip
    assert {text.partition(":")[0] for _, _, text in found} == {"a run ends here"}


@pytest.mark.parametrize(
    ("text", "is_found"),
    [
        ("M999", False), ("M1000", True), ("D0", False), ("D-1", True), ("D200", False),
        ("G4 0", False), ("G4 X0", False), ("G4 X-1", True), ("G4 [-0.5]", True), ("G4 Y1", True),
        ("G4 X=P1", False), ("G2 X1 F1", True), ("G3 X1 F1", True), ("G2 X1 I0 F1", False),
        ("G2 X1 R5 F1", False), ("R5\nG2 X1 F1", False), ("G2 X1 F1\nG3 X2 R5", False),
        ("G2", False),
        ("X[INDP_SYN G0 G1 POS=1]", True), ("X[INDP_ASYN G1 POS=1 FEED=-1]", True),
        ("X[INDP_SYN POS=1 TIME=-1]", True), ("X[INDP_SYN G1 POS=-1 FEED=1]", False),
    ],
)  # fmt: skip
def test_a_block_whose_constants_end_a_run(text: str, is_found: bool) -> None:
    """Nothing that a variable or another block decides."""
    found = [note for note in notes(f"P1=1\n{text}") if note[2].startswith("a run ends here")]
    assert len(found) == is_found


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ("X=SIZEOF[1] Y=EXIST[P1] G41 S5", ["SIZEOF", "EXIST", "G41", "S"]),
        ("S5 G41 Y=SIZEOF[1]", ["S", "G41", "SIZEOF"]),
    ],
)
def test_notes_of_one_line_are_in_the_order_of_their_places(block: str, words: list[str]) -> None:
    """Not in that of their texts."""
    found = notes(block)
    assert [text.split()[0] for _, _, text in found] == words
    columns = [column for _, column, _ in found]
    assert columns == sorted(columns)
