"""Which rows of a large plan have their machine built before the first run."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of

from axisrig.bench.campaign.preparing import WHOLE_MAX, built_first
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.plan.plan import read_plan

PLAN = Path(__file__).parents[2] / "testplans" / "distance_3d.csv"


@pytest.mark.long
def test_of_a_large_plan_with_metrics_of_its_own_the_first_row_of_each_kind() -> None:
    cases = read_plan(PLAN).cases
    assert len(cases) > WHOLE_MAX
    assert any(case.module is not None for case in cases)
    first = built_first(cases)
    assert first[0] == 0
    assert 1 < len(first) <= WHOLE_MAX


def row(run: str, **changes: Any) -> Case:
    """A row that differs from others in its values only, or as `changes` say."""
    inputs = {"plc:V.E.FEED": run, "set:Z.edge": "POS"}
    checks = (parse_check("lag_mm_max:Z", f"<= {len(run)}", ""),)
    return case_of(run, inputs=changes.pop("inputs", inputs), checks=checks, **changes)


def search(column: str) -> Any:
    return SimpleNamespace(column=column)


def module(name: str, path: str) -> Any:
    return SimpleNamespace(name=name, path=Path(path))


OTHERS: tuple[dict[str, Any], ...] = (
    {"rig": Path("other.toml")},
    {"program": Path("other.nc")},
    {"inputs": {"plc:V.E.FEED": "1"}},
    {"inputs": {"plc:V.E.FEED": "1", "set:Z.edge": "POS", "seed": "1"}},
    {"sampled": (parse_check("latch_mm:Z", "> 1", ""),)},
    {"search": search("plc:V.E.FEED")},
    {"search": search("plc:V.E.WAY")},
    {"module": module("own", "own.py")},
    {"module": module("own", "sub/own.py")},
)


def test_of_more_rows_those_are_built_that_differ_in_more_than_values() -> None:
    """Rig, program, names of inputs, metrics, what is searched, metrics of its own."""
    plain = [row(str(number)) for number in range(WHOLE_MAX)]
    assert built_first(plain) == list(range(WHOLE_MAX))
    assert built_first([*plain, row("one more")]) == [0]
    others = [row(f"odd {number}", **changes) for number, changes in enumerate(OTHERS)]
    again = [row(f"again {number}", **changes) for number, changes in enumerate(OTHERS)]
    found = built_first([*plain, *others, *again, row("last")])
    assert found == [0, *range(WHOLE_MAX, WHOLE_MAX + len(OTHERS))]
    assert built_first([*others, *plain, *again]) == list(range(len(OTHERS) + 1))


@pytest.mark.parametrize("kinds", [WHOLE_MAX, WHOLE_MAX + 1, 3 * WHOLE_MAX])
def test_of_many_kinds_the_first_hundred_are_built(kinds: int) -> None:
    cases = [row(str(number), rig=Path(f"{number}.toml")) for number in range(kinds)]
    assert built_first(cases) == list(range(WHOLE_MAX))
