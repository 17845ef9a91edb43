"""Errors at the end of a stretch, dry runs, sines of too few periods, poses of the cycle before."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import ON, ROWS, WITH_CONST_DIST, K, recorded
from tests.judge.test_findings_of_a_control import found
from tests.judge.test_tool_truth import LIMITS, limited
from tests.reports import tilted
from tests.reports.tilted import KINEMATIC, TILTED, direction, left

from axisrig.bench.judge.distance.control_stretches import active, compared, sine_parts
from axisrig.bench.judge.distance.tool import ToolTruth, distance_truth
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.distance import DistanceOrder
from axisrig.bench.record.kinematics import GuideChange
from axisrig.kernel.time.clock import MS


@pytest.mark.parametrize("late_mm", [-0.1, 0.25])
def test_the_error_at_the_end_of_a_stretch_is_that_of_its_last_fifth(late_mm: float) -> None:
    """Rows 100 to 999: the last 180 are judged. Before them it was 0.3 mm."""
    (error,) = found(np.where(K < ROWS - (ROWS - ON) // 5, 0.3, late_mm)).errors
    assert (error.measured_mm, error.spread_mm) == pytest.approx((late_mm, 0.0))
    # Half of it, to a row of 180
    (mixed,) = found(np.where(K < ROWS - (ROWS - ON) // 10, 0.3, late_mm)).errors
    assert mixed.measured_mm == pytest.approx((0.3 + late_mm) / 2.0, abs=0.4 / 180)


@pytest.mark.parametrize("is_dry", [True, False])
def test_a_dry_run_is_compared_and_puts_nothing_out(is_dry: bool) -> None:
    again = DistanceOrder(499 * MS, "NC", "ON_CONST_DIST", is_dry_run=is_dry)
    off = DistanceOrder(399 * MS, "NC", "OFF")
    state = np.where((K < ON) | ((K >= 400) & (K < 500)), 0, 4).astype(float)
    truth = distance_truth(
        recorded(orders=(WITH_CONST_DIST, off, again), columns={"distance_state": state}), "Z"
    )
    assert truth is not None
    spans = [(one.begin, one.end, one.is_dry_run) for one in compared(truth)]
    assert spans == [(ON, 400, False), (500, ROWS, is_dry)]
    assert [(one.begin, one.end) for one in active(truth)] == [
        (begin, end) for begin, end, dry in spans if not dry
    ]


@pytest.mark.parametrize(("crossings", "is_known"), [(2, False), (3, True)])
def test_a_sine_is_known_from_two_whole_periods_on(crossings: int, is_known: bool) -> None:
    """20 rows each; one begins below its mean and ends so."""
    rows = np.arange(20 * crossings)
    values = np.sin(2 * np.pi * (rows - 5.5) / 20.0)
    if is_known:
        frequency, mean, amplitude = sine_parts(values, 1e-3)
        assert frequency == pytest.approx(50.0)
        assert mean == pytest.approx(0.0, abs=1e-9)
        assert abs(amplitude) == pytest.approx(1.0)
    else:
        with pytest.raises(NoClosedFormError, match="fewer than two periods"):
            sine_parts(values, 1e-3)


def test_the_axes_leave_an_offset_what_the_pose_of_the_cycle_before_allows() -> None:
    """In the last three cycles of a tilt each allows 0.6 % less than the one before.

    The first cycle of a run has its own pose.
    """
    kinematic = replace(left().kinematics[0], begin_ns=0)
    tool = limited("ECS", [GuideChange(0, "ECS")])
    facts = replace(tool.observed.facts, kinematics=(kinematic,))
    tool = ToolTruth(CHANNEL, Observed(facts, tool.observed.series))

    def speeds(rows: Any) -> Any:
        share = np.clip((rows - KINEMATIC) / (TILTED - KINEMATIC), 0, 1)
        u = direction(share * tilted.C_DEG, share * tilted.A_DEG)
        with np.errstate(divide="ignore"):
            of_axes = np.array([LIMITS[axis][0] for axis in "XYZ"]) / np.abs(u / u[:, 2:])
        return np.min(of_axes, axis=1)

    begin = TILTED - 3
    allowed = tool.axes_allow(begin, begin + 3)
    assert allowed is not None
    assert allowed[:, 0] == pytest.approx(speeds(np.arange(begin - 1, begin + 2)), rel=1e-3)
    first = tool.axes_allow(0, 2)
    assert first is not None
    assert first == pytest.approx(np.tile(LIMITS["Z"], (2, 1)), rel=1e-4)
