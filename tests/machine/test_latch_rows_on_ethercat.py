"""Rows of latch_accuracy.csv and the drive profiles on EtherCAT rigs: the latch is that of CAN.

The reaction is a cycle later, and the way on is v T longer: the frame with the latch leaves in the
next cycle, where on CAN it is in that of the SYNC.
"""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.plans.fixed_stop_law import axis
from tests.plans.fixed_stop_setup import rows
from tests.plans.rigs_on_ethercat import on_ethercat

from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_cases
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import Check, parse_condition
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict

PLANS = Path(__file__).parents[2] / "testplans"
T_MS = 1.0
ROWS = rows()
SYNC_MS, SYNC0_MS = 0.048, 0.1
"""SYNC on CAN with its frame; `shift_us`, its default."""


def later(check: Check, speed_mm_s: float) -> Check:
    """Return a check for values that are one cycle later; the others are as they are."""
    way = speed_mm_s * T_MS * 1e-3
    by = {
        "reaction_ms": T_MS - (SYNC0_MS - SYNC_MS),
        "overtravel_mm": way,
        "standstill_mm": -way,
    }.get(check.metric)
    if by is None or check.condition.lower is None or check.condition.upper is None:
        return check
    low, high = check.condition.lower + by, check.condition.upper + by
    return replace(check, condition=parse_condition(f"{low:.6f} .. {high:.6f}", check.metric))


def moved(case: Case, folder: Path) -> Case:
    """Return a case with its rig on EtherCAT."""
    speed = float(case.inputs.get("plc:V.E.FEED", "0")) / 60
    checks = tuple(later(check, speed) for check in case.checks)
    return replace(case, rig=on_ethercat(f"rigs/{case.rig.name}", folder), checks=checks)


@pytest.mark.long
@pytest.mark.parametrize(
    ("plan", "refused"),
    [("latch_accuracy", {"latch-pdo-lost"}), ("drive_profiles", set())],
)
def test_rows_have_the_latch_of_can_and_a_reaction_one_cycle_later(
    tmp_path: Path, plan: str, refused: set[str]
) -> None:
    """refused: a telegram of CAN that gets lost. `ethercat.csv` has the frame in its place."""
    cases = [case for case in read_plan(PLANS / f"{plan}.csv").cases if case.case not in refused]
    results = run_cases([moved(case, tmp_path) for case in cases], files_of=lambda _: RunFiles())
    found = {result.case.case: result.verdict for result in results}
    assert found == dict.fromkeys(found, Verdict.PASS)
    assert len(found) == len(cases) > 0


@pytest.mark.long
def test_a_drive_that_stores_the_position_of_before_the_edge(tmp_path: Path) -> None:
    """akd-like: as early as on CAN, by 133.3 us."""
    published = read_plan(PLANS / "published.csv").cases
    cases = [moved(case, tmp_path) for case in published if case.case in ("akd-50", "akd-1000")]
    results = run_cases(cases, files_of=lambda _: RunFiles())
    assert [result.verdict for result in results] == [Verdict.PASS] * 2


STOPS = (
    "feed-600",
    "window-600",
    "arm-00776",
    "lag-above-running",
    "ringing-long",
    "xy-first-axis",
)


@pytest.mark.long
def test_a_stop_is_found_in_the_cycle_in_which_what_was_read_meets_the_criteria(
    tmp_path: Path,
) -> None:
    """The positions of a line come a cycle later: the walk along the plant reads them so."""
    cases = []
    for case in read_plan(PLANS / "fixed_stop_timing.csv").cases:
        if case.case in STOPS:
            checks = [c for c in case.checks if c.metric == "detection_followed_error_ms"]
            cases.append(replace(moved(case, tmp_path), checks=tuple(checks)))
    results = run_cases(cases, files_of=lambda _: RunFiles())
    found = {result.case.case: result.verdict for result in results}
    assert found == dict.fromkeys(STOPS, Verdict.PASS)


CREEPING = ("feed-forward-1", "restored-feed-forward", "restored-soft")


@pytest.mark.long
def test_what_creeping_leaves_has_decayed_for_a_cycle_more(tmp_path: Path) -> None:
    """The window is seen a cycle later, and so is the end of the run: exp(-T/tau) of the lag."""
    cases = []
    for case in read_plan(PLANS / "fixed_stop_timing.csv").cases:
        if case.case in CREEPING:
            low, high = axis(ROWS[case.case]).left_lag(later=1)
            assert high < axis(ROWS[case.case]).left_lag()[1]
            condition = parse_condition(f"{low:.6f} .. {high:.6f}", "relax_lag_mm")
            checks = [
                replace(check, condition=condition)
                for check in case.checks
                if check.metric == "relax_lag_mm"
            ]
            cases.append(replace(moved(case, tmp_path), checks=tuple(checks)))
    results = run_cases(cases, files_of=lambda _: RunFiles())
    found = {result.case.case: result.verdict for result in results}
    assert found == dict.fromkeys(CREEPING, Verdict.PASS)
