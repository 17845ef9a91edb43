"""Variables, functions and numbers of a program: where a name stands first, and what is none."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import Number
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.nc.text.words import words

XYZ = ("X", "Y", "Z")


def places(text: str) -> list[tuple[str, int, int]]:
    return list(parse_program(text, file="p.nc", axes=XYZ).variables)


def refused(text: str) -> UserError:
    with pytest.raises(UserError) as caught:
        parse_program(text, file="p.nc", axes=XYZ)
    return caught.value


# Where a name stands first


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("V.P.A=1\nX=V.P.A\nX=V.P.A+V.P.A", [("V.P.A", 1, 1)]),
        ("G0 X1\nN20 X=V.P.A Y=V.P.A\nV.P.A=2", [("V.P.A", 2, 7)]),
        ("X=V.P.B+V.P.A\nV.P.A=1 V.P.B=2", [("V.P.B", 1, 3), ("V.P.A", 1, 9)]),
        ("x=v.p.a\nX=V.P.A", [("V.P.A", 1, 3)]),
        ("; V.P.A\n(V.P.A) X=V.P.A", [("V.P.A", 2, 11)]),
        ("X=[1+ \\\n  V.P.A]\nY=V.P.A", [("V.P.A", 2, 3)]),
        ("$IF V.P.A == 1\nX=V.P.A\n$ENDIF", [("V.P.A", 1, 5)]),
        ("%L UP\nX=V.P.A\nM17\n%MAIN\nV.P.A=1\nLL UP", [("V.P.A", 2, 3)]),
        ("#VAR\nV.P.A[2]\n#ENDVAR\nX=V.P.A[1]", [("V.P.A[]", 2, 1)]),
        ('#MSG ["%f %f", V.P.A, V.P.A]\nX=V.P.A', [("V.P.A", 1, 16)]),
        ("X=V.P.A[V.P.I]\nY=V.P.I", [("V.P.I", 1, 9), ("V.P.A[]", 1, 3)]),
        ("G1 X=V.P.A F10\nG1 X=V.P.A F10\nG1 X=V.P.A F10", [("V.P.A", 1, 6)]),
        ("G1 X1 F10\nG1 X=V.P.A F10\nG1 X2 F10\nG1 X=V.P.A F10", [("V.P.A", 2, 6)]),
    ],
)
def test_each_name_has_the_place_where_it_stands_first(
    text: str, found: list[tuple[str, int, int]]
) -> None:
    """Whether it is read or written there; an index is known before what it is an index of."""
    assert [each for each in places(text) if each[0].startswith("V.P.")] == found


@pytest.mark.parametrize(
    ("text", "line", "column", "value"),
    [
        ("G0 X1\nX=V.P.A\nG0 X2\nY=V.P.A", 2, 3, "V.P.A"),
        ("V.P.B=1\nX=V.P.B Y=V.P.A Z=V.P.A\nX=V.P.A", 2, 11, "V.P.A"),
        ("X=V.P.A\nX=V.P.C\nX=V.P.A", 1, 3, "V.P.A"),
        ("#VAR\nV.P.A[2]\n#ENDVAR\nX=V.P.A[1]\nY=V.P.A\nZ=V.P.A", 5, 3, "V.P.A"),
    ],
)
def test_a_variable_that_nothing_writes_is_refused_where_it_is_first_read(
    run: Callable[..., list[Any]], text: str, line: int, column: int, value: str
) -> None:
    with pytest.raises(UserError) as caught:
        run(text)
    error = caught.value
    assert (error.line, error.column, error.value) == (line, column, value)


# Unknown names


@pytest.mark.parametrize(
    ("text", "column", "value", "hint"),
    [
        ("X=V.A.MES.Z", 3, "V.A.MES.Z", "V.A.MESS.Z"), ("X=1+V.A.AB.X", 5, "V.A.AB.X", "V.A.ABS.X"),
        ("X=SINE[3]", 3, "SINE", "SIN"), ("X=2*SQR[2]+SQT[4]", 12, "SQT", "SQRT"),
    ],
)  # fmt: skip
def test_an_unknown_name_has_its_place_and_the_nearest_one(
    text: str, column: int, value: str, hint: str
) -> None:
    error = refused(text)
    assert (error.line, error.column, error.value) == (1, column, value)
    assert error.hint is not None
    assert error.hint.startswith("nearest: ")
    assert hint in error.hint.removeprefix("nearest: ").split(", ")


def test_a_variable_of_an_axis_that_the_rig_does_not_have_names_those_it_has() -> None:
    error = refused("Y1 X=V.A.ABS.C")
    assert (error.message, error.column, error.value) == ("the rig has no such axis", 6, "C")
    assert (error.allowed, error.hint) == ("X, Y, Z", "in V.A.ABS.C")


# Functions


def test_each_function_takes_as_many_operands_as_its_table_has() -> None:
    for word in words("function").values():
        least, _, most = word.group.partition("-")
        low, high = int(least), int(most or least)
        if word.acts:
            for count in {low, high}:
                text = f"P1=2\nX={word.word}[{','.join(['P1'] * count)}]"
                assert parse_program(text, file="p.nc", axes=XYZ).blocks
        for count in (low - 1, high + 1):
            if count < 1:
                continue
            error = refused(f"Y1 X={word.word}[{','.join(['1'] * count)}]")
            assert error.message.startswith(f"{word.word} takes {low}"), word.word
            assert (error.column, error.value) == (6, count), word.word


# Constants


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0x10", 16.0), ("0X1f", 31.0), ("0xFFFFFFFFFFFFF", 2.0**52 - 1), ("0.5", 0.5), (".5", 0.5),
        ("5.", 5.0), ("007", 7.0), ("TRUE", 1.0), ("false", 0.0), ("-TRUE", -1.0),
        ("2*-3", -6.0), ("--3", 3.0), ("+-+3", -3.0), ("-[2-5]", 3.0), ("-2**2", -4.0),
        ("[-2]**2", 4.0), ("1-2-3", -4.0), ("12/3/2", 2.0), ("7 MOD 4 MOD 2", 1.0),
        ("1+2*3**2", 19.0), ("1 or 0 and 0", 1.0), ("1 XOR 1 || 1", 1.0), ("1 XOR 1 && 0", 1.0),
        ("6 & 3 | 8", 10.0), ("1 | 2 == 3", 1.0), ("2 < 3 == 1", 1.0), ("1 <= 1", 1.0),
        ("1 >= 2", 0.0), ("1 != 1", 0.0), ("2 > 1", 1.0), ("6 ^ 3", 5.0), ("4 | 6 ^ 2", 4.0),
        ("6 ^ 2 & 3", 4.0),
    ],
)  # fmt: skip
def test_a_constant_is_computed_when_it_is_read(text: str, value: float) -> None:
    """Ranks, loosest first: or, XOR, and, comparisons, |, ^, &, + -, * / MOD, ** (206014219)."""
    (block,) = parse_program(f"X={text}", file="p.nc", axes=XYZ).blocks
    statement: Any = block.statement
    assert statement.axes == (("X", Number(value)),)


@pytest.mark.parametrize("text", ["9" * 400, "0x" + "F" * 17])
def test_a_number_that_cannot_be_held_is_refused_with_its_beginning(text: str) -> None:
    error = refused(f"Y1 X={text}")
    assert (error.message, error.column) == ("number too large", 6)
    assert error.value == f"{text[:12]}.."


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("1/0", "division by zero"), ("2+3/[1-1]", "division by zero"), ("SQRT[-1]", "square root"),
        ("5 MOD 0", "zero"), ("TAN[90]", "tangent"), ("LN[0]", "logarithm"),
    ],
)  # fmt: skip
def test_a_constant_without_a_value_is_refused_where_it_begins(text: str, why: str) -> None:
    error = refused(f"G1 F5 X={text}")
    assert error.message.startswith("expression has no value: ")
    assert why in error.message
    assert error.column == 9
