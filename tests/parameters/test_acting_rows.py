"""Parameters that act: a shipped row differs when one leaves the value that it has there.

The table is `acting_rows.csv`: plan and run, the column and the value that it gets. `with`: what
the row gets before, where the parameter rests on another one that no shipped row has. `differs`:
frames on the bus, messages of the program, alarms; or the rig is refused with the column named.
`reason`: why no shipped row can differ; blank beside a blank run: none has been found yet, other
tests of such a parameter are not meant by that.
"""

import csv
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

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


class Left(NamedTuple):
    """What a run leaves that a parameter may change. refusal: why there is no run."""

    frames: str
    messages: tuple[str, ...]
    alarms: tuple[int, ...]
    refusal: str


def left_by(plan: str, run: str, *columns: str) -> Left:
    case = cases(plan)[run]
    added = dict(column.split("=", 1) for column in columns if column)
    result = run_case(replace(case, inputs={**case.inputs, **added}), RunFiles())
    messages = [message.shown for message in result.facts.messages] if result.facts else []
    return Left(result.frame_log_sha256, tuple(messages), tuple(result.alarms), result.error or "")


@cache
def left_as_shipped(plan: str, run: str, before: str) -> Left:
    left = left_by(plan, run, before)
    assert not left.refusal
    assert left.frames
    return left


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


def test_each_parameter_has_a_row_or_a_reason_or_neither() -> None:
    for row in ROWS:
        assert bool(row["run"]) == bool(row["differs"])
        assert not (row["run"] and row["reason"])
    assert len(SHOWN) >= 198  # rows that are found are not lost again


@pytest.mark.long
@pytest.mark.parametrize("row", SHOWN, ids=lambda row: f"{row['kind']} {row['path']}")
def test_a_shipped_row_differs_with_another_value(row: dict[str, str]) -> None:
    plan, run, column, before = row["plan"], row["run"], row["column"], row["with"]
    assert cases(plan)[run].inputs.get(column) != row["value"]
    shipped = left_as_shipped(plan, run, before)
    changed = left_by(plan, run, before, f"{column}={row['value']}")
    if row["differs"] == "refused":
        assert column in changed.refusal
        return
    assert not changed.refusal
    assert getattr(changed, row["differs"]) != getattr(shipped, row["differs"])
