"""Dead cycles from frames: which cycle a frame is of, wherever in the cycle it came."""

import pytest

from axisrig.bench.oracles.distance.cycles import Measured, Sent, measured

PERIOD_NS = 1_000_000
STEP = 5
"""Cycle of the first sensor value that changed."""


def found(
    reaction: int, way: int, sensor_ns: int, target_ns: int, first: int = 0, sign: int = 1
) -> Measured:
    """sensor_ns, target_ns: where in its cycle each frame ends. first: cycle of the first one."""
    answer = STEP + reaction
    sensor = [
        Sent((first + k) * PERIOD_NS + sensor_ns,
             sign * (0 if k < STEP else 10 if k < answer + way else 4))
        for k in range(answer + way + 5)
    ]  # fmt: skip
    targets = [
        Sent((first + k) * PERIOD_NS + target_ns, 0 if k < answer else -6 * sign)
        for k in range(answer + way + 5)
    ]
    return measured(targets, sensor, PERIOD_NS)


PLACES = (0, 1, 300_000, 700_000, PERIOD_NS - 1)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("sensor_ns", PLACES)
@pytest.mark.parametrize("target_ns", PLACES)
def test_a_reaction_is_counted_from_cycle_to_cycle(
    sensor_ns: int, target_ns: int, sign: int
) -> None:
    """A set position that leaves earlier in its cycle than the value came is a cycle later."""
    for reaction in (0, 1, 3):
        if reaction == 0 and target_ns <= sensor_ns:
            continue  # it had left before the value came
        for way in (1, 2, 4):
            for first in (0, 7_000):
                one = found(reaction, way, sensor_ns, target_ns, first, sign)
                assert (one.cycles.reaction, one.cycles.way) == (reaction, way)
                assert one.cycles.dead == reaction + way - 1
                assert one.seen_ns == (first + STEP) * PERIOD_NS + sensor_ns
                assert one.sent_ns == (first + STEP + reaction) * PERIOD_NS + target_ns
                assert one.way_ns == way * PERIOD_NS + sensor_ns - target_ns


def test_a_value_later_in_the_cycle_of_the_set_position_shows_it() -> None:
    """A sensor that is faster than the cycle: its way is 0 cycles."""
    one = found(1, 0, 700_000, 300_000)
    assert (one.cycles.way, one.way_ns) == (0, 400_000)
