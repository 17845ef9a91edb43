"""A line as machines are: a CoE axis, a SoE axis and a stamping terminal, in one frame."""

import re
from pathlib import Path

import pytest

from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
RIG = """base = "{base}"
title = "X with a SERCOS drive, Z with one of CiA 402 and a stamping terminal on one line"

[drive.soe]
family = "sercos"
encoder_increments = 1_048_576
lead_mm = 10.0

[axis.X]
list = "axis-x.lst"
segment = "ec1"
drive = "soe"
plant = "x"

[plant.x]
fmu = "AxisRig.Drives.ServoAxis"
start = {{ kv = 40, coulomb_friction_n = 0, breakaway_friction_n = 0 }}
"""
PROGRAM = """%mixed
N10 G90 G01 X2 Z110 F3000
N20 G100 Z80 F600
N30 #MSG SYN["z=%f", V.A.MEAS.ACS.VALUE.Z]
N40 G01 X-1 Z115 F3000
N50 M30
"""


def machine_of(folder: Path, *changes: str) -> Machine:
    rig, program = folder / "mixed.toml", folder / "mixed.nc"
    rig.write_text(RIG.format(base=(RIGS / "plc-timestamp-line.toml").as_posix()), encoding="utf-8")
    listed = (RIGS / "lists" / "axis-x.lst").read_text(encoding="utf-8")
    listed = re.sub(r"(?m)^kenngr\.(antr_typ|messachse)\s.*$", "", listed)
    (folder / "axis-x.lst").write_text(f"{listed}\nkenngr.antr_typ 2\n", encoding="utf-8")
    program.write_text(PROGRAM, encoding="utf-8")
    assigned = [(parse_assignment(text), as_written) for text in changes]
    settings = read_settings(*read_rig(rig), assigned)
    return Machine(settings, read_program(program, ("Z", "X")))


@pytest.mark.long
@pytest.mark.parametrize("signal", ["DRIVE", "PLC_TIMESTAMP"])
def test_each_slave_has_its_own_words_in_the_one_frame(tmp_path: Path, signal: str) -> None:
    """Both drives and the terminal are in OP, axes are where the program sends them.

    The latch of the drive is v times the delay of its input past the edge, 10 mm/s times 4 us; the
    stamp of the terminal is that of the edge, and its value within the wires of the line.
    """
    machine = machine_of(tmp_path, f"set:Z.kenngr.measure.signal={signal}")
    try:
        machine.run()
        places = {
            axis: drive.axis.motor_position_m() * 1e3 for axis, drive in machine.drives.items()
        }
        facts = facts_of(machine)
    finally:
        machine.close()
    assert facts.alarms == ()
    (message,) = facts.messages
    late_mm = 10.0 * 4e-6 if signal == "DRIVE" else 0.0
    assert message.values == pytest.approx((100.0 - late_mm,), abs=2e-5)
    assert places == pytest.approx({"X": -1.0, "Z": 115.0}, abs=1e-3)
    line = facts.buses[0].line
    assert line is not None
    assert dict(line.slaves) == dict.fromkeys(("X", "Z", "terminal"), "OP")
    assert (line.counter, line.wrong) == (3 + 3 + 1, 0)
