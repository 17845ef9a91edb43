"""A measurement run that ends without a signal, and edges in the last moment."""

import pytest
from tests.measuring.fake_latch import MS, FakeLatch, Stage, next_alarm

from axisrig.kernel.measuring.run import (
    Order,
    RunState,
)


@pytest.mark.parametrize("error_no_signal", [False, True])
def test_no_signal_is_an_error_only_with_p_chan_00176(error_no_signal: bool) -> None:
    latch = FakeLatch()
    stage = Stage(latch, error_no_signal=error_no_signal).move()
    stage.cycle()
    if error_no_signal:
        alarm, _ = next_alarm(stage, 5, standing=True)
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
        alarm, _ = next_alarm(stage, 5, standing=True)
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
    alarm, number = next_alarm(stage, 5, standing=True)
    assert (alarm.id, number, alarm.values) == (900003, 1, {"axis": "Z", "others": "X"})
