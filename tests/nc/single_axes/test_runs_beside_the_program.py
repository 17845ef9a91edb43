"""Runs of several axes beside the program: some have ended, and what their command hands on."""

from typing import Any

import pytest
from axis_statements import Machine, alone, decode, moves, single
from tests.nc.conftest import run_text
from tests.nc.five_axes import ON, run5

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.syntax import Assign, Number, Variable, Words

MEASURED = {"X": 3.0, "Y": 4.0}


def measures(*axes: str) -> Words:
    return single(*(alone(axis, "G100", "G90", POS=9, FEED=100, name="INDP_ASYN") for axis in axes))


def reads(name: str) -> Assign:
    return Assign(Variable("P[]", (Number(1.0),)), Variable(name))


def machine(*still_measuring: str) -> Machine:
    found = Machine()
    found.measured, found.measuring = dict(MEASURED), set(still_measuring)
    return found


@pytest.mark.parametrize(("ended", "other"), [("X", "Y"), ("Y", "X")])
def test_the_value_of_a_run_that_has_ended_is_there_while_another_goes_on(
    ended: str, other: str
) -> None:
    decode(measures("X", "Y"), reads(f"V.A.MESS.{ended}"), machine=machine(other))
    with pytest.raises(Alarm) as refused:
        decode(measures("X", "Y"), reads(f"V.A.MESS.{other}"), machine=machine(other))
    assert (refused.value.id, refused.value.values["axis"]) == (900101, other)


@pytest.mark.parametrize("axes", [("X", "Y"), ("Y", "X"), ("Z", "X"), ("X",)])
def test_an_offset_of_any_axis_that_measures_waits_for_its_value(axes: tuple[str, ...]) -> None:
    """G101 with several axes: Z has measured before, the others beside the program."""
    before = Words(g=("G100",), axes=(("Z", Number(5.0)),), addresses=(("F", Number(60.0)),))
    found = machine()
    found.measured["Z"] = 2.0
    include = Words(g=("G101",), axes=tuple((axis, Number(1.0)) for axis in axes))
    commands = decode(before, measures("X", "Y"), include, machine=found)
    kinds = [type(command).__name__ for command in commands]
    begun = max(at for at, kind in enumerate(kinds) if kind == "IndependentMove")
    assert kinds[begun + 1 :] == ["Wait", "EndOfProgram"]


def test_an_offset_of_axes_that_measure_no_more_waits_for_nothing() -> None:
    before = Words(g=("G100",), axes=(("Z", Number(5.0)),), addresses=(("F", Number(60.0)),))
    found = machine()
    found.measured["Z"] = 2.0
    include = Words(g=("G101",), axes=(("Z", Number(1.0)),))
    kinds = [type(c).__name__ for c in decode(before, include, machine=found)]
    assert kinds == ["MeasuringRun", "Wait", "EndOfProgram"]


@pytest.mark.parametrize(
    ("command", "error_no_signal"),
    [
        ("", None),
        ("#MEAS [ERR_NO_SIGNAL=1]\n", True),
        ("#MEAS [ERR_NO_SIGNAL=0]\n", False),
        ("#MEAS [ERR_NO_SIGNAL=1]\n#MEAS [ERR_NO_SIGNAL=0]\n", False),
    ],
)
@pytest.mark.parametrize("word", ["INDP_SYN", "INDP_ASYN"])
def test_a_run_beside_the_program_misses_its_signal_as_the_program_says(
    command: str, error_no_signal: bool | None, word: str
) -> None:
    commands = run_text(f"%t\n{command}X[{word} POS=5 G90 G100 FEED=100]\nM30\n")
    (move,) = moves(commands)
    assert (move.error_no_signal, move.measuring_type) == (error_no_signal, 1)


def test_every_m_function_of_a_bracket_goes_to_the_plc_side() -> None:
    text = "%t\nX[INDP_SYN POS=5 G90 G01 FEED=100 M7 M8 M123 H5]\nM30\n"
    sent = [c for c in run_text(text) if isinstance(c, canon.TechnologyFunction)]
    assert [c.word for c in sent] == ["M7", "M8", "M123", "H5"]


@pytest.mark.parametrize(
    ("before", "axis", "word"),
    [
        (ON, "X", "kinematic"), (ON, "A", "kinematic"),
        ("#CS ON [1,2,3]\n", "X", "Cartesian"), (f"{ON}#CS ON [1,2,3]\n", "Y", "Cartesian"),
        (f"{ON}#CS ON [1,2,3]\n", "C", "kinematic"),
    ],
)  # fmt: skip
def test_21071_names_what_converts_the_axis(before: str, axis: str, word: str) -> None:
    with pytest.raises(Alarm) as refused:
        run5(f"{before}{axis}[INDP_SYN POS=5 G90 G00]")
    values: dict[str, Any] = refused.value.values
    assert (refused.value.id, values["axis"], values["transformation"]) == (21071, axis, word)


def test_an_axis_beside_what_is_converted_moves_by_itself() -> None:
    commands = run5("#CS ON [1,2,3]\nC[INDP_SYN POS=5 G90 G00]")
    assert [(m.axis, m.target_mm) for m in moves(commands)] == [("C", 5.0)]
