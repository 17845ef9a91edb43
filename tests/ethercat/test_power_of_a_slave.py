"""A slave that was without power for a moment, in whatever place of its line."""

from pathlib import Path

import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


@pytest.mark.parametrize("axis", ["X", pytest.param("Z", marks=pytest.mark.long)])
def test_the_alarm_names_the_slave_that_is_back_in_init(tmp_path: Path, axis: str) -> None:
    """900732 with its state, and no counter of the line that leaves open which slave it is."""
    program = tmp_path / "move.nc"
    program.write_text("%move\nN10 G90 G01 X0.5 Y0.5 F600\nN20 M30\n", encoding="utf-8")
    fault = parse_assignment(f"fault:power_loss={axis} at=20ms for=1ms")
    settings = read_settings(*read_rig(RIGS / "probe-xyz-ethercat.toml"), [(fault, as_written)])
    machine = Machine(settings, read_program(program, ("X", "Y", "Z")))
    try:
        machine.run()
    finally:
        machine.close()
    first = machine.channel.alarms[0]
    assert first.id == 900732
    assert (first.values["axis"], first.values["state"]) == (axis, "INIT")
