"""Dead time of a loop from signals that are written down: in cycles, and in frames."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.tools.tune.distance import _dead_time, _identified
from axisrig.bench.tools.tune.identify import Path
from axisrig.bench.tools.tune.measure import REST_CYCLES, Signals

STEP_MM, CYCLES, COUNT = 0.1, 40, 4
BEGIN = REST_CYCLES + 7


def late(values: Any, cycles: int) -> Any:
    return np.concatenate([np.full(cycles, values[0]), values[: len(values) - cycles]])


def signals(reaction: int, drive: int, sensor: int, renewal: int = 1, phase: int = 0) -> Signals:
    """Steps of the offset up and down, each in some cycles; all else are the same, but later.

    The distance is new in every cycle `phase` of `renewal`, and stays between.
    """
    steps = np.repeat([STEP_MM * (1 - n % 2) for n in range(COUNT)], CYCLES)
    offset = np.zeros(BEGIN + len(steps))
    for cycle, target in enumerate(steps, BEGIN):
        offset[cycle] = offset[cycle - 1] + 0.4 * (target - offset[cycle - 1])
    cycles = np.arange(len(offset))
    new = cycles - (cycles - phase) % renewal
    distance = 2.0 + late(offset, sensor)[np.maximum(new, 0)]
    return Signals(
        offset * 0, offset, 30 + late(offset, reaction), 30 + late(offset, drive), distance
    )


@pytest.mark.parametrize(("renewal", "phase"), [(1, 0), (2, 0), (2, 1), (3, 0), (3, 1), (3, 2)])
@pytest.mark.parametrize("sensor", [2, 3])
def test_a_value_that_stays_for_some_cycles_is_as_old_as_it_may_be(
    sensor: int, renewal: int, phase: int
) -> None:
    """In its last cycle it is older by all of them but one."""
    distance, actual = _identified(signals(1, 2, sensor, renewal, phase), CYCLES)
    assert (distance.renewal_cycles, distance.is_dead_time) == (renewal, True)
    assert distance.first_cycle == sensor + renewal - 1
    assert distance.gain == pytest.approx(1.0, abs=1e-6)
    assert (actual.first_cycle, actual.is_dead_time, actual.renewal_cycles) == (2, True, 1)


def frames(first_ns: int, changed: int, to: int) -> Any:
    """A telegram in every ms, whose value leaves its place of rest in row `changed`."""
    rows = np.arange(BEGIN + 20)
    return SimpleNamespace(
        frame_ns=rows * 1_000_000 + first_ns, increments=np.where(rows < changed, 500, to)
    )


@pytest.mark.parametrize("to", [900, 100])
@pytest.mark.parametrize("reaction", [0, 1])
def test_the_dead_time_is_of_the_cycles_and_of_the_frames(reaction: int, to: int) -> None:
    """The set position goes out at 0.7 ms of its cycle; the sensor shows it 2 cycles later, at 0.2.

    The first step of the offset is 0.4 of the whole; of the sensor the first one that differs.
    """
    path = Path(np.eye(1, CYCLES, 3)[0], 0.0, 0.0, renewal_cycles=2)
    sent = BEGIN + reaction
    run: Any = SimpleNamespace(
        signals=signals(reaction, 2, 3),
        targets=frames(700_000, sent, to), sensor=frames(200_000, sent + 2, to),
    )  # fmt: skip
    found = _dead_time(run, path, is_encoder=True)
    assert (found.reaction, found.way, found.renewal) == (reaction, 3 - reaction, 2)
    assert found.dead == 2
    assert found.way_ns == 1_500_000
    assert _dead_time(run, path, is_encoder=False).way_ns is None
    run.sensor = SimpleNamespace(frame_ns=np.array([], dtype=np.int64))
    assert _dead_time(run, path, is_encoder=True).way_ns is None


def way_ns(before: Any, after: Any, *, sent: int, first_ns: int = 0) -> int | None:
    """Return the way of a step that goes out in a ms, to a sensor with these values, one a ms.

    first_ns: instant of the first value of the sensor.
    """
    path = Path(np.eye(1, CYCLES, 3)[0], 0.0, 0.0)
    values = np.concatenate([before, after])
    targets = np.where(np.arange(len(values)) < sent, 0, 1000)
    run: Any = SimpleNamespace(
        signals=signals(1, 2, 3),
        targets=SimpleNamespace(
            frame_ns=np.arange(len(values)) * 1_000_000, increments=targets
        ),
        sensor=SimpleNamespace(
            frame_ns=np.arange(len(values)) * 1_000_000 + first_ns, increments=values
        ),
    )  # fmt: skip
    return _dead_time(run, path, is_encoder=True).way_ns


@pytest.mark.parametrize("to", [-1, 1])
@pytest.mark.parametrize("approach", [5000, -5000, 0])
def test_the_place_of_rest_is_that_before_the_step_wherever_the_axis_came_from(
    approach: int, to: int
) -> None:
    """It came there in 100 cycles and was at rest for as long as a rest is; 4 ms to the sensor."""
    came = 700 + np.linspace(approach, 0, 100).astype(np.int64)
    before = np.concatenate([came, np.full(REST_CYCLES + 4, 700)])
    found = way_ns(before, np.full(30, 700 + 400 * to), sent=len(before) - 4)
    assert found == 4_000_000


@pytest.mark.parametrize("to", [-1, 1])
def test_a_value_has_left_its_place_by_more_than_its_noise_and_an_increment(to: int) -> None:
    """Noise of 10 and -10 is 10; six of it and one increment are 61 from the middle."""
    rest = 700 + np.resize([10, -10], REST_CYCLES)
    moved = np.array([61, 61, 62, 300, 300]) * to
    assert way_ns(rest, 700 + moved, sent=REST_CYCLES - 1) == 3_000_000
    quiet = np.full(REST_CYCLES, 700)
    assert way_ns(quiet, 700 + np.array([1, 1, 1, 2, 9]) * to, sent=REST_CYCLES - 1) == 4_000_000


def test_a_place_of_rest_may_be_shorter_and_a_value_before_the_step_is_no_answer() -> None:
    """A value in the instant of the step is one before it, however far away it is."""
    rest = np.full(20, 700)
    rest[3] = 4700  # a standard deviation of 872: what comes is further away than six of it
    assert way_ns(rest, np.full(9, 99_700), sent=19) == 1_000_000
    late = np.full(REST_CYCLES + 1, 700)
    late[-1] = 702
    assert way_ns(late, np.full(9, 900), sent=REST_CYCLES) == 1_000_000
    assert way_ns(late, np.full(9, 900), sent=REST_CYCLES, first_ns=1) == 1
    assert way_ns(late, np.full(9, 900), sent=REST_CYCLES, first_ns=-1) == 999_999
