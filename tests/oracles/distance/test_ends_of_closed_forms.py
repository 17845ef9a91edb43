"""Closed forms at the ends of what they are for: no limit, no way, no kp, no row."""

import math

import numpy as np
import pytest

from axisrig.bench.oracles.distance.filters import (
    Character,
    exponential_mean,
    kalman_exponential,
    kalman_mean,
)
from axisrig.bench.oracles.distance.following import settling_cycles
from axisrig.bench.oracles.distance.limits import stopping_step_mm
from axisrig.bench.oracles.distance.lists import as_written
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop, growth
from axisrig.bench.oracles.distance.sample_hold import held_limit
from axisrig.bench.oracles.distance.smoothing import moving_average
from axisrig.bench.oracles.distance.stability import closed_limit, kp_limit, mean_limit
from axisrig.bench.oracles.distance.supervision import (
    ABOVE,
    BELOW,
    JUMP,
    OFFSET,
    Due,
    first_due,
)
from axisrig.bench.oracles.distance.tool import ACS, MCS, ToolWay


@pytest.mark.parametrize(
    ("way_mm", "change_mm", "step_mm"),
    [
        (1.0, math.inf, math.inf), (0.0, math.inf, math.inf), (1.0, 0.0, 0.0), (1.0, -0.1, 0.0),
        (0.0, 0.1, 0.0), (0.05, 0.1, 0.05), (0.1, 0.1, 0.1),
        # From 0.1 on in two steps, s + (s - 0.1): 0.3 mm are 0.2 + 0.1; then three of them
        (0.2, 0.1, 0.15), (0.3, 0.1, 0.2), (0.45, 0.1, 0.25), (0.6, 0.1, 0.3),
    ],
)  # fmt: skip
def test_the_largest_step_from_which_a_way_ends_at_rest(
    way_mm: float, change_mm: float, step_mm: float
) -> None:
    assert stopping_step_mm(way_mm, change_mm) == pytest.approx(step_mm)


@pytest.mark.parametrize("mode", [CONST_DIST, BOTH])
@pytest.mark.parametrize("dead", [0, 2])
def test_a_loop_that_feeds_back_with_the_wrong_sign_is_stable_at_no_kp(
    mode: str, dead: int
) -> None:
    wrong = Loop(mode, dead, sign=-1)
    assert kp_limit(wrong) == 0.0
    assert held_limit(wrong, 2) == 0.0
    assert kp_limit(Loop(mode, dead)) > 0.3
    assert held_limit(Loop(mode, dead), 2) > 0.1


def test_an_offset_of_one_axis_moves_it_alone_and_no_row_moves_nothing() -> None:
    way = ToolWay(ACS, axis=1)
    axes = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    assert way.height_mm(axes).tolist() == [2.0, 5.0]
    assert way.share(axes).tolist() == [1.0, 1.0]
    moved = way.superposed(axes, np.array([0.5, -0.25]))
    assert moved.tolist() == [[1.0, 2.5, 3.0], [4.0, 4.75, 6.0]]
    assert axes[0, 1] == 2.0, "what is given stays as it was"
    assert way.rates(axes) == pytest.approx(np.array([[0.0, 1.0, 0.0]] * 2))
    none = np.zeros((0, 3))
    for one in (way, ToolWay(MCS)):
        assert one.superposed(none, np.zeros(0)).shape == (0, 3)


@pytest.mark.parametrize("count", [1, 2, 5])
@pytest.mark.parametrize("sigma_mm", [0.02, 0.1, 0.5])
def test_a_mean_of_the_newest_value_alone_is_that_value(count: int, sigma_mm: float) -> None:
    """With a smoothing factor of 1 no other one counts: the line through the last two values."""
    assert exponential_mean(count, 1.0) == Character(0.0, 1.0)
    assert kalman_exponential(count, 1.0, sigma_mm) == kalman_mean(1, sigma_mm)
    ratio = (0.1 / sigma_mm) ** 2
    trust = (5.0 + ratio) / (6.0 + ratio)  # 2 x - x_before: an energy of 4 + 1
    expected = math.sqrt((1.0 - trust) ** 2 * 5.0 + trust**2)
    assert kalman_mean(1, sigma_mm).noise_gain == pytest.approx(expected)


@pytest.mark.parametrize("mode", [CONST_DIST, BOTH, SET_POS])
def test_a_loop_that_nothing_drives_never_settles(mode: str) -> None:
    """Of kp 0 all of an error is left after a cycle; of a wrong sign more than that."""
    assert settling_cycles(Loop(mode, 2), 0.0, 0.01) == math.inf
    if mode != BOTH:  # both encoders see what was sent
        assert settling_cycles(Loop(mode, 2, sign=-1), 0.1, 0.01) == math.inf
    # 1 - kp a cycle without dead cycles
    assert settling_cycles(Loop(SET_POS, 0), 0.5, 0.25) == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("count", "dead", "limit"),
    [
        (1, 0, 2.0), (1, 1, 1.0), (1, 2, (math.sqrt(5) - 1) / 2), (2, 0, 2.0),
        (2, 1, 2 * math.sqrt(2) - 2), (3, 0, 1.5), (4, 1, 8 * math.sin(math.pi / 12) ** 2
                                                   / math.sin(math.pi / 3)),
    ],
)  # fmt: skip
def test_a_mean_of_several_values_is_stable_up_to_its_limit(
    count: int, dead: int, limit: float
) -> None:
    """2 N sin^2(w/2)/sin(N w/2), w = pi/(N + 2n), where the poles of the loop reach 1."""
    assert mean_limit(count, dead) == pytest.approx(limit)
    loop = Loop(CONST_DIST, dead, moving_average(count))
    assert closed_limit(loop, count) == pytest.approx(limit)
    assert growth(loop, 0.999 * limit) < 1.0 < growth(loop, 1.001 * limit)


@pytest.mark.parametrize(
    ("alarm", "sensor_mm", "change_mm", "offset_mm"),
    [
        (JUMP, 0.0, 0.5, 0.0), (JUMP, 0.0, -0.5, 0.0), (ABOVE, 5.5, 0.0, 0.0),
        (BELOW, -5.5, 0.0, 0.0), (OFFSET, 0.0, 0.0, 5.5), (OFFSET, 0.0, 0.0, -5.5),
    ],
)  # fmt: skip
@pytest.mark.parametrize(("watched", "row"), [(0, 3), (3, 3), (5, 5), (8, None)])
def test_nothing_is_due_in_a_row_that_is_not_watched(
    alarm: int, sensor_mm: float, change_mm: float, offset_mm: float, watched: int, row: int | None
) -> None:
    """Something is beyond its limit in rows 3 to 7; the control follows from a row on."""
    k = np.arange(10)
    is_beyond = (k >= 3) & (k < 8)
    values = (np.where(is_beyond, value, 0.0) for value in (sensor_mm, change_mm, offset_mm))
    found = first_due(*values, k >= watched, as_written({}).limits, 1_000_000)
    assert found == (None if row is None else Due(alarm, row))
