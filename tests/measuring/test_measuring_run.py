"""The measurement run against latches that are told cycle by cycle what to show."""

from dataclasses import dataclass, field

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import HANDSHAKE_CYCLES_MAX, Arrival, StampClock
from axisrig.kernel.measuring.run import (
    CHECK_CYCLES_MAX,
    PROOF_CYCLES_MAX,
    MeasuringRun,
    Order,
    RunState,
)

MS = 1_000_000


@dataclass
class FakeLatch:
    """A latch whose status bits are set by hand; it notes every order it gets."""

    name: str = "Z"
    is_clear: bool = True
    is_armed: bool = False
    has_latched: bool = False
    latched_mm: float | None = None
    latched_speed_mm: float = 0.0
    is_actuated: bool | None = None
    is_prepared: bool = True
    confirms: bool = True
    arrival: Arrival = field(default_factory=Arrival)
    orders: list[str] = field(default_factory=list)

    def arm(self) -> None:
        self.orders.append("arm")

    def disarm(self) -> None:
        self.orders.append("disarm")

    def is_confirmed(self) -> bool:
        return self.confirms

    def latch(self, value_mm: float | None) -> None:
        self.has_latched, self.latched_mm = True, value_mm


class Stage:
    """A run with its latches and the cycles it has seen; cycle k and its SYNC are at k ms."""

    def __init__(self, *ports: FakeLatch, error_no_signal: bool = False) -> None:
        self.ports = ports
        self.orders: list[Order] = []
        self.run = MeasuringRun(ports, "block N20", 0, error_no_signal)
        self.rest_ns: int | None = None

    @property
    def now_ns(self) -> int:
        return (len(self.orders) + 1) * MS

    def cycle(self, standing: bool = False, resting: bool | None = None) -> RunState:
        """Standing axes rest, unless it is said that they creep inside their windows."""
        is_resting = standing if resting is None else resting
        has_moved = self.run.state in (RunState.MOVING, RunState.COLLECTING)
        if is_resting and self.rest_ns is None and has_moved:
            self.rest_ns = self.now_ns
        self.orders.append(self.run.evaluate(self.now_ns, standing, self.rest_ns))
        return self.run.state

    def cycles(self, count: int, standing: bool = False, resting: bool | None = None) -> None:
        for _ in range(count):
            self.cycle(standing, resting)

    def move(self) -> "Stage":
        """Go through the handshake with drives that answer at once."""
        self.cycle(standing=True)
        for port in self.ports:
            port.is_armed = True
        self.cycle(standing=True)
        assert self.run.state is RunState.MOVING
        return self


def _alarm(stage: Stage, cycles: int, standing: bool = False) -> tuple[Alarm, int]:
    """The alarm that comes up within `cycles`, and in which of them."""
    for number in range(1, cycles + 1):
        try:
            stage.cycle(standing)
        except Alarm as alarm:
            return alarm, number
    raise AssertionError(f"no alarm within {cycles} cycles")


def test_a_whole_run_goes_through_every_state_once() -> None:
    latch = FakeLatch()
    stage = Stage(latch)
    assert stage.run.state is RunState.CLEARING
    assert latch.orders == ["disarm"]

    assert stage.cycle(standing=True) is RunState.ARMING  # 1 ms
    assert latch.orders == ["disarm", "arm"]
    assert stage.cycle(standing=True) is RunState.ARMING  # 2 ms: not yet acknowledged
    latch.is_clear, latch.is_armed = False, True
    assert stage.cycle(standing=True) is RunState.MOVING  # 3 ms
    stage.cycles(5)  # 4 .. 8 ms
    latch.latch(100.25)
    stage.cycles(4)  # 9 .. 12 ms: brakes
    assert stage.cycle(standing=True) is RunState.DONE  # 13 ms

    record = stage.run.record
    assert (record.begin_ns, record.start_ns) == (0, 3 * MS)
    assert (record.signal_ns, record.end_ns) == (9 * MS, 13 * MS)
    assert record.latched_mm == {"Z": 100.25}
    assert record.has_signal
    assert record.block == "block N20"
    assert latch.orders == ["disarm", "arm", "disarm"]


def test_start_and_brake_are_ordered_exactly_once() -> None:
    latch = FakeLatch()
    stage = Stage(latch).move()
    stage.cycles(3)
    latch.latch(1.0)
    stage.cycles(6)
    stage.cycles(3, standing=True)
    expected = [Order.NONE, Order.START, *[Order.NONE] * 3, Order.BRAKE, *[Order.NONE] * 8]
    assert stage.orders == expected


