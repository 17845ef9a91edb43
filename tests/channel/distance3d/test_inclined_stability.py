"""Up to which kp 3D distance control is stable: searched over ideal axes, beside the closed forms.

The axes are where they were sent a cycle ago, so the loop has no dead cycle with optimized
scheduling and one without. b is the tilt of the tool, p the slope of the surface in its plane.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from axisrig.bench.oracles.distance.lists import Control
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS, Loop
from axisrig.bench.oracles.distance.smoothing import none, of_control
from axisrig.bench.oracles.distance.stability import kp_limit
from axisrig.bench.oracles.distance.tool import ECS, inclined_gain
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
LEVEL_DEG = (0.0, 30.0, 60.0, 75.0)
INCLINED_DEG = ((60.0, 10.0), (75.0, 10.0), (60.0, 30.0), (75.0, -10.0))
DIVIDED_BY = (1.286, 1.633, 1.732, 0.337)
WITHIN = 0.02
UNBOUNDED = {
    "v_max_mm_s": 1e15, "a_max_mm_s2": 1e18, "max_deviation_mm": 1e12, "max_change_mm_s": 1e15,
    "min_pos_mm": -1e12, "max_pos_mm": 1e12,
}  # fmt: skip
FILTERS: tuple[dict[str, Any], ...] = ({}, {"filter_type": "MOVING_AVERAGE", "n_cycles": 4})


class Search:
    """Finds the limit of kp of a channel's control, from how its offset swings."""

    def __init__(self, make: Make, tool: Any, mode: str, tilt_deg: float, slope_deg: float) -> None:
        self._make, self._tool, self._mode = make, tool, mode
        self._tilt_deg, slope = tilt_deg, math.radians(slope_deg)
        # A negative A leans the tool to +Y, and so does this normal
        self._normal = np.array((0.0, math.sin(slope), math.cos(slope)))

    def is_stable(self, kp: float, law: str, **changes: Any) -> bool:
        """Whether the offset swings less and less after a step of the surface by 0.01 mm."""
        tool, normal = self._tool, self._normal
        u = tool.turned(0.0, -self._tilt_deg)
        set_dist = tool.tool_mm * float(normal @ u) / float(u[2])

        def height_mm(cycle: int) -> float:
            return 0.01 if cycle >= 2 else 0.0

        plane = tool.plane(normal, height_mm)
        program = ((0.0, 0.0, 0.0), 0.0, -self._tilt_deg)
        loop = self._make(lambda _cycle: program, plane, kp=kp, **UNBOUNDED, **changes)
        loop.plan(self._mode, "Z")
        if law == CONST_DIST:
            loop.on(set_dist=set_dist if self._mode != "ACS" else tool.tool_mm * normal @ u)
        else:
            clamp = tool.tool_mm * u
            loop.on(set_pos=float(clamp[2] - normal @ clamp))
        steps = np.abs(np.diff(loop.run(140).offsets_mm))
        early, late = np.max(steps[30:80]), np.max(steps[90:])
        return bool(late < early or late < 1e-9)

    def limit(self, near: float, law: str, **changes: Any) -> float:
        """Halve an interval of 8 % around a value; its ends must be stable and not."""
        low, high = near * 0.96, near * 1.04
        assert self.is_stable(low, law, **changes)
        assert not self.is_stable(high, law, **changes)
        for _ in range(4):
            middle = (low + high) / 2.0
            low, high = (middle, high) if self.is_stable(middle, law, **changes) else (low, middle)
        return (low + high) / 2.0


@pytest.fixture
def search(make_tool_loop: Make, tool: Any) -> Callable[..., Search]:
    return lambda *words: Search(make_tool_loop, tool, *words)


def expected(law: str, dead: int, smooth: dict[str, Any], gain: float = 1.0) -> float:
    """The limit of the control of an axis, of a loop that sees `gain` of its offset."""
    count = smooth.get("n_cycles", 0)
    control = Control(filter_type="MOVING_AVERAGE", count=max(count, 1))
    return kp_limit(Loop(law, dead, of_control(control, MS) if count else none(), gain=gain))


@pytest.mark.parametrize("mode", ["MCS", "ECS"])
@pytest.mark.parametrize("tilt", LEVEL_DEG)
@pytest.mark.long(but=1)
def test_over_a_parallel_surface_it_is_that_of_an_axis(
    search: Callable[..., Search], mode: str, tilt: float
) -> None:
    """2 without dead cycle, 1 with one, whatever the tool leans."""
    found = search(mode, tilt, 0.0).limit(2.0, CONST_DIST)
    assert found == pytest.approx(2.0, rel=WITHIN)
    late = search(mode, tilt, 0.0).limit(1.0, CONST_DIST, is_optimized=False)
    assert late == pytest.approx(1.0, rel=WITHIN)


@pytest.mark.long
@pytest.mark.parametrize("law", [CONST_DIST, SET_POS])
@pytest.mark.parametrize("smooth", FILTERS)
@pytest.mark.parametrize("dead", [0, 1])
@pytest.mark.parametrize("tilt", LEVEL_DEG)
def test_with_every_law_and_filter(
    search: Callable[..., Search], law: str, smooth: dict[str, Any], dead: int, tilt: float
) -> None:
    for mode in ("MCS", "ECS"):
        wanted = expected(law, dead, smooth)
        found = search(mode, tilt, 0.0).limit(wanted, law, is_optimized=not dead, **smooth)
        assert found == pytest.approx(wanted, rel=WITHIN)


@pytest.mark.long
@pytest.mark.parametrize(
    ("place", "divided"), list(zip(INCLINED_DEG, DIVIDED_BY, strict=True)), ids=str
)
def test_over_an_inclined_surface_along_the_tool(
    search: Callable[..., Search], place: tuple[float, float], divided: float
) -> None:
    """Divided by cos p + sin p tan b."""
    assert inclined_gain(ECS, *place) == pytest.approx(divided, abs=6e-4)
    found = search("ECS", *place).limit(1.0 / divided, CONST_DIST, is_optimized=False)
    assert found == pytest.approx(1.0 / divided, rel=WITHIN)


@pytest.mark.long
@pytest.mark.parametrize("mode", ["MCS", "ACS"])
@pytest.mark.parametrize("slope", [10.0, 30.0, -30.0])
def test_along_the_normal_or_an_axis_it_is_divided_by_cos_p(
    search: Callable[..., Search], mode: str, slope: float
) -> None:
    wanted = 1.0 / math.cos(math.radians(slope))
    found = search(mode, 40.0, slope).limit(wanted, CONST_DIST, is_optimized=False)
    assert found == pytest.approx(wanted, rel=WITHIN)


@pytest.mark.long
@pytest.mark.parametrize("place", INCLINED_DEG)
@pytest.mark.parametrize("smooth", FILTERS)
def test_a_surface_position_over_an_inclined_surface(
    search: Callable[..., Search], place: tuple[float, float], smooth: dict[str, Any]
) -> None:
    """What comes back of the offset, 1 - gain, is in the loop: not divided, but by its poles."""
    wanted = expected(SET_POS, 1, smooth, inclined_gain(ECS, *place))
    found = search("ECS", *place).limit(wanted, SET_POS, is_optimized=False, **smooth)
    assert found == pytest.approx(wanted, rel=WITHIN)
