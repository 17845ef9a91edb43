"""Closed forms at the ends of what they are for: no limit, no way, no kp, no row."""

import math

import numpy as np
import pytest

from axisrig.bench.oracles.distance.limits import stopping_step_mm
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, Loop
from axisrig.bench.oracles.distance.sample_hold import held_limit
from axisrig.bench.oracles.distance.stability import kp_limit
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
