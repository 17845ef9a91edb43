"""Values of a measurement run: stale, late, unproved, unconfirmed; axes without a signal."""

import pytest
from tests.measuring.fake_latch import MS, FakeLatch, Stage, next_alarm

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival, StampClock
from axisrig.kernel.measuring.run import (
    CHECK_CYCLES_MAX,
    PROOF_CYCLES_MAX,
    Order,
    RunState,
)


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
    alarm, number = next_alarm(stage, PROOF_CYCLES_MAX + 5, standing=True)
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
    alarm, number = next_alarm(stage, 5, standing=True)
    assert (alarm.id, number) == (900003, 1)
    assert alarm.values == {"axis": "X Z", "others": "Y"}


def test_a_run_that_an_alarm_ends_leaves_no_value_of_any_axis() -> None:
    """One probe, of which Y alone has the signal: what Y has latched is no result either."""
    x, y = FakeLatch("X"), FakeLatch("Y")
    stage = Stage(x, y).move()
    y.latch(2.0)
    stage.cycle()
    next_alarm(stage, 5, standing=True)
    stage.run.abort()
    assert stage.run.record.latched_mm == {}


def test_a_stamp_that_never_comes_is_no_proof() -> None:
    latch = FakeLatch(arrival=Arrival(0, 3, StampClock(start=1), stamp=0))
    stage = Stage(latch).move()
    stage.cycle(resting=True)
    latch.latch(80.0)
    alarm, number = next_alarm(stage, PROOF_CYCLES_MAX + 5, standing=True)
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


def test_one_value_that_waits_for_sdo_gives_another_without_proof_no_more_time() -> None:
    """X is proved and not confirmed, Z has an edge and no value: 16 cycles, and Z is named."""
    x, z = FakeLatch("X", confirms=False), FakeLatch("Z")
    stage = Stage(x, z).move()
    x.latch(1.0)
    z.latch(None)
    stage.cycle()
    alarm, number = next_alarm(stage, CHECK_CYCLES_MAX, standing=True)
    assert (alarm.id, alarm.values["axis"]) == (900001, "Z")
    assert number == PROOF_CYCLES_MAX + 1
