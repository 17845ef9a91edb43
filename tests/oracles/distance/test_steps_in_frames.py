"""Dead cycles from frames: what is a step of the sensor value, and what answers and shows it.

The sensor value steps by 10 increments in cycle 7, the set position answers in cycle 8 and the
sensor value shows that in cycle 10: a reaction of one cycle and a way of two.
"""

from collections.abc import Iterator
from itertools import count

import pytest

from axisrig.bench.oracles.distance.cycles import (
    DeadCycles,
    NotMeasurableError,
    Sent,
    measured,
)
from axisrig.kernel.time.clock import MS, US


def test_a_set_position_that_changes_before_the_sensor_value_answers_nothing() -> None:
    """Even 1 ns before it, in the same cycle."""
    sensor = [Sent(0, 0), Sent(7 * MS + 300 * US, 10), Sent(10 * MS, 4)]
    targets = [Sent(0, 500), Sent(7 * MS + 300 * US - 1, 494)]
    with pytest.raises(NotMeasurableError, match="no set position answered"):
        measured(targets, sensor, MS)


def test_values_that_repeat_the_one_before_may_be_left_out() -> None:
    """Only what changes: the same instants, the same cycles."""
    sensor = [Sent(k * MS + 300 * US, 0 if k < 7 else 10 if k < 10 else 4) for k in range(15)]
    targets = [Sent(k * MS + 100 * US, 500 if k < 8 else 494) for k in range(15)]
    found = measured(targets, sensor, MS)
    assert found.cycles == DeadCycles(1, 2)
    assert measured(targets[::8], [sensor[k] for k in (0, 7, 10)], MS) == found


def test_a_record_is_read_no_farther_than_needed() -> None:
    """Both go on for ever; of the set positions none is asked for after the answer."""
    asked = []

    def endless(values: dict[int, int]) -> Iterator[Sent]:
        value = 0
        for k in count():
            value = values.get(k, value)
            asked.append(k)
            yield Sent(k * MS, value)

    found = measured(endless({8: -6}), endless({7: 10, 10: 4}), MS)
    assert found.cycles == DeadCycles(1, 2)
    assert max(asked) == 10


@pytest.mark.parametrize(
    ("rest_ns", "is_step"), [(2_499_999, False), (2_500_000, True), (3_000_000, True)]
)
def test_three_cycles_of_rest_may_be_short_by_half_a_cycle(rest_ns: int, is_step: bool) -> None:
    """The first frame of a record may have come late in its cycle."""
    begin_ns = 7 * MS - rest_ns
    sensor = [Sent(begin_ns, 0), Sent(7 * MS, 10), Sent(10 * MS, 4)]
    targets = [Sent(begin_ns, 500), Sent(8 * MS, 494)]
    if is_step:
        assert measured(targets, sensor, MS).cycles == DeadCycles(1, 2)
        return
    with pytest.raises(NotMeasurableError, match="was not constant before its change"):
        measured(targets, sensor, MS)


@pytest.mark.parametrize(("back", "is_step"), [(4, True), (9, True), (11, False), (16, False)])
@pytest.mark.parametrize("side", [1, -1])
def test_an_answer_takes_the_sensor_value_back(back: int, is_step: bool, side: int) -> None:
    sensor = [Sent(0, 0), Sent(7 * MS, 10 * side), Sent(10 * MS, back * side)]
    targets = [Sent(US, 500), Sent(8 * MS + US, 500 - 6 * side)]
    if is_step:
        assert measured(targets, sensor, MS).cycles == DeadCycles(1, 2)
        return
    with pytest.raises(NotMeasurableError, match="went on changing"):
        measured(targets, sensor, MS)


@pytest.mark.parametrize(("before", "is_step"), [(5, True), (6, False), (-6, False)])
def test_a_change_beyond_the_noise_is_the_first_step(before: int, is_step: bool) -> None:
    """At 4 T one of exactly the noise is none; one increment more is a step without an answer."""
    sensor = [Sent(0, 0), Sent(4 * MS, before), Sent(7 * MS, 20), Sent(10 * MS, 4)]
    targets = [Sent(US, 500), Sent(8 * MS + US, 494)]
    if is_step:
        found = measured(targets, sensor, MS, quiet_increments=5)
        assert (found.seen_ns, found.cycles) == (7 * MS, DeadCycles(1, 2))
        return
    with pytest.raises(NotMeasurableError, match="the sensor value went on changing"):
        measured(targets, sensor, MS, quiet_increments=5)
