"""A slave without power, for a moment or for good, in whatever place of its line."""

from pathlib import Path

import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.text.parser import read_program

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def first_alarm(folder: Path, *changes: str) -> Alarm:
    """Run a move of three axes on one line; return the first alarm."""
    program = folder / "move.nc"
    program.write_text("%move\nN10 G90 G01 X0.5 Y0.5 F600\nN20 M30\n", encoding="utf-8")
    assigned = [(parse_assignment(text), as_written) for text in changes]
    settings = read_settings(*read_rig(RIGS / "probe-xyz-ethercat.toml"), assigned)
    machine = Machine(settings, read_program(program, ("X", "Y", "Z")))
    try:
        machine.run()
    finally:
        machine.close()
    return machine.channel.alarms[0]


@pytest.mark.parametrize("axis", ["X", pytest.param("Z", marks=pytest.mark.long)])
def test_the_alarm_names_the_slave_that_is_back_in_init(tmp_path: Path, axis: str) -> None:
    """900732 with its state, and no counter of the line that leaves open which slave it is."""
    first = first_alarm(tmp_path, f"fault:power_loss={axis} at=20ms for=1ms")
    assert first.id == 900732
    assert (first.values["axis"], first.values["state"]) == (axis, "INIT")


@pytest.mark.parametrize(
    ("axis", "position", "missing"),
    [
        ("Z", 3, 3),
        pytest.param("Y", 2, 3, marks=pytest.mark.long),
        pytest.param("Y", 2, 1, marks=pytest.mark.long),
    ],
)
@pytest.mark.provokes(900733, 7)
def test_the_alarm_names_the_first_slave_that_does_not_answer(
    tmp_path: Path, axis: str, position: int, missing: int
) -> None:
    """Those behind it are cut off with it: as many answer as are before it."""
    changes = (f"fault:power_loss={axis} at=20ms", f"drive:servo.missing_cycles={missing}")
    first = first_alarm(tmp_path, *changes)
    assert first.id == 900733
    assert first.values == {
        "axis": axis,
        "position": position,
        "cycles": missing + 1,
        "found": position - 1,
        "expected": 3,
    }


@pytest.mark.long
def test_of_the_first_slave_nothing_comes_back(tmp_path: Path) -> None:
    """Its power or the cable before it: no frame says which."""
    assert first_alarm(tmp_path, "fault:power_loss=X at=20ms").id == 900730
