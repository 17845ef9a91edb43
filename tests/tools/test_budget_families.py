"""Budgets of values that drives of other families have latched: shares add up to the error.

Increments of these drives have no key of their own: what the rounding adds is the value less the
true position at the latch, with all other causes off.
"""

from functools import partial
from pathlib import Path

import pytest

from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_cases
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.tools.budget.budget import Budget, make_budget

PLANS = Path(__file__).parents[2] / "testplans"
SURFACE_MM = "99.9991"
SET = ("plant:probe.pretravel_um=9", "drive:servo.input_delay_us=300")
# The row of 3000 mm/min of each family -> increment of a latched value, um
FAMILIES = {
    "cyclic_study-conventional-pos-1ms-3000": 1e4 / 4096,
    "cyclic_study-conventional-neg-2ms-3000": 1e4 / 4096,
    "cyclic_study-terminal-pos-1ms-3000": 1e4 / 4096,
    "cyclic_study-lightbus-pos-1ms-3000": 1.0,
    "cyclic_study-lightbus-neg-4ms-3000": 1.0,
    "cyclic_study-profidrive-pos-1ms-3000": 1e4 / 2**22,
    "cyclic_study-profidrive-neg-2ms-3000": 1e4 / 2**22,
    "sercos_study-pos-1ms-3000": 1e4 / 2**20,
}


def budget_of(run: str) -> Budget:
    texts = (*SET, f"plant:probe.surface_mm={SURFACE_MM}", "plc:V.E.TOUCHES=1")
    given = [parse_assignment(text) for text in texts]
    plan = read_plan(PLANS / f"{run.split('-', maxsplit=1)[0]}.csv").with_inputs(given)
    case = only(plan.cases, run.partition("-")[2])
    return make_budget(case, None, partial(run_cases, files_of=lambda _: RunFiles()))


@pytest.mark.long
@pytest.mark.parametrize("run", FAMILIES)
def test_the_shares_add_up_to_the_error_and_have_their_closed_forms(run: str) -> None:
    """Pre-travel -9 um, input -v 300 us; rounding within an increment, nothing left beside it.

    At 4 ms the speed may still change by a share of a thousandth: then there is a line *run-up*.
    """
    found = budget_of(run)
    shares = {share.cause.cause: share for share in found.shares}
    assert found.increment_um == pytest.approx(FAMILIES[run])
    total_um = sum(share.in_turn_um for share in found.shares) + found.left_um
    assert total_um == pytest.approx(found.error_um, abs=1e-9)
    assert shares.keys() - {"run-up"} == {"pre-travel", "input", "braking", "encoder"}
    twice_um = 2 * found.increment_um
    assert shares["pre-travel"].in_turn_um == pytest.approx(-9.0, abs=twice_um)
    assert shares["input"].in_turn_um == pytest.approx(-15.0, rel=0.01, abs=twice_um)
    assert shares["braking"].in_turn_um == 0.0
    assert abs(shares["encoder"].in_turn_um) <= found.increment_um
    assert abs(found.left_um) <= 1e-3
    assert found.differing == ()
    assert found.error_um == pytest.approx(-24.0, abs=0.15 + twice_um)
    assert found.largest is shares["input"]


@pytest.mark.long
@pytest.mark.parametrize(("surface_mm", "rounded_um"), [("100.0004", -0.4), ("99.9996", 0.4)])
def test_the_rounding_of_a_value_is_that_of_its_place(surface_mm: str, rounded_um: float) -> None:
    """LATCH32 has whole um: without any delay 100.0004 mm are 100.000, 99.9996 mm as well."""
    texts = ("drive:servo.input_delay_us=0", f"plant:probe.surface_mm={surface_mm}")
    given = [parse_assignment(text) for text in (*texts, "plc:V.E.TOUCHES=1")]
    plan = read_plan(PLANS / "cyclic_study.csv").with_inputs(given)
    case = only(plan.cases, "lightbus-pos-1ms-3000")
    found = make_budget(case, None, partial(run_cases, files_of=lambda _: RunFiles()))
    assert found.shares[-1].cause.cause == "encoder"
    assert found.shares[-1].in_turn_um == pytest.approx(rounded_um, abs=0.01)
