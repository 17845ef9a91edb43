"""What the bench tells of runs to a fixed stop with several axes: rows of the gantry's plan."""

from pathlib import Path

import numpy as np
import pytest
from tests.machine.fixed_stop.conftest import blocks

from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.judge.fixed_stop.stop_findings import StopFindings
from axisrig.bench.judge.fixed_stop.values import Value
from axisrig.bench.plan.plan import read_plan

PLAN = Path(__file__).parents[3] / "testplans/fixed_stop_gantry.csv"
LIMIT_N = 0.1 * 2 * np.pi * 9.0 / 0.010  # 10 % of 9 N.m on a screw of 10 mm
PLACE_MM = 130.0 + LIMIT_N / 20e6 * 1e3


def found(name: str) -> list[StopFindings]:
    """What the bench tells of each run of a row."""
    (case,) = (case for case in read_plan(PLAN).cases if case.case == name)
    return blocks(run_case(case, RunFiles()))


def values(run: StopFindings, key: str) -> list[Value]:
    return [value for value in run.values if value.key == key]


@pytest.mark.long
def test_each_of_two_independent_axes_has_its_own_contact_and_values_only() -> None:
    """Y meets its stop while X is still led back: that is nothing of the run of X."""
    first, second = found("independent")
    for run, axis in ((first, "X"), (second, "Y")):
        contacts = [mark.axis for mark in run.marks if mark.key == "contact"]
        assert contacts == [axis]
        assert {value.axis for value in run.values} == {axis}
    (contact,) = (mark for mark in second.marks if mark.key == "contact")
    assert first.begin_ns < contact.measured_ns < first.end_ns


def test_a_value_latched_at_rest_without_friction_is_within_a_micrometre() -> None:
    (run,) = found("in-line")
    (latched,) = values(run, "latched")
    assert latched.low == pytest.approx(PLACE_MM - 0.001, abs=1e-6)
    assert latched.high == pytest.approx(PLACE_MM + 0.001, abs=1e-6)
    assert latched.low < latched.measured < latched.high
    ends = values(run, "stop_force_end")
    assert {value.axis for value in ends} == {"X", "X2"}  # the slave takes part
    assert all(value.high == pytest.approx(LIMIT_N) for value in ends)


@pytest.mark.long
def test_the_force_at_the_end_has_no_bound_while_the_axis_rings() -> None:
    """The drive faults 18 ms behind the contact; the bound F_lim - F_g + F_c is that of rest."""
    (run,) = found("slave-window-left-on")
    ends = values(run, "stop_force_end")
    assert max(value.measured for value in ends) > LIMIT_N
    for value in ends:
        assert (value.low, value.high) == (None, None)
        assert "not at rest at the end" in value.note


@pytest.mark.long
def test_the_bound_at_the_end_leaves_room_for_what_still_rings() -> None:
    """Pressed without a relaxing motion; v sqrt(k m) of a speed below 0.1 mm/s are 6 N at most."""
    plan = read_plan(PLAN.with_name("fixed_stop_timing.csv"))
    (case,) = (case for case in plan.cases if case.case == "target-behind-stop")
    (run,) = blocks(run_case(case, RunFiles()))
    (end,) = values(run, "stop_force_end")
    (limit_n,) = (abs(limits.force_limit_n) for limits in run.limits.values())
    assert end.low <= end.measured <= end.high
    assert 0.0 < end.high - limit_n < 6.3
