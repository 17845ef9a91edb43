"""The rows of `axisrig demo`: few enough to be waited for, and something of everything."""

from pathlib import Path
from typing import Any

import pytest
from tests.stages import STUDY

from axisrig.bench.cli import main
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import matches

TESTPLANS = Path(__file__).parents[2] / "testplans"
PLANS = {plan.name: plan for plan in map(read_plan, sorted(TESTPLANS.glob("*.csv")))}
ROWS = {
    name: [case for case in plan.cases if main.DEMO in case.tags] for name, plan in PLANS.items()
}


def metrics(cases: list[Case]) -> set[str]:
    """Their names without axis and block."""
    return {check.metric.partition(":")[0] for case in cases for check in case.checks}


STUDIES = {name for name, plan in PLANS.items() if all(STUDY in c.tags for c in plan.cases)}


def test_at_least_one_row_of_every_plan_but_the_studies_is_in_the_demo() -> None:
    assert {name for name, rows in ROWS.items() if not rows} == STUDIES
    assert all(STUDY not in case.tags for rows in ROWS.values() for case in rows)
    assert 2 * (len(PLANS) - len(STUDIES)) < sum(map(len, ROWS.values())) < 100


def test_every_metric_that_a_shipped_row_checks_is_in_the_demo() -> None:
    shown = [case for rows in ROWS.values() for case in rows]
    others = [plan for name, plan in PLANS.items() if name not in STUDIES]
    assert metrics(shown) == metrics([case for plan in others for case in plan.cases])


def test_the_selection_takes_the_tagged_rows_and_no_other() -> None:
    """A word of `-k` fits parts of names and titles too."""
    for name, plan in PLANS.items():
        assert [case for case in plan.cases if matches(main.DEMO, case)] == ROWS[name]


@pytest.mark.parametrize(("words", "selected"), [((), main.DEMO), (("--all",), None)])
def test_the_command_runs_the_tagged_rows_of_every_plan_or_all(
    monkeypatch: pytest.MonkeyPatch, words: tuple[str, ...], selected: str | None
) -> None:
    calls: list[tuple[Any, ...]] = []
    monkeypatch.setattr(main, "build_library", lambda: calls.append(()))
    monkeypatch.setattr(main, "run", lambda *args, **_: calls.append(args))
    with pytest.raises(SystemExit) as end:
        main.main(["demo", "--plans", str(TESTPLANS), "-j", "2", *words])
    assert end.value.code == 0
    built, (_, plans, _, select, jobs, _) = calls
    assert built == ()
    assert [Path(plan).stem for plan in plans] == list(PLANS)
    assert (select, jobs) == (selected, 2)
