"""A machine on EtherCAT: the control starts its slaves, moves, measures, and reports what fails."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.machine.ethercat.line import Line
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.profiles.ethercat.tables import AlState, Command
from axisrig.kernel.time.clock import MS, US

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z-ethercat.toml"
PROGRAM = """%touch
N10 G90 G01 Z102 F6000
N20 G100 Z98 F600
N30 #MSG SYN["z=%f", V.A.MEAS.ACS.VALUE.Z]
N40 M30
"""
INCREMENT_MM = 10.0 / 2**20
SURFACE_MM = 100.0
INPUT_DELAY_S = 4e-6
FEED_MM_S = 10.0

Make = Callable[..., tuple[Machine, Line]]


@pytest.fixture
def make(tmp_path: Path) -> Iterator[Make]:
    """Builds a machine of the rig with some assignments; its line beside it."""
    (tmp_path / "touch.nc").write_text(PROGRAM, encoding="utf-8")
    made: list[Machine] = []

    def build(*changes: str, drive: str = "") -> tuple[Machine, Line]:
        changes = (*changes, "plant:z.position_start_mm=102")
        assigned = [(parse_assignment(text), as_written) for text in changes]
        rig = tmp_path / "rig.toml"
        own = f"[drive.servo]\n{drive}\n" if drive else ""
        rig.write_text(f'base = "{RIG.as_posix()}"\n{own}', encoding="utf-8")
        settings = read_settings(*read_rig(rig), assigned)
        machine = Machine(settings, read_program(tmp_path / "touch.nc", ("Z",)))
        made.append(machine)
        part: Any = machine.installed[0]
        return machine, part.lines["ec1"]

    yield build
    for machine in made:
        machine.close()


def alarms_of(machine: Machine) -> list[int]:
    return [alarm.id for alarm in machine.channel.alarms]


def in_state(machine: Machine, action: Callable[[], None], after_ns: int = 20 * MS) -> None:
    """Let something happen a while after the program has begun."""
    done: list[bool] = []

    def look(_: Any) -> None:
        begin_ns = machine.channel.start_ns
        if not done and begin_ns is not None and machine.scheduler.now_ns >= begin_ns + after_ns:
            done.append(True)
            action()

    machine.channel.observers.append(look)


@pytest.mark.long
def test_it_measures_within_an_increment_of_the_closed_form(make: Make) -> None:
    """Z of the edge: the surface, and what the axis moves on within the delay of the input."""
    machine, line = make()
    machine.run()
    assert alarms_of(machine) == []
    (shown,) = [message.shown for message in machine.messages]
    expected_mm = SURFACE_MM - FEED_MM_S * INPUT_DELAY_S
    # The printed text has six decimals
    assert float(shown.partition("=")[2]) == pytest.approx(expected_mm, abs=INCREMENT_MM + 1e-6)
    assert {node.states.state for node in line.nodes.values()} == {AlState.OP}
    assert line.segment.lost == 0
    assert machine.links["Z"].unproved_latches == 0


@pytest.mark.long
def test_the_same_run_sends_the_same_frames(make: Make) -> None:
    hashes = []
    for _ in range(2):
        machine, _ = make()
        machine.run()
        hashes.append(machine.hexdigest())
    assert hashes[0] == hashes[1]


def drop_all(line: Line) -> None:
    line.segment.passes[:] = [lambda _: None]


@pytest.mark.long
@pytest.mark.provokes(900700, 7, segment="ec1")
def test_a_line_that_is_silent_is_an_alarm(make: Make) -> None:
    machine, line = make()
    drop_all(line)
    machine.run()
    assert alarms_of(machine) == [900700]


@pytest.mark.long
@pytest.mark.provokes(900701, 7, segment="ec1", found=2, expected=1)
def test_a_slave_too_many_is_an_alarm(make: Make) -> None:
    """One slave in the rig; a second one has counted before it."""
    machine, line = make()

    def count(frame: bytearray) -> int:
        if frame[16] == Command.BRD and frame[20:22] == b"\0\0":
            frame[27] = 1
        return 0

    line.segment.passes[:] = [count]
    machine.run()
    assert alarms_of(machine) == [900701]


@pytest.mark.long
@pytest.mark.provokes(900702, 7, axis="Z", position=1)
def test_an_empty_eeprom_is_an_alarm(make: Make) -> None:
    machine, line = make()
    content = line.nodes["Z"].eeprom.content
    content[:] = b"\xff" * len(content)
    machine.run()
    assert alarms_of(machine) == [900702]


@pytest.mark.long
@pytest.mark.provokes(900703, 7, axis="Z", what="0x1018:1", found="0x0", expected="0x5")
def test_another_device_is_an_alarm(make: Make) -> None:
    machine, line = make()
    (start,) = line.start._slaves
    object.__setattr__(start.settings, "identity", {1: 5})
    machine.run()
    assert alarms_of(machine) == [900703]


def without_changes_of_state(frame: bytearray) -> int:
    """Turn each order for PREOP into nothing, as a slave that hangs."""
    if frame[16] == Command.FPWR and frame[20:22] == b"\x20\x01" and frame[26] == AlState.PREOP:
        frame[16] = 0
    return 0


@pytest.mark.long
@pytest.mark.provokes(900704, 7, axis="Z", state="PREOP", found="INIT", ms=2000)
def test_a_slave_that_hangs_is_an_alarm(make: Make) -> None:
    machine, line = make()
    line.segment.passes[:] = [without_changes_of_state]
    machine.run()
    assert alarms_of(machine) == [900704]


@pytest.mark.long
@pytest.mark.provokes(900705, 7, axis="Z", state="OP", found="SAFEOP with error")
def test_a_cycle_that_the_drive_does_not_take_is_an_alarm(make: Make) -> None:
    """60C2 is 2 ms and SYNC0 comes every 1 ms: AL status code 0x0035."""
    machine, _ = make(drive='sdo = [["0x60C2:1", 2]]')
    machine.run()
    assert alarms_of(machine) == [900705]
    assert "0x0035" in str(machine.channel.alarms[0])


@pytest.mark.long
@pytest.mark.provokes(900706, 7, axis="Z", position=1)
def test_a_slave_without_a_clock_is_an_alarm(make: Make) -> None:
    machine, line = make()
    registers = line.nodes["Z"].registers

    def without_clock(_frame: bytearray) -> int:
        registers.put("FEATURES", 0)
        return 0

    line.segment.passes[:] = [without_clock]
    machine.run()
    assert alarms_of(machine) == [900706]


@pytest.mark.long
@pytest.mark.provokes(900707, 7, axis="Z", position=1)
def test_a_clock_that_does_not_follow_is_an_alarm(make: Make) -> None:
    """Its time jumps by 0.2 ms with each of the frames that hand the time on."""
    machine, line = make()
    clock = line.nodes["Z"].time.local

    def jump(frame: bytearray) -> int:
        if frame[16] == Command.FPWR and frame[20:22] == b"\x10\x09":
            clock.jump(200 * US)
        return 0

    line.segment.passes[:] = [jump]
    machine.run()
    assert alarms_of(machine) == [900707]


@pytest.mark.long
@pytest.mark.provokes(900730, 7, axis="Z", cycles=4)
def test_frames_that_stay_out_are_an_alarm_after_the_stated_number(make: Make) -> None:
    machine, line = make()
    in_state(machine, lambda: drop_all(line))
    machine.run()
    assert alarms_of(machine)[0] == 900730


@pytest.mark.long
@pytest.mark.provokes(900731, 7, axis="Z", cycles=4, counter=0, expected=3)
def test_a_wrong_working_counter_is_an_alarm_after_the_stated_number(make: Make) -> None:
    machine, line = make()

    def spoil(frame: bytearray) -> int:
        """Let no slave act on the process image."""
        at = 16 + 2 * 16  # behind the two datagrams of the time
        if frame[at] == Command.LRW:
            frame[at] = Command.NOP
        return 0

    def begin() -> None:
        line.segment.passes[:] = [spoil]

    in_state(machine, begin)
    machine.run()
    assert alarms_of(machine)[0] == 900731


@pytest.mark.long
@pytest.mark.provokes(900732, 7, axis="Z", state="SAFEOP with error")
def test_a_slave_that_falls_is_an_alarm_with_its_code(make: Make) -> None:
    machine, line = make()
    in_state(machine, lambda: line.nodes["Z"].states.fall(AlState.SAFEOP, "WATCHDOG"))
    machine.run()
    assert alarms_of(machine)[0] == 900732
    assert "0x001B" in str(machine.channel.alarms[0])


STAMPS = RIG.parent / "lists" / "pdo-stamps.csv"


def stamp_error_ns(make: Make, *changes: str) -> tuple[int, int]:
    """How far 60D1 is from the true instant of the latch, and that instant."""
    machine, _ = make(*changes, drive=f'pdo_map = "{STAMPS.as_posix()}"')
    machine.run()
    assert alarms_of(machine) == []
    (instant_ns,) = machine.drives["Z"].latch_instants_ns[0]
    stamp = machine.links["Z"].arrival.stamp
    assert stamp is not None
    return stamp - instant_ns, instant_ns


@pytest.mark.long
def test_a_stamp_is_system_time_of_a_clock_that_drifts_and_follows(make: Make) -> None:
    """Settled within 10 ns and what 100 ppm make of the time between two frames, 100 ns.

    The 50 ns of the wire to the slave are not in the time that it gets.
    """
    error_ns, _ = stamp_error_ns(make, "bus:ec1.drift_ppm=100", "bus:ec1.clock_start_us=50")
    assert -50 - 10 - 100 <= error_ns <= 10 + 100


@pytest.mark.long
def test_a_clock_that_nobody_leads_drifts_away(make: Make) -> None:
    """100 ppm of the time since its offset was set, which is within the start-up."""
    changes = ("bus:ec1.drift_ppm=100", "bus:ec1.drift_compensation=false")
    error_ns, instant_ns = stamp_error_ns(make, *changes)
    start_up_ns = 100 * MS
    assert 100e-6 * (instant_ns - start_up_ns) - 60 <= error_ns <= 100e-6 * instant_ns + 60


LINE_OF_THREE, BESIDE_CAN = "probe-xyz-ethercat.toml", "probe-xyz-mixed.toml"
THREE_AXES = """%three
N10 G90 G01 X2 Y-1 Z102 F6000
N20 G100 Z98 F600
N30 #MSG SYN["z=%f", V.A.MEAS.ACS.VALUE.Z]
N40 M30
"""


def three_axes(tmp_path: Path, rig: str, *changes: str) -> Machine:
    """A machine of three axes that has run a measuring program."""
    (tmp_path / "three.nc").write_text(THREE_AXES, encoding="utf-8")
    words = (*changes, "plant:z.position_start_mm=102")
    assigned = [(parse_assignment(text), as_written) for text in words]
    settings = read_settings(*read_rig(RIG.parent / rig), assigned)
    machine = Machine(settings, read_program(tmp_path / "three.nc", ("X", "Y", "Z")))
    try:
        machine.run()
    finally:
        machine.close()
    assert alarms_of(machine) == []
    return machine


@pytest.mark.long
@pytest.mark.parametrize("rig", [LINE_OF_THREE, BESIDE_CAN])
def test_several_drives_on_a_line_and_beside_can_move_and_measure(tmp_path: Path, rig: str) -> None:
    """No input delay in these rigs: Z of the edge is the surface."""
    machine = three_axes(tmp_path, rig)
    (shown,) = [message.shown for message in machine.messages]
    assert float(shown.partition("=")[2]) == pytest.approx(SURFACE_MM, abs=INCREMENT_MM + 1e-6)
    ends = [machine.links[axis].actual_mm for axis in "XY"]
    assert ends == pytest.approx([2.0, -1.0], abs=0.02)


def ahead_of_first_ns(machine: Machine, axis: str) -> int:
    """How far the clock of a slave is ahead of that of X, the reference, now."""
    part: Any = machine.installed[0]
    nodes, now_ns = part.lines["ec1"].nodes, machine.scheduler.now_ns
    return int(nodes[axis].time.system_ns(now_ns) - nodes["X"].time.system_ns(now_ns))


@pytest.mark.long
def test_clocks_of_a_line_show_one_time_behind_a_long_wire(tmp_path: Path) -> None:
    """X 20, Y -35, Z 100 ppm; Y is 10 us behind X: each within 10 ns and its drift in a cycle."""
    machine = three_axes(tmp_path, LINE_OF_THREE)
    for axis, ppm in (("Y", 35), ("Z", 100)):
        assert abs(ahead_of_first_ns(machine, axis)) <= 10 + ppm + 20


@pytest.mark.long
def test_a_delay_that_is_not_written_makes_clocks_late_by_it(tmp_path: Path) -> None:
    """The wire of 10 us and the slave before it of 300 ns: 0.5 um at 50 mm/s."""
    machine = three_axes(tmp_path, LINE_OF_THREE, "bus:ec1.delay_compensation=false")
    assert ahead_of_first_ns(machine, "Y") == pytest.approx(-10_300, abs=10 + 35 + 20)
