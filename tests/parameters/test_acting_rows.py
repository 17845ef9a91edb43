"""Parameters that act: a shipped row has other frames when one leaves the value that it has there.

The table is `acting_rows.csv`: plan and run, the column and the value that it gets. Where the run
is blank no shipped row has been found yet; other tests of such a parameter are not meant by that.
"""

import csv
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from axisrig.bench.campaign.runner import RunFiles, run_case
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.kernel.parameters.table import table

FILE = Path(__file__).with_name("acting_rows.csv")
ROWS = list(csv.DictReader(FILE.read_text(encoding="utf-8").splitlines()))
SHOWN = [row for row in ROWS if row["run"]]
PLANS = Path(__file__).parents[2] / "testplans"


@cache
def cases(plan: str) -> dict[str, Case]:
    return {case.run: case for case in read_plan(PLANS / f"{plan}.csv").cases}


@cache
def frames_as_shipped(plan: str, run: str) -> str:
    return frames(cases(plan)[run])


def frames(case: Case) -> str:
    result = run_case(case, RunFiles())
    assert result.error is None
    assert result.frame_log_sha256
    return result.frame_log_sha256


def test_the_table_has_every_parameter_that_acts_and_no_other() -> None:
    acting = [
        (kind, row.path)
        for kind in ("axis", "channel")
        for row in table(kind).parameters  # type: ignore[arg-type]
        if row.acts != "no"
    ]
    assert [(row["kind"], row["path"]) for row in ROWS] == acting
    for row in SHOWN:
        path = row["column"].removeprefix("set:").partition(".")[2]
        found = table(row["kind"]).find(path)[0]  # type: ignore[arg-type]
        assert found.path == row["path"]


@pytest.mark.long(but=1)
@pytest.mark.parametrize("row", SHOWN, ids=lambda row: f"{row['kind']} {row['path']}")
def test_a_shipped_row_differs_with_another_value(row: dict[str, str]) -> None:
    case = cases(row["plan"])[row["run"]]
    assert case.inputs.get(row["column"]) != row["value"]
    changed = replace(case, inputs={**case.inputs, row["column"]: row["value"]})
    assert frames(changed) != frames_as_shipped(row["plan"], row["run"])