def test_a_finished_run_asks_for_nothing_more() -> None:
    latch = FakeLatch()
    stage = Stage(latch).move()
    latch.latch(1.0)
    stage.cycle()
    stage.cycle(standing=True)
    end_ns, orders = stage.run.record.end_ns, list(latch.orders)
    latch.latched_mm = 2.0
    stage.cycles(3, standing=True)
    assert stage.run.record.end_ns == end_ns
    assert stage.run.record.latched_mm == {"Z": 1.0}
    assert latch.orders == orders


@pytest.mark.provokes(900082, 4, axis="Z")
def test_900082_when_the_probe_is_switched_off_during_the_run() -> None:
    latch = FakeLatch()
    stage = Stage(latch).move()
    stage.cycles(3)
    latch.is_armed = False
    assert _alarm(stage, 1)[0].id == 900082


# Probe already actuated


def test_50052_at_the_begin_before_anything_is_ordered() -> None:
    free, actuated = FakeLatch("X", is_actuated=False), FakeLatch("Z", is_actuated=True)
    with pytest.raises(Alarm) as caught:
        Stage(free, actuated)
    assert caught.value.id == 50052
    assert caught.value.values == {"axis": "Z"}
    assert free.orders == actuated.orders == []


def test_50052_when_the_probe_is_actuated_while_it_is_armed() -> None:
    """An edge between the start of the run and the armed latch is not seen by the latch."""
    latch = FakeLatch(is_actuated=False)
    stage = Stage(latch)
    stage.cycle()
    latch.is_armed, latch.is_actuated = True, True
    alarm, _ = _alarm(stage, 1)
    assert alarm.id == 50052
    assert Order.START not in stage.orders


def test_a_drive_that_does_not_tell_the_level_gives_no_50052() -> None:
    """Domain notes B.4: without 60FD there is no 50052 and the run ends without signal."""
    stage = Stage(FakeLatch(is_actuated=None)).move()
    stage.cycle()
    stage.cycle(standing=True)
    assert stage.run.state is RunState.DONE
    assert not stage.run.record.has_signal


# Handshake


@pytest.mark.provokes(900009, 4, axis="Z")
def test_900009_when_the_drive_never_clears_its_latch() -> None:
    latch = FakeLatch(is_clear=False)
    alarm, number = _alarm(Stage(latch), HANDSHAKE_CYCLES_MAX + 5)
    assert (alarm.id, number) == (900009, HANDSHAKE_CYCLES_MAX + 1)
    assert alarm.values == {"axis": "Z"}
    assert "arm" not in latch.orders


@pytest.mark.provokes(900002, 4, axis="Z")
def test_900002_when_the_drive_never_acknowledges() -> None:
    willing, silent = FakeLatch("X"), FakeLatch("Z")
    stage = Stage(willing, silent)
    stage.cycle()
    willing.is_armed = True
    alarm, number = _alarm(stage, HANDSHAKE_CYCLES_MAX + 5)
    assert (alarm.id, number) == (900002, HANDSHAKE_CYCLES_MAX + 1)
    assert alarm.values == {"axis": "Z", "cycles": HANDSHAKE_CYCLES_MAX}
    assert Order.START not in stage.orders


@pytest.mark.parametrize("late", [0, 1, HANDSHAKE_CYCLES_MAX])
def test_the_handshake_may_take_as_long_as_is_stated(late: int) -> None:
    latch = FakeLatch(is_clear=False)
    stage = Stage(latch)
    stage.cycles(late)
    latch.is_clear = True
    assert stage.cycle() is RunState.ARMING
    stage.cycles(late)
    latch.is_armed = True
    assert stage.cycle() is RunState.MOVING


def test_the_slowest_drive_decides_when_all_are_armed_and_when_the_path_starts() -> None:
    x, z = FakeLatch("X"), FakeLatch("Z", is_clear=False)
    stage = Stage(x, z)
    stage.cycles(2)
    assert (x.orders, z.orders) == (["disarm"], ["disarm"])
    z.is_clear = True
    stage.cycle()
    assert (x.orders, z.orders) == (["disarm", "arm"], ["disarm", "arm"])
    x.is_armed = True
    assert stage.cycle() is RunState.ARMING
    z.is_armed = True
    stage.cycle()
    assert stage.orders[-1] is Order.START


# A latch of an earlier run


def test_a_stale_latch_is_waited_out_and_its_value_never_taken() -> None:
    """60B9 still shows the edge of the run before, and 60BA its position."""
    latch = FakeLatch(is_clear=False, has_latched=True, latched_mm=77.0)
    stage = Stage(latch)
    stage.cycles(5)
    assert stage.run.state is RunState.CLEARING
    assert "arm" not in latch.orders

    latch.is_clear, latch.has_latched, latch.latched_mm = True, False, None
    stage.cycle()
    latch.is_armed = True
    stage.cycle()
    assert stage.orders == [Order.NONE] * 6 + [Order.START]
    stage.cycles(3)
    latch.latch(50.0)
    stage.cycle()
    stage.cycle(standing=True)
    assert stage.run.record.latched_mm == {"Z": 50.0}


