"""The loop that a recording has: its dead cycles, what was sent, its derivative, its tool.

Recordings made of formulas (`controls.py`, `reports/tilted.py`): 1 ms, kp 0.2, no filter.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import ON, WITH_SET_POS, recorded, seen
from tests.judge.test_channel_control_of_a_trace import stepped
from tests.judge.test_channel_control_of_a_trace import truth as tool_truth
from tests.recordings import kept
from tests.reports import tilted

from axisrig.bench.judge.distance.tool import choices, distance_truth, distance_truths
from axisrig.bench.judge.distance.truth import (
    ACTIVE,
    ERROR,
    FREEZE,
    INACTIVE,
    TURNING_OFF,
    DistanceTruth,
)
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.distance import Controller, DistanceChange, PlcSensor
from axisrig.kernel.time.clock import MS

CONTROLLER = Controller(0.2, 0.0, 0.0, "DEFAULT", 1, 0.7, 4, 25.0, 0.1, False)


def by_variable(delay: int, late: int, optimized: int) -> DistanceTruth:
    """The sensor is a variable of the PLC; 6064 comes so many cycles later."""
    change = DistanceChange(ON * MS, "ACTIVE_CONST_DIST", "NC", "VARIABLE V.E.GAP", False,
                            CONTROLLER)  # fmt: skip
    made = recorded(changes=(change,), late_cycles=late, words={"optimized_scheduling": optimized})
    sensors = {"V.E.GAP": PlcSensor("gap", -1, delay)}
    found = distance_truth(Observed(replace(made.facts, plc_sensors=sensors), made.series), "Z")
    assert found is not None
    return found


@pytest.mark.parametrize("optimized", [0, 1])
@pytest.mark.parametrize(("delay", "late"), [(0, 0), (3, 0), (0, 2), (3, 2), (1, 2)])
def test_dead_cycles_are_those_of_the_way_and_of_the_age_of_the_value(
    delay: int, late: int, optimized: int
) -> None:
    """Reaction 1, 0 with optimized scheduling; two cycles of the way; the age of the variable.

    A variable is of the last SYNC: what the carrier adds to the way, it takes off again.
    """
    truth = by_variable(delay, late, optimized)
    reaction = 1 - optimized
    assert truth.sensor_age_cycles == delay - late
    assert truth.dead.reaction == reaction
    assert truth.dead.dead == reaction + 2 + delay - 1
    loop = truth.loop("CONST_DIST", truth.listed)
    assert loop.dead_cycles + loop.skew_cycles == truth.dead.dead
    assert (loop.skew_cycles, loop.sent_cycles) == (delay - late, reaction)


@pytest.mark.parametrize(("optimized", "limit"), [(0, 1.0), (1, 2.0)])
def test_with_both_encoders_what_was_sent_limits_the_gain(optimized: int, limit: float) -> None:
    """2 sin(pi/(2 (2 m + 1))), m the cycles by which Z_com is older than the offset: 1 or 0."""
    words = {"mode_dist_use_both_encoder": 1, "optimized_scheduling": optimized}
    assert seen(recorded(words=words), "distance_kp_limit").value == pytest.approx(limit, rel=1e-6)


@pytest.mark.parametrize("tv_ms", [0.5, 2.0])
@pytest.mark.parametrize(("derivative", "cycles"), [("per_second", 1.0), ("per_cycle", 1e-3)])
def test_the_derivative_of_a_surface_is_in_the_loop_with_the_error_alone(
    tv_ms: float, derivative: str, cycles: float
) -> None:
    """SET_POS without skew: 1 - kp is left, whatever r, of the feedback.

    Of the error z^2 + (kp (1 + r) - 1) z - kp r = 0, r = Tv/T, or Tv in s.
    """
    kp, r = 0.2, tv_ms * cycles
    root = math.sqrt((kp * (1 + r) - 1) ** 2 + 4 * kp * r)
    of_error = max(abs(1 - kp * (1 + r) + root), abs(1 - kp * (1 + r) - root)) / 2
    for derivative_of, left in (("feedback", 1 - kp), ("error", of_error)):
        rig = replace(CONTROLLER, derivative_of=derivative_of, derivative=derivative)
        change = DistanceChange(ON * MS, "ACTIVE", "NC", "60E4", False, rig)
        observed = recorded(state=ACTIVE, orders=(WITH_SET_POS,), changes=(change,),
                            words={"d_tv": tv_ms * 1e-3})  # fmt: skip
        found = seen(observed, "distance_growth_expected")
        assert found.value == pytest.approx(left, abs=1e-9), derivative_of


# The tool


@pytest.mark.parametrize(
    ("begin_us", "end_us", "rows"),
    [
        (50_000, 100_000, (50, 100)),
        (50_001, 100_001, (51, 101)),
        (49_999, 99_999, (50, 100)),
        (50_500, None, (51, tilted.ROWS)),
        (50_100, 50_200, None),  # no SYNC is in it
    ],
)
def test_a_kinematic_has_the_rows_from_its_begin_to_before_its_end(
    begin_us: int, end_us: int | None, rows: tuple[int, int] | None
) -> None:
    facts = tilted.left()
    (on,) = facts.kinematics
    end_ns = None if end_us is None else end_us * 1000
    facts = replace(facts, kinematics=(replace(on, begin_ns=begin_us * 1000, end_ns=end_ns),))
    found = choices(Observed(facts, kept(tilted.trace())))
    assert [(one.begin, one.end) for one in found] == ([] if rows is None else [rows])


def test_a_distance_of_an_inclined_tool_is_that_of_where_the_axes_are() -> None:
    """cos of the tilt, two cycles after it was sent; the tool has its length up to 50 degrees."""
    truth: Any = tool_truth()
    rows = np.array([60, 150, 251, 252, 400])
    turned = np.clip((rows - 2 - tilted.KINEMATIC) / 200.0, 0.0, 1.0) * tilted.A_DEG
    assert truth.share[rows] == pytest.approx(np.cos(np.radians(turned)))
    assert truth.shorter_mm[rows] == pytest.approx(60.0 * (1.0 - np.cos(np.radians(turned))))


@pytest.mark.parametrize("before_mm", [0.0, 0.5, -0.25])
@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
def test_an_answer_is_counted_from_where_the_axes_were_before_the_step(
    axis: str, before_mm: float
) -> None:
    """An offset that was there long before the sensor value steps is none of it."""
    at, name = np.arange(tilted.ROWS), f"{axis}.superposed_mm"
    early = np.where(at >= tilted.ON + 20, before_mm, 0.0)
    shifted = tilted.trace()[name].to_numpy() + early
    found = tool_truth({**stepped(tilted.STEP - 1, tilted.STEP + 2), name: shifted})
    cycles = found.measured_dead().cycles
    assert (cycles.reaction, cycles.way) == (1, 2)


@pytest.mark.parametrize("state", [FREEZE, TURNING_OFF, ACTIVE, ERROR])
def test_a_control_that_was_not_off_all_the_time_is_shown(state: int) -> None:
    assert [truth.axis for truth in distance_truths(recorded(state=state))] == ["Z"]
    assert distance_truths(recorded(state=INACTIVE)) == []
