"""Latches that the PLC switches or hands over: what waits, what stays, and what counts as open."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.probing.test_drive_port import Drive
from tests.channel.probing.test_signal_port import CYCLE_NS, MS, SYNC_NS, Bench

from axisrig.kernel.channel.path.stop_way import sent_to
from axisrig.kernel.channel.probing.external import DrivePort, ExternalPort
from axisrig.kernel.channel.probing.handshake import Handshake
from axisrig.kernel.channel.probing.ports import PlcPorts
from axisrig.kernel.channel.probing.signal import SignalPort, StampPort
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.measuring.rules import EXTERNAL, EXTERNAL_WITH_DRIVE, PLC
from axisrig.kernel.plc.probing import AxisWrites, LatchTask

ACKNOWLEDGE_CYCLES = 50


def tasks(bench: Bench) -> Handshake:
    return Handshake("Z", bench.unit, bench.task, bench.clock)


def external(bench: Bench) -> ExternalPort:
    return ExternalPort(bench.link, bench.unit, bench.task, bench.clock, tasks(bench))


def drive_port(bench: Bench) -> tuple[DrivePort, Any]:
    drive: Any = Drive()
    return DrivePort(drive, tasks(bench)), drive


def test_only_a_probe_that_is_enabled_and_acknowledged_is_ready() -> None:
    bench = Bench()
    handshake = tasks(bench)
    assert not handshake.is_ready  # nothing was asked for
    handshake.prepare()
    assert not handshake.is_ready
    bench.unit.take(AxisWrites(done_order=bench.unit.number), 0)
    assert (handshake.is_idle, handshake.is_ready) == (True, False)  # it is prepared, not on
    handshake.enable()
    assert not handshake.is_ready
    bench.unit.take(AxisWrites(done_order=bench.unit.number), 0)
    assert handshake.is_ready
    handshake.disable()
    bench.unit.take(AxisWrites(done_order=bench.unit.number), 0)
    assert (handshake.is_idle, handshake.is_ready) == (True, False)


@pytest.mark.parametrize("asks", [True, False])
@pytest.mark.parametrize("kind", ["external", "drive"])
def test_a_run_that_waits_for_the_disable_of_the_one_before_waits_no_longer_than_it_may(
    kind: str, asks: bool
) -> None:
    """900406; where no run waits the PLC may take as long as it likes."""
    bench = Bench()
    port: Any = external(bench) if kind == "external" else drive_port(bench)[0]
    port.arm()
    bench.next(port, signal=False, done=1)
    port.disarm()
    assert bench.unit.order.task is LatchTask.DISABLE
    if asks:
        assert not port.is_clear
    for _ in range(ACKNOWLEDGE_CYCLES):
        bench.next(port, signal=False, done=1)
    if not asks:
        bench.next(port, signal=False, done=1)
        return
    with pytest.raises(Alarm) as late:
        bench.next(port, signal=False, done=1)
    assert (late.value.id, late.value.values["ms"]) == (900406, str(ACKNOWLEDGE_CYCLES + 1))


@pytest.mark.parametrize("kind", ["external", "drive"])
def test_a_run_that_begins_leaves_a_probe_that_is_prepared(kind: str) -> None:
    """It is switched off at first wherever it was enabled, and nowhere else."""
    bench = Bench()
    port: Any = external(bench) if kind == "external" else drive_port(bench)[0]
    port.handshake.prepare()
    bench.next(port, signal=False, done=1)
    port.disarm()
    assert (bench.unit.order.task, bench.unit.is_idle) == (LatchTask.PREPARE, True)
    assert port.handshake.is_prepared
    port.arm()
    port.disarm()
    assert bench.unit.waiting[-1].task is LatchTask.DISABLE


def test_a_drive_that_still_waits_for_an_edge_is_not_armed_by_this_run() -> None:
    bench = Bench()
    port, drive = drive_port(bench)
    drive.arrival = Arrival(3, 2)
    port = DrivePort(drive, port.handshake)
    drive.is_armed = True
    assert not port.is_armed
    port.arm()
    port.look()
    assert not port.is_armed
    early = port.arrival
    assert (early.delay_cycles, early.missing_cycles, early.handshake_cycles) == (3, 2, None)
    bench.unit.take(AxisWrites(done_order=bench.unit.number), 0)
    port.look()
    assert port.is_armed
    assert port.arrival is drive.arrival


def test_the_first_event_stays_the_one_of_the_run() -> None:
    bench = Bench()
    port = SignalPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    port.take_event()
    assert not port.has_latched  # no run waits for it
    port.arm()
    bench.next(port, signal=False)
    port.take_event()
    first_mm = port.latched_mm
    assert first_mm == bench.place_mm(bench.cycle * MS + SYNC_NS)
    bench.next(port, signal=False)
    port.take_event()
    assert port.latched_mm == first_mm


def handed_over(bench: Bench, port: SignalPort, units: int, *, signal: bool) -> None:
    """The next cycle brings a position of the PLC with the signal."""
    bench.cycle += 1
    bench.clock.now_ns = bench.task.written_ns = bench.cycle * MS + CYCLE_NS
    bench.task.sync_ns["Z"] = bench.cycle * MS + SYNC_NS
    bench.link.actual_mm = bench.place_mm(bench.cycle * MS + SYNC_NS)
    bench.unit.take(AxisWrites(signal, None, units), bench.clock.now_ns)
    port.look()


@pytest.mark.parametrize("units", [12_345, -12_345, 0])
def test_a_position_that_the_plc_hands_over_is_the_value_whatever_the_history_says(
    units: int,
) -> None:
    """In 0.1 um. Its speed is that of the positions of its cycle; nothing of it is open."""
    bench = Bench()
    port = SignalPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    port.arm()
    for _ in range(5):
        handed_over(bench, port, 7, signal=False)
    for _ in range(4):
        handed_over(bench, port, units, signal=True)
    assert port.latched_mm == units / 10_000
    assert (port.doubt_mm, bench.link.doubt_mm) == (None, None)
    assert port.is_confirmed()
    assert port.latched_speed_mm == pytest.approx(1e-3 * (6 + SYNC_NS / MS), rel=1e-6)


@pytest.mark.parametrize(("increments", "is_open"), [(0.6, False), (0.95, False), (1.05, True)])
def test_what_is_open_by_more_than_an_increment_counts_as_unproved(
    increments: float, is_open: bool
) -> None:
    bench = Bench()
    port = SignalPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    for run in (1, 2):
        port.arm()
        for _ in range(20):
            bench.next(port, signal=False)
        sync_ns = (bench.cycle + 1) * MS + SYNC_NS
        way_mm = bench.place_mm(sync_ns + MS) - bench.place_mm(sync_ns)
        bench.link.settings.increments_per_mm = increments / way_mm
        bench.next(port, signal=True, has_actual=False)
        for _ in range(3):
            bench.next(port, signal=True)
        assert port.doubt_mm == pytest.approx(way_mm, rel=1e-6)
        assert bench.link.doubt_mm == (port.doubt_mm if is_open else None)
        assert bench.link.interpolated_latches == (run if is_open else 0)
        port.disarm()


@pytest.mark.parametrize("limited", [False, True])
def test_a_stamp_has_32_bits_and_clocks_that_nobody_watches_are_no_alarm(limited: bool) -> None:
    """At 5 s its counter has begun anew; 300 ns apart with a limit of 400 are none either."""
    bench = Bench()
    bench.cycle = 5000
    bench.task.clocks_off_ns["Z"] = 300
    if limited:
        bench.task.clock_limit_ns["Z"] = 400
    port = StampPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    bench.next(port, signal=False)
    port.arm()
    for _ in range(4):
        bench.next(port, signal=False)
    stamp_ns = (bench.cycle + 1) * MS + SYNC_NS + 1000
    for _ in range(4):
        bench.next(port, signal=True, stamp_ns=stamp_ns)
    assert stamp_ns > 2**32
    assert port.arrival.stamp == stamp_ns - 2**32
    assert port.latched_mm == pytest.approx(bench.place_mm(stamp_ns), abs=1e-6)
    speed_mm_ns = port.latched_speed_mm / MS
    assert port.doubt_mm == pytest.approx(2.0 * 300 * speed_mm_ns)


class Backwards(Bench):
    """The same way in the other direction."""

    def place_mm(self, time_ns: int) -> float:
        return -super().place_mm(time_ns)


@pytest.mark.parametrize("made", [Bench, Backwards])
def test_clocks_that_were_apart_leave_the_same_doubt_in_both_directions(made: type[Bench]) -> None:
    """0.1 mm/ms at 100 ms: twice 300 ns are 60 nm, which is never less than nothing."""
    bench = made()
    bench.task.clocks_off_ns["Z"] = 300
    port = StampPort(bench.link, bench.unit, bench.task, bench.clock, "POS")
    port.arm()
    for number in range(1, 106):
        bench.next(port, signal=number > 101, stamp_ns=100 * MS)
    assert port.doubt_mm == pytest.approx(2.0 * 300e-9 * 100.0, rel=1e-3)
    assert port.latched_mm == pytest.approx(bench.place_mm(100 * MS), abs=1e-6)


def test_an_axis_has_one_latch_for_each_source_and_one_probe_to_switch() -> None:
    """External hardware and a drive with an external probe share the tasks of the axis."""
    bench = Bench()
    link: Any = bench.link
    link.edge = "POS"
    units = {"Z": SimpleNamespace(probing=bench.unit)}
    plc: Any = SimpleNamespace(task=bench.task, axis=units)
    ports = PlcPorts({"Z": link}, plc, bench.clock)  # type: ignore[arg-type]
    assert ports.find("Z", PLC) is None
    first = ports.choose("Z", PLC, 1, "POS")
    assert ports.find("Z", PLC) is first
    assert ports.find("Z", EXTERNAL) is None
    hardware = ports.choose("Z", EXTERNAL, 2, "NEG")
    with_drive = ports.choose("Z", EXTERNAL_WITH_DRIVE, 3, "POS")
    assert len({id(first), id(hardware), id(with_drive)}) == 3
    assert hardware.handshake is with_drive.handshake is not None
    assert (with_drive.handshake.probe_input, with_drive.handshake.edge) == (3, "POS")
    assert ports.choose("Z", PLC, 1, "NEG") is first
    assert first.edge == "NEG"  # type: ignore[union-attr]
    assert first.handshake is None


def test_what_was_sent_to_axes_is_their_set_positions() -> None:
    """Of each axis in its order, when it is asked for."""
    links: Any = [SimpleNamespace(set_mm=1.0, actual_mm=9.0), SimpleNamespace(set_mm=2.0)]
    sent = sent_to(iter(links))
    assert sent() == (1.0, 2.0)
    links[0].set_mm = 3.0
    assert sent() == (3.0, 2.0)
