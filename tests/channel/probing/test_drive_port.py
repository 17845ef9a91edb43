"""A probe that the PLC switches and the drive latches, from run to run (EXT_PROBE_WITH_DRIVE)."""

from types import SimpleNamespace

from axisrig.kernel.channel.probing.external import DrivePort
from axisrig.kernel.channel.probing.handshake import Handshake
from axisrig.kernel.measuring.latest_edge import HANDSHAKE_CYCLES_MAX, Arrival
from axisrig.kernel.plc.probing import AxisWrites, LatchTask, PlcTask, ProbingUnit


class Drive:
    """A drive whose input shows an actuated probe, also while that is off."""

    name, is_clear, is_actuated = "Z", True, True

    def __init__(self) -> None:
        self.arrival, self.is_armed = Arrival(), False

    def arm(self) -> None:
        self.is_armed = True

    def disarm(self) -> None:
        self.is_armed = False


def test_each_run_asks_for_the_probe_anew_and_while_it_is_off_its_output_says_nothing() -> None:
    """FCT-C4 7.4: ENABLE, its acknowledgement, the drive; DISABLE at the end; the same again."""
    drive, unit = Drive(), ProbingUnit()
    handshake = Handshake("Z", unit, PlcTask(acknowledge_ns=10), SimpleNamespace(now_ns=0))
    port = DrivePort(drive, handshake)  # type: ignore[arg-type]
    found = []

    def note() -> None:
        port.look()
        waits = port.arrival.handshake_cycles
        found.append((port.is_clear, port.is_actuated, port.is_armed, drive.is_armed, waits))

    for _ in range(2):
        note()
        port.arm()
        assert unit.order.task is LatchTask.ENABLE
        note()
        unit.take(AxisWrites(done_order=unit.number), 0)
        note()
        port.disarm()
        assert unit.order.task is LatchTask.DISABLE
        note()
        unit.take(AxisWrites(done_order=unit.number), 0)
    off = (True, None, False, False, None)
    asked = (False, None, False, False, None)
    on = (True, True, True, True, HANDSHAKE_CYCLES_MAX)
    assert found == [off, asked, on, asked] * 2


def test_a_latch_that_is_left_in_the_drive_is_waited_for_too() -> None:
    """The probe is off at the PLC, and the drive still shows the edge of the run before."""
    drive, unit = Drive(), ProbingUnit()
    handshake = Handshake("Z", unit, PlcTask(acknowledge_ns=10), SimpleNamespace(now_ns=0))
    port = DrivePort(drive, handshake)  # type: ignore[arg-type]
    found = []
    for is_clear in (True, False, True):
        drive.is_clear = is_clear
        found.append(port.is_clear)
    assert found == [True, False, True]


class Counting(Drive):
    """Counts how often its latch was armed: each time it forgets what it has."""

    arms = 0

    def arm(self) -> None:
        self.arms += 1
        super().arm()


def test_the_drive_is_armed_once_in_a_run_however_long_it_takes() -> None:
    drive, unit = Counting(), ProbingUnit()
    handshake = Handshake("Z", unit, PlcTask(acknowledge_ns=10), SimpleNamespace(now_ns=0))
    port = DrivePort(drive, handshake)  # type: ignore[arg-type]
    for run in (1, 2, 3):
        port.look()
        port.arm()
        port.look()
        assert drive.arms == run - 1  # the PLC has not switched the probe on yet
        unit.take(AxisWrites(done_order=unit.number), 0)
        for _ in range(5):
            port.look()
            assert drive.arms == run
        port.disarm()
        unit.take(AxisWrites(done_order=unit.number), 0)
        assert port.is_clear