def test_a_value_without_a_reported_edge_ends_nothing() -> None:
    """60BA keeps the old position after 60B9 is clear; only the edge brakes."""
    latch = FakeLatch(latched_mm=77.0)
    stage = Stage(latch).move()
    stage.cycles(4)
    assert Order.BRAKE not in stage.orders
    assert stage.run.record.signal_ns is None


# Values


def test_900001_for_an_edge_whose_value_is_never_proved() -> None:
    latch = FakeLatch()
    stage = Stage(latch).move()
    latch.latch(None)
    stage.cycle()
    alarm, number = _alarm(stage, PROOF_CYCLES_MAX + 5, standing=True)
    assert (alarm.id, number) == (900001, PROOF_CYCLES_MAX + 1)
    assert alarm.values == {"axis": "Z", "cycles": PROOF_CYCLES_MAX}


def test_a_proved_value_may_come_later_than_the_edge() -> None:
    latch = FakeLatch()
    stage = Stage(latch).move()
    latch.latch(None)
    stage.cycle()
    stage.cycles(PROOF_CYCLES_MAX, standing=True)
    latch.latched_mm = 12.5
    assert stage.cycle(standing=True) is RunState.DONE
    assert stage.run.record.latched_mm == {"Z": 12.5}


def test_the_value_is_kept_when_a_later_cycle_lacks_it() -> None:
    """One axis has its value while another still has none; a lost telegram takes nothing back."""
    x, z = FakeLatch("X"), FakeLatch("Z")
    stage = Stage(x, z).move()
    x.latch(3.0)
    z.latch(None)
    stage.cycle()
    stage.cycle(standing=True)
    x.latched_mm = None
    stage.cycle(standing=True)
    z.latched_mm = 4.0
    stage.cycle(standing=True)
    assert stage.run.record.latched_mm == {"X": 3.0, "Z": 4.0}


def test_axes_that_latch_in_different_cycles_brake_once_at_the_first() -> None:
    x, y, z = FakeLatch("X"), FakeLatch("Y"), FakeLatch("Z")
    stage = Stage(x, y, z).move()  # cycles 1 and 2
    stage.cycle()
    y.latch(2.0)
    stage.cycle()  # 4: brakes
    x.latch(1.0)
    stage.cycle()
    stage.cycle(standing=True, resting=False)
    assert stage.run.state is RunState.COLLECTING
    z.latch(3.0)
    assert stage.cycle(standing=True) is RunState.DONE
    assert stage.orders.count(Order.BRAKE) == 1
    assert stage.run.record.signal_ns == 4 * MS
    assert stage.run.record.latched_mm == {"X": 1.0, "Y": 2.0, "Z": 3.0}
    assert all(port.orders == ["disarm", "arm", "disarm"] for port in (x, y, z))


def test_900003_names_the_silent_axes_and_the_others() -> None:
    x, y, z = FakeLatch("X"), FakeLatch("Y"), FakeLatch("Z")
    stage = Stage(x, y, z).move()
    y.latch(2.0)
    stage.cycle()
    alarm, number = _alarm(stage, 5, standing=True)
    assert (alarm.id, number) == (900003, 1)
    assert alarm.values == {"axis": "X Z", "others": "Y"}


def test_a_run_that_an_alarm_ends_leaves_no_value_of_any_axis() -> None:
    """One probe, of which Y alone has the signal: what Y has latched is no result either."""
    x, y = FakeLatch("X"), FakeLatch("Y")
    stage = Stage(x, y).move()
    y.latch(2.0)
    stage.cycle()
    _alarm(stage, 5, standing=True)
    stage.run.abort()
    assert stage.run.record.latched_mm == {}


# No signal


@pytest.mark.parametrize("error_no_signal", [False, True])
def test_no_signal_is_an_error_only_with_p_chan_00176(error_no_signal: bool) -> None:
    latch = FakeLatch()
    stage = Stage(latch, error_no_signal=error_no_signal).move()
    stage.cycle()
    if error_no_signal:
        alarm, _ = _alarm(stage, 5, standing=True)
        assert (alarm.id, alarm.values) == (900004, {"axis": "Z"})
        return
    stage.cycle(standing=True)
    assert stage.run.state is RunState.DONE
    assert Order.BRAKE not in stage.orders
    record = stage.run.record
    assert (record.signal_ns, record.latched_mm, record.has_signal) == (None, {}, False)
    assert latch.orders == ["disarm", "arm", "disarm"]


def test_an_edge_in_the_last_moment_still_counts() -> None:
    """The axes creep inside their windows when it appears."""
    latch = FakeLatch()
    stage = Stage(latch).move()
    stage.cycle()
    stage.cycles(3, standing=True, resting=False)
    latch.latch(None)
    stage.cycle(standing=True, resting=False)  # 7 ms
    latch.latched_mm = 80.0
    assert stage.cycle(standing=True) is RunState.DONE
    assert stage.run.record.signal_ns == 7 * MS
    assert stage.run.record.latched_mm == {"Z": 80.0}


