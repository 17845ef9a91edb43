"""Words of a block that are there twice, that need another one, or that say two things at once."""

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.builder import NEEDS_AXES
from axisrig.kernel.nc.text.check import check_program
from axisrig.kernel.nc.text.words import find_variable, words

XYZ = ("X", "Y", "Z")


def errors(text: str) -> list[UserError]:
    return list(check_program(f"{text}\n[A] X1\n[B] X2\nM30", "p.nc", XYZ).errors)


def only(text: str) -> UserError:
    (error,) = errors(text)
    assert error.line == 1
    return error


@pytest.mark.parametrize(
    ("text", "column", "message", "value"),
    [
        ("G4 1 2", 6, "second time in one block", None),
        ("G4 [1] 2", 8, "second time in one block", None),
        ("G4 V.A.ABS.X 1", 14, "second time in one block", None),
        ("$GOTO [A] $GOTO [B]", 11, "second jump in one block", "$GOTO"),
        ("P1=1 $GOTO [A] $GOTO [A]", 16, "second jump in one block", "$GOTO"),
        ("G310 X1 F1 $GOTO [A] $GOTO [B]", 22, "second jump in one block", "$GOTO"),
        ("X1 Y2 X3", 7, "axis twice in one block", "X"),
        ("X1 Z2 Z=3", 7, "axis twice in one block", "Z"),
        ("G1 X1 F1 F2", 10, "second feed in one block", "F"),
        ("T1 D1 T2", 7, "second T in one block", "T"),
        ("G2 X1 I1 J2 I3", 13, "second I in one block", "I"),
    ],
)
def test_what_is_there_twice_has_the_place_of_the_second(
    text: str, column: int, message: str, value: str | None
) -> None:
    error = only(text)
    assert (error.column, error.message, error.value) == (column, message, value)


@pytest.mark.parametrize("g", NEEDS_AXES)
def test_a_function_that_needs_an_axis_has_it_at_any_place_of_its_block(g: str) -> None:
    """It lacks it alone, and as the first, the second and the last function."""
    for text in (g, f"{g} G90", f"G90 {g}", f"G90 G1 {g} F100", f"M10 {g}", f"N5 G91 {g} M8"):
        error = only(text)
        assert (error.message, error.value) == (f"{g} needs an axis", g)
        assert (error.column, error.allowed) == (text.index(g) + 1, "X.., Y.., Z..")
    for text in (f"G91 {g} Z1 F100", f"Y1 {g} F100", f"{g} X[1] F100"):
        assert errors(text) == []


@pytest.mark.parametrize(
    ("before", "is_right"),
    [
        ("", True), ("P1=1", True), ("P1=1 P2=2", True), ("V.P.A = 1", True), ("N5", True),
        ("G310 X1 F100", True), ("G210 X1 F100", True), ("G91 G310 G1 X1 F100", True),
        ("G0", False), ("G1 X1 F100", False), ("X1", False), ("G100 X1 F100", False), ("M8", False),
        ("T1", False), ("G4 1", False), ("P1=1 X1", False), ("X[INDP_SYN POS=1 FEED=1]", False),
    ],
)  # fmt: skip
def test_a_jump_is_alone_behind_assignments_or_behind_an_interruptible_run(
    before: str, is_right: bool
) -> None:
    """FCT-C4 section 3, type 5: only G310 and G210 jump when their motion ends by the signal."""
    text = f"{before} $GOTO [A]".lstrip()
    if is_right:
        assert errors(text) == []
        return
    error = only(text)
    assert error.message.startswith("$GOTO is allowed alone")
    assert (error.value, error.column) == ("$GOTO", text.index("$") + 1)


WITH_VALUES = ("G131", "G133", "G134", "G159")
GROUPS: dict[str, list[str]] = {}
for row_of_word in (row for kind in "GM" for row in words(kind).values()):
    if row_of_word.group and row_of_word.word not in WITH_VALUES:
        GROUPS.setdefault(row_of_word.group, []).append(row_of_word.word)


