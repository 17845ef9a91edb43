"""What the axes of a tool or a robot leave the offset: their limits over how fast they go for 1 mm.

Rows and limits are those of `reports/tilted.py`; how fast each axis goes is given by the test.
"""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.judge.test_tool_truth import LIMITS, limited, truth
from tests.reports.tilted import ROWS

from axisrig.bench.judge.distance.times import Unbroken, unbroken
from axisrig.bench.judge.distance.tool import ToolTruth
from axisrig.bench.oracles.distance.lists import CHANNEL

AXES = ("X", "Y", "Z", "C", "A")
NAMES = ("set_mm", "superposed_mm")


class Led(ToolTruth):
    """Its way is one whose axes go as the test says; asked: for which instants and poses."""

    rates: Callable[[Any], Any]
    mode = "ECS"
    asked: tuple[list[int], list[Any]]

    def way_at(self, time_ns: int) -> Any:
        self.asked[0].append(time_ns)
        return SimpleNamespace(mode=self.mode, rates=self._rates)

    def _rates(self, poses: Any) -> Any:
        self.asked[1].append(poses)
        return self.rates(poses)


def led(rates: Callable[[Any], Any], columns: dict[str, Any] | None = None) -> Led:
    facts = limited("ECS").observed.facts
    found = Led(CHANNEL, truth("ECS", columns=columns, axes=facts.axes).observed)
    found.rates, found.asked = rates, ([], [])
    return found


@pytest.mark.parametrize(
    ("rates", "speed", "acceleration"),
    [
        ((1.0, 0.0, 0.0, 0.0, 0.0), 50.0, 4000.0), ((0.0, 0.0, 1.0, 0.0, 0.0), 200.0, 5000.0),
        ((1.0, 1.0, 0.0, 0.0, 0.0), 50.0, 900.0),  # X is slow, Y is weak
        ((-1.0, -1.0, 0.0, 0.0, 0.0), 50.0, 900.0), ((0.5, -2.0, 0.0, 0.0, 0.0), 40.0, 450.0),
        # rotary axes count in degrees: all axes of a robot do
        ((0.0, 0.0, 0.0, -2.0, 0.5), 0.5, 0.5), ((0.0, 0.0, 0.0, 0.1, -0.25), 4.0, 4.0),
        ((0.0, 0.0, 1.0, 0.001, 0.0), 200.0, 1000.0),
        ((0.0, 0.0, 1.0, 0.0, -0.004), 200.0, 250.0),
        ((0.0, 0.0, 1.0, 1e-13, 0.0), 200.0, 5000.0),  # it stands but for rounding
    ],
)  # fmt: skip
def test_the_slowest_and_the_weakest_of_all_axes_count(
    rates: tuple[float, ...], speed: float, acceleration: float
) -> None:
    """Each for itself, in whichever direction it goes."""
    found = led(lambda poses: np.tile(rates, (len(poses), 1))).axes_allow(100, 104)
    assert found == pytest.approx(np.tile([speed, acceleration], (4, 1)), rel=1e-12)


@pytest.mark.parametrize("rate", [0.0, 1e-9, -1e-9])
def test_axes_that_all_stand_leave_the_offset_whatever_it_wants(rate: float) -> None:
    """But for rounding."""
    found = led(lambda poses: np.full((len(poses), len(AXES)), rate)).axes_allow(100, 103)
    assert found is not None
    assert np.all(np.isinf(found))


@pytest.mark.parametrize(("begin", "end"), [(100, 106), (1, 4), (0, 5), (0, 1), (ROWS - 3, ROWS)])
def test_a_row_has_the_pose_of_the_one_before_without_the_offset(begin: int, end: int) -> None:
    """The first row of a run has its own."""
    at = np.arange(ROWS, dtype=float)
    columns = {"X.set_mm": at, "X.superposed_mm": 0.125 * (at % 3)}
    tool = led(lambda poses: np.outer(1.0 + poses[:, 0], (0.0, 0.0, 1.0, 0.0, 0.0)), columns)
    found = tool.axes_allow(begin, end)
    before = np.maximum(np.arange(begin, end) - 1, 0)
    per_mm = 1.0 + before - 0.125 * (before % 3)
    assert found == pytest.approx(np.array(LIMITS["Z"]) / per_mm[:, None], rel=1e-12)


def test_equal_poses_are_asked_once_and_in_the_way_of_the_first_row() -> None:
    stands = {f"{axis}.{name}": np.zeros(ROWS) for axis in "XYZ" for name in NAMES}
    tool = led(lambda poses: np.ones((len(poses), len(AXES))), stands)
    found = tool.axes_allow(310, 330)
    assert found is not None
    assert found.shape == (20, 2)
    assert [len(poses) for poses in tool.asked[1]] == [1]
    assert tool.asked[0] == [tool.observed.time_ns(310)]


def test_one_axis_that_carries_the_offset_alone_has_no_share() -> None:
    tool = led(lambda poses: np.ones((len(poses), len(AXES))))
    tool.mode = "ACS"
    assert tool.axes_allow(100, 110) is None
    assert tool.asked[1] == []


@pytest.mark.parametrize(
    ("parts", "found"),
    [
        ([[], [4, 4]], [(0, 2, 4)]), ([[4, 4], []], [(0, 2, 4)]), ([[]], []), ([], []),
        ([[4], [], [4, 5]], [(0, 2, 4), (2, 3, 5)]), ([[4, 5], [5, 4]], [(0, 1, 4), (1, 3, 5),
                                                                        (3, 4, 4)]),
        ([[1, 1, 0, 1]], [(0, 2, 1), (2, 3, 0), (3, 4, 1)]),
    ],
)  # fmt: skip
def test_a_value_stays_over_blocks_and_empty_ones(
    parts: list[list[int]], found: list[tuple[int, int, int]]
) -> None:
    begins = np.cumsum([0, *(len(part) for part in parts)]).tolist()
    blocks = [
        (np.array(part, dtype=int), begin) for part, begin in zip(parts, begins, strict=False)
    ]
    assert unbroken(blocks) == [Unbroken(*each) for each in found]