def test_an_edge_that_comes_with_its_value_while_standing_has_an_instant() -> None:
    latch = FakeLatch()
    stage = Stage(latch).move()
    stage.cycle()
    stage.cycles(3, standing=True, resting=False)
    latch.latch(80.0)
    assert stage.cycle(standing=True) is RunState.DONE  # 7 ms
    assert stage.run.record.signal_ns == 7 * MS


@pytest.mark.parametrize("error_no_signal", [False, True])
def test_an_edge_after_the_axes_have_come_to_rest_is_no_signal(error_no_signal: bool) -> None:
    latch = FakeLatch()
    stage = Stage(latch, error_no_signal=error_no_signal).move()
    stage.cycle()
    stage.cycle(resting=True)
    latch.latch(80.0)
    if error_no_signal:
        alarm, _ = _alarm(stage, 5, standing=True)
        assert alarm.id == 900004
        return
    stage.cycles(3, standing=True)
    assert stage.run.state is RunState.DONE
    record = stage.run.record
    assert (record.signal_ns, record.latched_mm, Order.BRAKE in stage.orders) == (None, {}, False)


def test_one_axis_that_latches_after_the_standstill_is_silent() -> None:
    x, z = FakeLatch("X"), FakeLatch("Z")
    stage = Stage(x, z).move()
    x.latch(1.0)
    stage.cycle()
    stage.cycle(resting=True)
    z.latch(2.0)
    alarm, number = _alarm(stage, 5, standing=True)
    assert (alarm.id, number, alarm.values) == (900003, 1, {"axis": "Z", "others": "X"})


def test_a_stamp_that_never_comes_is_no_proof() -> None:
    latch = FakeLatch(arrival=Arrival(0, 3, StampClock(start=1), stamp=0))
    stage = Stage(latch).move()
    stage.cycle(resting=True)
    latch.latch(80.0)
    alarm, number = _alarm(stage, PROOF_CYCLES_MAX + 5, standing=True)
    assert (alarm.id, number) == (900001, PROOF_CYCLES_MAX + 1)


@pytest.mark.provokes(900083, 4, axis="Z", cycles=200)
def test_a_latch_that_sdo_does_not_confirm_is_no_measurement() -> None:
    latch = FakeLatch(confirms=False)
    stage = Stage(latch).move()
    latch.latch(1.0)
    stage.cycles(CHECK_CYCLES_MAX, standing=True)
    with pytest.raises(Alarm) as alarm:
        stage.cycles(2, standing=True)
    assert alarm.value.id == 900083
    assert stage.run.record.latched_mm == {}


def test_the_path_waits_for_what_a_latch_will_be_checked_with() -> None:
    latch = FakeLatch(is_armed=True, is_prepared=False)
    stage = Stage(latch)
    stage.cycles(3, standing=True)
    assert stage.run.state is RunState.ARMING
    latch.is_prepared = True
    stage.cycle(standing=True)
    assert stage.run.state is RunState.MOVING


def test_a_latch_that_takes_its_own_time_leaves_the_others_theirs() -> None:
    """X raises its own alarm when it takes long, as at the PLC; Z has 16 cycles after it."""
    x, z = FakeLatch("X", is_armed=False), FakeLatch("Z", is_armed=False)
    x.arrival = Arrival(handshake_cycles=None)
    stage = Stage(x, z)
    stage.cycles(100)
    assert stage.run.state is RunState.ARMING
    x.is_armed = True
    stage.cycles(HANDSHAKE_CYCLES_MAX)
    z.is_armed = True
    assert stage.cycle() is RunState.MOVING


def test_900082_when_a_probe_is_switched_off_while_the_axes_rest() -> None:
    latch = FakeLatch()
    stage = Stage(latch).move()
    latch.latch(None)
    stage.cycle()
    stage.cycles(3, standing=True)
    latch.is_armed = False
    with pytest.raises(Alarm) as alarm:
        stage.cycle(standing=True)
    assert alarm.value.id == 900082


def test_one_value_that_waits_for_sdo_gives_another_without_proof_no_more_time() -> None:
    """X is proved and not confirmed, Z has an edge and no value: 16 cycles, and Z is named."""
    x, z = FakeLatch("X", confirms=False), FakeLatch("Z")
    stage = Stage(x, z).move()
    x.latch(1.0)
    z.latch(None)
    stage.cycle()
    alarm, number = _alarm(stage, CHECK_CYCLES_MAX, standing=True)
    assert (alarm.id, alarm.values["axis"]) == (900001, "Z")
    assert number == PROOF_CYCLES_MAX + 1