@pytest.mark.parametrize("group", GROUPS)
def test_of_words_of_one_group_the_second_excludes_the_first(group: str) -> None:
    """Whatever is between them; what comes third is not reported."""
    first, *_, second = GROUPS[group]
    for text in (
        f"{first} {second} X1",
        f"{first} X1 F100 {second}",
        f"{first} {second} {first} X1",
    ):
        error = only(text)
        assert error.message == f"{first} and {second} exclude each other in one block"
        assert (error.value, error.allowed) == (second, f"one word of the group '{group}'")
        assert error.column == text.index(f" {second}") + 2


@pytest.mark.parametrize("word", ["X", "F", "G", "I", "T", "M"])
def test_a_value_is_in_a_bracket_or_after_the_equal_sign(word: str) -> None:
    """Parameters have an index in the bracket."""
    error = only(f"{word}[1]=5")
    assert error.message == "a value is either in [ ] or after =, not in both"
    assert error.value == word
    assert errors("P[1]=5") == []


# Names and operands


@pytest.mark.parametrize("name", ["V.A.ABX.X", "V.G.MEAS_TYP", "V.A.MES.Y"])
def test_an_unknown_variable_with_near_ones_has_no_list_of_all(name: str) -> None:
    error = only(f"X={name}")
    assert (error.message, error.value, error.allowed) == ("unknown variable", name, None)
    near = str(error.hint).removeprefix("nearest: ").split(", ")
    assert 1 <= len(near) <= 3
    assert all(find_variable(each)[0] is not None for each in near)


def test_an_unknown_variable_that_is_near_none_gets_them_all() -> None:
    error = only("X=V.Q")
    assert error.hint is None
    assert "V.A.MESS.X" in str(error.allowed)


@pytest.mark.parametrize("row", [row for row in words("function").values() if row.acts],
                         ids=lambda row: row.word)  # fmt: skip
def test_a_function_has_as_many_operands_as_its_table_says(row) -> None:
    least, _, most = row.group.partition("-")
    name = row.word
    for count in (int(least) - 1, int(least), int(most or least), int(most or least) + 1):
        if not count:
            continue
        found = errors(f"P1={name}[{','.join(['1'] * count)}]")
        if int(least) <= count <= int(most or least):
            assert found == []
        else:
            (error,) = found
            number = (
                "1 operand" if row.group == "1" else f"{row.group.replace('-', ' to ')} operands"
            )
            assert (error.message, error.value) == (f"{name} takes {number}", count)


# Keywords that go on with a word


@pytest.mark.parametrize(
    ("text", "word", "hint"),
    [
        ("#DRIVE WR SYN [AX=Z KEY=MON VALUE VAL=1]", "VALUE", "names have no blanks: MON_VALUE?"),
        ("#DRIVE WR SYN [AX=Z KEY=MON VALL=1]", "VALL", "nearest: VAL"),
        ("#DRIVE WR SYN [AX=Z VALL 1]", "VALL", "nearest: VAL"),
        ("#DRIVE WR SYN [AX=Z QQQ 1]", "QQQ", None),
        ("#MEAS [AX=X SIGNAL=PLC TIMESTAMP]", "TIMESTAMP", "names have no blanks: PLC_TIMESTAMP?"),
        ("#MEAS [AX=X EDGE=POS PROBE=1]", "PROBE", None),
        ("#MEAS [AX=X EDGE=POS INPTU=1]", "INPTU", "nearest: INPUT"),
        ("#MEAS [AX=X EDGE=POS SIGNALL DRIVE]", "SIGNALL", "nearest: SIGNAL, ERR_NO_SIGNAL"),
    ],
)
def test_a_word_goes_on_with_a_name_where_that_makes_one(
    text: str, word: str, hint: str | None
) -> None:
    """Not with an axis, nor with a name of a list that has no such one."""
    error = only(text)
    assert (error.value, error.hint) == (word, hint)
    assert error.column == text.index(word) + 1


def test_a_gap_between_commas_is_nothing_where_keywords_are() -> None:
    assert errors("#DRIVE WR SYN [AX=Z,,KEY=A VAL=1]") == []
    assert errors("#MEAS [ , TYPE=1]") == []
