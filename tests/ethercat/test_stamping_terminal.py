"""A terminal whose slave controller stamps edges: registers by hand, then on the line of a rig."""

import struct
from pathlib import Path
from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis, FakeSignal
from tests.ethercat.line import INIT, OP, PREOP, SAFEOP, Line, frame, physical

from axisrig.bench.bus.ethercat.segment import EthercatSegment
from axisrig.bench.drive.ethercat.stamping import StampingTerminal
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.fault_targets import targets
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

TESTPLANS = Path(__file__).parents[2] / "testplans"
RIG = TESTPLANS / "rigs" / "plc-timestamp-line.toml"
EDGES_NS = (int(1.2 * MS), int(1.3 * MS), int(1.5 * MS), int(5.5 * MS))
"""Up, down, up, down."""


class Alone(Line):
    """A terminal alone on a line."""

    def __init__(self, edges_ns: tuple[int, ...] = EDGES_NS) -> None:
        self.clock = new_scheduler()
        axis = FakeAxis()
        signal: Any = FakeSignal(axis, edges_ns)
        self.terminal = StampingTerminal(self.clock, (signal, None), axis.advance_to, 1)
        self.segment = EthercatSegment(self.clock, [self.terminal])
        self.segment.receivers.append(self._receive)
        self.back = []
        self._counter = self._index = 0

    def latches(self) -> tuple[int, ...]:
        """Status of input 1, then its rising and its falling edge."""
        status, _, up, down, _, _ = struct.unpack("<BB4Q", self.one(1, 0, 0x09AE, 34).data)
        return status, up, down


def test_it_reaches_op_without_mailbox_and_outputs() -> None:
    line = Alone()
    for state in (PREOP, SAFEOP, OP, INIT):
        assert line.ask(state) == (state, 0)


@pytest.mark.parametrize(("control", "up_ns"), [(0, EDGES_NS[2]), (1, EDGES_NS[0])])
def test_of_several_edges_the_last_one_or_the_first_one_keeps_its_stamp(
    control: int, up_ns: int
) -> None:
    """09A8: bit 0 is the rising edge as a single event."""
    line = Alone()
    line.write(0x09A8, control, 1)
    line.wait(2 * MS)
    status, up, down = line.latches()
    assert (status & 4, up, down) == (4, up_ns, EDGES_NS[1])
    assert status & 1 == control
    assert line.latches()[0] & 1 == 0  # reading the stamp has cleared it
    line.wait(5 * MS)
    assert line.latches() == (0, up_ns, EDGES_NS[3])


def test_a_master_reads_what_it_is() -> None:
    line = Alone()
    words = []
    for word in (8, 10, 12, 14):
        line.one(2, 0, 0x0502, struct.pack("<HI", 0x0100, word))
        words.append(line.read(0x0508, 4))
    assert words == [0, 401, 0x0001_0000, 1]


def test_it_counts_frames_that_break_before_it_and_nothing_without_power() -> None:
    """0300 before it, 0308 before another one; without power it neither answers nor stamps."""
    line = Alone()
    terminal, breaks = line.terminal, line.segment.breaks
    for count in (1, 2):
        breaks.append(lambda _frame, _number: True)
        line.segment.send(frame(physical(7, 0, 0, 1)))
        line.wait(MS // 10)
        breaks.clear()
        terminal.broken(is_here=False)
        assert (line.read(0x0300, 1), line.read(0x0308, 1)) == (count, count)
    terminal.power_off()
    for is_here in (True, False):
        terminal.broken(is_here=is_here)
    before = len(line.back)
    line.segment.send(frame(physical(7, 0, 0, 1)))
    line.wait(2 * MS)
    assert len(line.back) == before
    terminal.is_on = True
    assert (line.read(0x0300, 1), line.read(0x0308, 1)) == (2, 2)


# On the line of a rig


def machine_of(tmp_path: Path, *changes: str) -> Machine:
    program = tmp_path / "touch.nc"
    program.write_text('%t\nN10 G90 G01 Z102 F6000\nN20 G100 Z98 F3000\nN30 #MSG SYN["z=%f",'
                       " V.A.MEAS.ACS.VALUE.Z]\nN40 M30\n")  # fmt: skip
    words = (*changes, "plant:z.position_start_mm=102",
             "set:Z.kenngr.measure.signal=PLC_TIMESTAMP")  # fmt: skip
    assigned = [(parse_assignment(text), as_written) for text in words]
    machine = Machine(read_settings(*read_rig(RIG), assigned), read_program(program, ("Z",)))
    try:
        machine.run()
    finally:
        machine.close()
    return machine


@pytest.mark.long
def test_the_line_starts_it_and_the_plc_has_its_image(tmp_path: Path) -> None:
    machine = machine_of(tmp_path)
    assert [alarm.id for alarm in machine.channel.alarms] == []
    (shown,) = [message.shown for message in machine.messages]
    # 50 ns of wire before the first slave, at 50 mm/s; six decimals are printed
    assert float(shown.partition("=")[2]) == pytest.approx(100.0, abs=9.6e-6 + 4e-6)
    part: Any = machine.installed[0]
    line = part.lines["ec1"]
    assert {slave.states.state for slave in line.slaves.values()} == {AlState.OP}
    assert [name for name, _ in part.figures()[0].line.slaves] == ["Z", "terminal"]
    assert line.master.image.counter == 3 + 1


@pytest.mark.long
@pytest.mark.provokes(900704, 7, axis="terminal", state="OP", found="no answer", ms=2000)
def test_a_terminal_that_does_not_answer_is_one_alarm(tmp_path: Path) -> None:
    """Its power goes when the slaves have been counted."""
    machine = machine_of(tmp_path, "plc:terminal.silent_from_ms=3")
    assert [alarm.id for alarm in machine.channel.alarms] == [900704]
    assert "terminal" in str(machine.channel.alarms[0])


def test_faults_of_telegrams_and_of_a_clock_of_its_own_are_not_for_it() -> None:

    rig, _ = read_rig(RIG)
    assert targets(("telegram", "terminal"), rig) == targets(("telegram",), rig)
    assert not [name for name in targets(("telegram",), rig) if name.startswith("terminal")]
