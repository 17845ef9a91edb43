"""Plans with inputs of the command line, with changed rows, and what is looked at on reading."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import Plan, read_plan, selected
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]

HEAD = "case,program,rig,repeats,plc:V.E.A,set:Z.b,check:mean(lag_mm_max)"
ROW = "probe.nc,machine.toml"


@pytest.fixture
def plan(write_plan: PlanWriter) -> Plan:
    lines = [HEAD, f"a,{ROW},2,5,6,<= 1", f"b,{ROW},,[7 | 8],6,<= 1", f"c,{ROW},,9,,"]
    return read_plan(write_plan("\n".join([*lines, ""])))


def values(plan: Plan, column: str) -> dict[str, str | None]:
    return {case.run.removeprefix("probing-"): case.inputs.get(column) for case in plan.rows}


def given(plan: Plan, *assignments: str, select: str | None = None) -> Plan:
    return plan.with_inputs([parse_assignment(text) for text in assignments], select)


def test_rows_of_statistics_come_after_the_last_of_their_runs(plan: Plan) -> None:
    assert [row.run.removeprefix("probing-") for row in plan.rows] == [
        *("a-001", "a-002", "a", "b-7", "b-8", "b", "c"),
    ]


def test_a_change_is_one_of_every_row(plan: Plan) -> None:
    changed = plan.with_cases(lambda case: replace(case, title=f"of {case.run}"))
    assert [row.title for row in changed.rows] == [f"of {row.run}" for row in plan.rows]
    assert all(row.title == "" for row in plan.rows)
    assert (changed.columns, changed.path) == (plan.columns, plan.path)


def test_an_input_of_a_call_wins_over_the_cells_of_every_row(plan: Plan) -> None:
    """Rows of statistics have it too; a column that the plan lacks comes last."""
    found = given(plan, "set:Z.b=1", "plant:z.x_mm=2")
    assert set(values(found, "set:Z.b").values()) == {"1"}
    assert set(values(found, "plant:z.x_mm").values()) == {"2"}
    assert found.columns == (*plan.columns, "plant:z.x_mm")
    assert {frozenset(row.overridden) for row in found.rows} == {
        frozenset(("set:Z.b", "plant:z.x_mm"))
    }
    assert values(found, "plc:V.E.A") == values(plan, "plc:V.E.A")


def test_a_row_with_several_values_is_refused_where_it_is_chosen(plan: Plan) -> None:
    with pytest.raises(UserError, match="the plan gives this column several values") as caught:
        given(plan, "plc:V.E.A=1")
    assert "case 'b'" in caught.value.message
    assert caught.value.value == "1"
    with pytest.raises(UserError, match="several values"):
        given(plan, "plc:V.E.A=1", select="b or c")


def test_a_row_that_is_not_chosen_stays_and_keeps_its_several_values(plan: Plan) -> None:
    found = given(plan, "plc:V.E.A=1", select="a or c")
    own = {"a-001": "1", "a-002": "1", "a": "1", "b-7": "7", "b-8": "8", "b": None, "c": "1"}
    assert values(found, "plc:V.E.A") == own
    for row in found.rows:
        assert ("plc:V.E.A" in row.overridden) is (row.case in ("a", "c"))
    other = given(plan, "set:Z.b=1", select="a")  # no list: of every row
    assert set(values(other, "set:Z.b").values()) == {"1"}


def test_a_searched_column_is_one_of_several_values(write_plan: PlanWriter) -> None:
    head = "case,program,rig,search:plc:V.E.A,check:lag_mm_max"
    rows = read_plan(write_plan(f"{head}\ns,{ROW},1 .. 9 to 1,<= 1\n"))
    with pytest.raises(UserError, match="several values") as caught:
        given(rows, "plc:V.E.A=1")
    assert "column 'search:plc:V.E.A'" in caught.value.message
    assert set(values(given(rows, "plc:V.E.B=1"), "plc:V.E.B").values()) == {"1"}


@pytest.mark.parametrize(
    ("select", "runs"),
    [(None, 5), ("b", 2), ("probing-b-7", 1), ("not probing-b", 3), ("a or c", 3)],
)
def test_a_choice_leaves_the_order_and_the_rest_of_a_plan(
    plan: Plan, select: str | None, runs: int
) -> None:
    found = selected(plan, select)
    assert len(found.cases) == runs
    assert [case for case in plan.cases if case in found.cases] == list(found.cases)
    assert found.statistics == plan.statistics
    with pytest.raises(UserError, match="no case fits") as caught:
        selected(plan, "nothing")
    assert caught.value.hint == f"axisrig check {plan.path} -v lists the cases"
    assert selected(plan, "nothing", may_be_none=True).cases == ()


# What is looked at


def test_where_a_plan_is_refused_the_first_run_of_each_row_is_looked_at(
    write_plan: PlanWriter,
) -> None:
    """Also of a row that is wrong, as far as it could be read; of a good plan none."""
    head = "case,program,rig,repeats,plc:V.E.A,seed"
    good = [f"a,{ROW},3,5,", f"b,{ROW},,[7 | 8 | 9],"]
    looked_at: list[str] = []

    def look(case: Case) -> None:
        looked_at.append(case.run)
        raise UserError(f"looked at {case.run}", file=case.file, line=case.line)

    assert len(read_plan(write_plan("\n".join([head, *good, ""])), look).cases) == 6
    assert looked_at == []
    with pytest.raises(UserError) as caught:
        read_plan(write_plan("\n".join([head, *good, f"c,{ROW},,,-1", ""])), look)
    assert looked_at == ["probing-a-001", "probing-b-7", "probing-c"]
    found = [one.message.partition(" (")[0] for one in (caught.value, *caught.value.further)]
    assert found == [
        "looked at probing-a-001", "looked at probing-b-7", "looked at probing-c",
        "not an integer in the range",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("columns", "cells", "message", "column"),
    [
        ("search:plc:V.E.A,search:plc:V.E.B", "1 .. 9 to 1,1 .. 9 to 1", "a row searches one value",
         5),
        ("search:plc:V.E.A,plc:V.E.A", "1 .. 9 to 1,5", "the row sets plc:V.E.A, and searches it",
         4),
    ],
)  # fmt: skip
def test_a_row_searches_one_value_that_it_does_not_set(
    write_plan: PlanWriter, columns: str, cells: str, message: str, column: int
) -> None:
    text = f"case,program,rig,{columns},check:lag_mm_max\ns,{ROW},{cells},<= 1\n"
    with pytest.raises(UserError) as caught:
        read_plan(write_plan(text))
    found = {(one.message.partition(" (")[0], one.column) for one in
             (caught.value, *caught.value.further)}  # fmt: skip
    assert (message, column) in found


@pytest.mark.parametrize(
    ("column", "asked"),
    [
        ("check:further_alarms", ["further_alarms", "alarms"]),
        ("check:alarms", ["alarms"]),
        ("check:lag_mm_max", ["lag_mm_max", "alarms"]),
    ],
)
def test_alarms_are_asked_for_unless_the_row_does(
    write_plan: PlanWriter, column: str, asked: list[str]
) -> None:
    cell = "<= 1" if "lag" in column else "none"
    (case,) = read_plan(write_plan(f"case,program,rig,{column}\na,{ROW},{cell}\n")).cases
    assert [check.metric for check in case.checks] == asked
    assert case.checks[-1].condition.text == "none"
