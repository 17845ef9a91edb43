"""A measurement run: its states, the handshake with the latches, a probe that is actuated."""

import pytest
from tests.measuring.fake_latch import MS, FakeLatch, Stage, next_alarm

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import HANDSHAKE_CYCLES_MAX, Arrival
from axisrig.kernel.measuring.run import (
    Order,
    RunState,
)


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
    assert next_alarm(stage, 1)[0].id == 900082


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
    alarm, _ = next_alarm(stage, 1)
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
    alarm, number = next_alarm(Stage(latch), HANDSHAKE_CYCLES_MAX + 5)
    assert (alarm.id, number) == (900009, HANDSHAKE_CYCLES_MAX + 1)
    assert alarm.values == {"axis": "Z"}
    assert "arm" not in latch.orders


@pytest.mark.provokes(900002, 4, axis="Z")
def test_900002_when_the_drive_never_acknowledges() -> None:
    willing, silent = FakeLatch("X"), FakeLatch("Z")
    stage = Stage(willing, silent)
    stage.cycle()
    willing.is_armed = True
    alarm, number = next_alarm(stage, HANDSHAKE_CYCLES_MAX + 5)
    assert (alarm.id, number) == (900002, HANDSHAKE_CYCLES_MAX + 1)
    assert alarm.values == {"axis": "Z", "cycles": HANDSHAKE_CYCLES_MAX}
    assert Order.START not in stage.orders


def test_a_drive_behind_a_probe_of_the_plc_has_its_cycles_from_where_it_is_armed() -> None:
    """X answers after 10 cycles, the PLC switches the probe of Z on in 5, and its drive takes 16.

    What X has taken is no part of them.
    """
    slow, switched = FakeLatch("X"), FakeLatch("Z", arrival=Arrival(handshake_cycles=None))
    stage = Stage(slow, switched)
    stage.cycles(10)
    slow.is_armed = True
    stage.cycles(5)
    switched.arrival = Arrival()
    stage.cycles(HANDSHAKE_CYCLES_MAX)
    switched.is_armed = True
    assert stage.cycle() is RunState.MOVING


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
