"""The four measuring programs against the numbers of the manual, command by command."""

import math
import re
from pathlib import Path

import pytest

from axisrig.kernel.nc.canon import EndOfProgram, LinearMove, MeasuringRun, Message, Wait
from axisrig.kernel.nc.text.parser import read_program

PROGRAMS = Path(__file__).parents[2] / "testplans" / "programs"
START = {"X": 0.0, "Y": 0.0, "Z": 300.0}


def messages_of(commands):
    """Variable and value of every message, as printed."""
    return [tuple(c.text.split("=")) for c in commands if isinstance(c, Message)]


def motions(commands):
    return [
        (type(c).__name__, c.block.number, dict(c.target_mm), c.feed_mm_min)
        for c in commands
        if isinstance(c, LinearMove | MeasuringRun)
    ]


def results(mess, acs, pcs, moffs, absolute_with, absolute_without):
    """The ten messages that all four programs put out."""
    return [
        ("V.A.MESS.Z", mess),
        ("V.A.MEAS.ACS.VALUE.Z", acs),
        ("V.A.MEAS.PCS.VALUE.Z", pcs),
        ("V.A.MOFFS.Z", moffs),
        ("V.A.MEIN.Z", "0.000000"),
        ("V.A.MEIN.Z", moffs),
        ("V.A.ABS.Z", absolute_with),
        ("V.A.MEIN.Z", "0.000000"),
        ("V.A.ABS.Z", absolute_without),
    ]


def test_meas1_without_shifts(run_program, plane_machine):
    commands = run_program("meas1.nc", plane_machine(START, ("Z", 100.0)))
    assert messages_of(commands) == results(
        "100.000000", "100.000000", "100.000000", "80.000000", "180.000000", "100.000000"
    )
    assert motions(commands) == [
        ("LinearMove", 10, {"Z": 200.0}, 2000.0),
        ("MeasuringRun", 20, {"Z": 20.0}, 2000.0),
        ("LinearMove", 80, {"Z": 180.0}, 1000.0),
        ("LinearMove", 120, {"Z": 100.0}, 1000.0),
    ]


def test_meas1_order_of_commands(run_program, plane_machine):
    """A run is followed by a wait, and so is each synchronous message preceded by one."""
    commands = run_program("meas1.nc", plane_machine(START, ("Z", 100.0)))
    message = [Wait, Message]
    assert [type(c) for c in commands] == [
        LinearMove,
        MeasuringRun,
        Wait,
        *message * 6,
        LinearMove,
        *message * 2,
        LinearMove,
        *message,
        EndOfProgram,
    ]
    assert (commands[-1].block.number, commands[-1].block.line) == (140, 20)


def test_meas1_run_names_its_axes(run_program, plane_machine):
    commands = run_program("meas1.nc", plane_machine(START, ("Z", 100.0)))
    (run,) = [c for c in commands if isinstance(c, MeasuringRun)]
    assert (run.programmed_axes, run.measuring_axes, run.measuring_type) == (("Z",), ("Z",), 1)


def test_meas2_with_reference_point_offset(run_program, plane_machine):
    commands = run_program("meas2.nc", plane_machine(START, ("Z", 100.0)))
    assert messages_of(commands) == results(
        "100.000000", "100.000000", "67.000000", "47.000000", "180.000000", "133.000000"
    )
    # 200 + 33, 20 + 33, 100 + 33 + 47, 100 + 33
    assert [m[2] for m in motions(commands)] == [
        {"Z": 233.0},
        {"Z": 53.0},
        {"Z": 180.0},
        {"Z": 133.0},
    ]


def test_meas3_with_shifted_coordinate_system(run_program, plane_machine):
    commands = run_program("meas3.nc", plane_machine(START, ("Z", 100.0)))
    assert messages_of(commands) == results(
        "67.000000", "100.000000", "67.000000", "47.000000", "147.000000", "100.000000"
    )
    # In axis coordinates the machine makes the same moves as in meas2.
    assert [m[2] for m in motions(commands)] == [
        {"Z": 233.0},
        {"Z": 53.0},
        {"Z": 180.0},
        {"Z": 133.0},
    ]
    (run,) = [c for c in commands if isinstance(c, MeasuringRun)]
    assert run.measuring_axes == ("X", "Y", "Z")
    assert run.programmed_axes == ("Z",)


def test_meas4_with_turned_coordinate_system(run_program, plane_machine):
    """Z_acs = 75 - X sin 15 + Z cos 15 with X = 150, solved for Z; the manual prints 20, 30, 80."""
    commands = run_program("meas4.nc", plane_machine(START, ("Z", 55.5)))
    sine, cosine = math.sin(math.radians(15)), math.cos(math.radians(15))
    mess = (55.5 - 75 + 150 * sine) / cosine
    assert mess == pytest.approx(20.0045, abs=1e-4)
    assert messages_of(commands) == results(
        f"{mess:.6f}",
        "55.500000",
        f"{mess:.6f}",
        f"{mess + 10:.6f}",
        f"{mess + 60:.6f}",
        "50.000000",
    )

    def acs(x, z):
        return {"X": x * cosine + z * sine, "Z": 75 - x * sine + z * cosine}

    expected = [acs(150, 100), acs(150, -10), acs(150, 50 + mess + 10), acs(150, 50)]
    for motion, target in zip(motions(commands), expected, strict=True):
        assert motion[2] == pytest.approx(target, abs=1e-9)


def test_program_comments_hold_the_values_of_the_manual(run_program, plane_machine):
    """The expected value behind each message of a program is what comes out, to 0.01 mm."""
    for name, trigger_mm in (("meas1", 100), ("meas2", 100), ("meas3", 100), ("meas4", 55.5)):
        text = (PROGRAMS / f"{name}.nc").read_text(encoding="utf-8")
        expected = [float(value) for value in re.findall(r"\]\s*;\s*(\S+)$", text, re.MULTILINE)]
        commands = run_program(f"{name}.nc", plane_machine(START, ("Z", float(trigger_mm))))
        assert [float(value) for _, value in messages_of(commands)] == pytest.approx(
            expected, abs=0.01
        )


@pytest.mark.parametrize(
    ("name", "numbers"),
    [
        ("meas1", [5, 10, 20, 30, 31, 32, 40, 50, 60, 70, 80, 90, 100, 110, 120, 130, 140]),
        ("meas2", [5, 10, 20, 30, 40, 41, 42, *range(50, 160, 10)]),
        ("meas3", [5, 10, 20, 30, 40, 41, 42, *range(50, 170, 10)]),
        ("meas4", [5, 10, 20, 30, 40, 41, 42, *range(50, 170, 10)]),
    ],
)
def test_programs_hold_the_blocks_of_the_manual(name, numbers):
    program = read_program(PROGRAMS / f"{name}.nc", ("X", "Y", "Z"))
    assert program.name == name
    assert [part.block.number for part in program.blocks] == numbers


def test_meas1_needs_one_axis_only(run_program, plane_machine):
    commands = run_program("meas1.nc", plane_machine({"Z": 300.0}, ("Z", 100.0)), axes=("Z",))
    assert messages_of(commands)[0] == ("V.A.MESS.Z", "100.000000")
