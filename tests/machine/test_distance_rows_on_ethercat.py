"""Rows of distance_control.csv on an EtherCAT rig whose phases have as many dead cycles as CAN."""

from dataclasses import replace
from pathlib import Path

import pytest

from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_cases
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.plan.verdict import Verdict

PLANS = Path(__file__).parents[2] / "testplans"
AS_ON_CAN = {"bus:ec1.frame_us": "100", "bus:ec1.shift_us": "113", "bus:ec1.sample_us": "-10"}


@pytest.mark.long
def test_rows_pass_as_they_are_written() -> None:
    """Dead cycles, an older sensor value, and limits of kp below and above."""
    plan = read_plan(PLANS / "distance_control.csv")
    names = ("dead-optimized", "dead-age-2", "p-1-below", "p-3-above")
    rig = PLANS / "rigs" / "distance-z-ethercat.toml"
    cases = [only(plan.cases, name) for name in names]
    moved = [replace(case, rig=rig, inputs=case.inputs | AS_ON_CAN) for case in cases]
    results = list(run_cases(moved, files_of=lambda _: RunFiles()))
    found = {result.case.run: result.verdict for result in results}
    assert found == dict.fromkeys(found, Verdict.PASS)
    assert len(found) == len(names)
