"""Rows of distance_control.csv on EtherCAT rigs: equal to CAN's but for the dead cycles.

With phases that have as many of them as CAN, rows pass as they are written; with those of a rig
that says nothing, each has what the same formulas and the same walk give for one cycle more.
"""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.plans.distance_bands import restated
from tests.plans.distance_law import Setup, rows
from tests.plans.rigs_on_ethercat import on_ethercat

from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_cases
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import parse_condition
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.plan.verdict import Verdict

PLANS = Path(__file__).parents[2] / "testplans"
AS_ON_CAN = {"bus:ec1.frame_us": "100", "bus:ec1.shift_us": "113", "bus:ec1.sample_us": "-10"}
ROWS = rows()
TABLES = sorted(path.name for path in (PLANS / "distance").glob("*.csv"))
LATER = 1
"""Cycles that a line adds whose frame leaves at 0 and whose SYNC0 comes behind it."""


def verdicts(cases: list[Case]) -> dict[str, Verdict]:
    results = run_cases(cases, files_of=lambda _: RunFiles())
    return {result.case.case: result.verdict for result in results}


@pytest.mark.long
def test_rows_pass_as_they_are_written() -> None:
    """Dead cycles, an older sensor value, and limits of kp below and above."""
    plan = read_plan(PLANS / "distance_control.csv")
    names = ("dead-optimized", "dead-age-2", "p-1-below", "p-3-above")
    rig = PLANS / "rigs" / "distance-z-ethercat.toml"
    cases = [only(plan.cases, name) for name in names]
    moved = [replace(case, rig=rig, inputs=case.inputs | AS_ON_CAN) for case in cases]
    assert verdicts(moved) == dict.fromkeys(names, Verdict.PASS)


@pytest.mark.long
@pytest.mark.parametrize("sercos", [False, True], ids=["canopen", "sercos"])
@pytest.mark.parametrize("table", TABLES)
def test_rows_have_what_one_dead_cycle_more_gives(
    tmp_path: Path, table: str, *, sercos: bool
) -> None:
    """Two rows are refused on EtherCAT: 60E4 with each second SYNC. S-0-0053 gives the same."""
    plan = read_plan(PLANS / "distance_control.csv")
    moved = []
    for case in plan.cases:
        if case.file.name == table and "every-second" not in case.rig.name:
            rig = on_ethercat(f"rigs/{case.rig.name}", tmp_path, sercos=sercos)
            moved.append(_with_one_more(replace(case, rig=rig)))
    found = verdicts(moved)
    # The PLC side writes an object of the drive there, which one of SERCOS does not have
    refused = {case.case for case in moved if sercos and "plc:Z.lag_window" in case.inputs}
    passed = set(found) - refused
    assert found == dict.fromkeys(passed, Verdict.PASS) | dict.fromkeys(refused, Verdict.ERROR)
    assert len(found) == len(moved) > 0


def _with_one_more(case: Case) -> Case:
    """Return a case with what its dead cycles change."""
    stated = restated(Setup(ROWS[case.case], LATER))
    inputs = {name: text for name, text in stated.items() if not name.startswith("check:")}
    checks = []
    for check in case.checks:
        text = stated.get(f"check:{check.metric}")
        condition = check.condition if text is None else parse_condition(text, check.metric)
        checks.append(replace(check, condition=condition))
    return replace(case, inputs=dict(case.inputs) | inputs, checks=tuple(checks))
