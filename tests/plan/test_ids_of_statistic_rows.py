"""Rows of statistics beside the runs of a plan: their ids, what all runs share, what each keeps."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.kernel.errors import UserError

PlanWriter = Callable[..., Path]
HEAD = "case,program,rig,repeats,plc:V.E.A,check:latch_error_um,check:mean(latch_error_um)"
ROW = "probe.nc,machine.toml"


def plan_of(write_plan: PlanWriter, *rows: str, head: str = HEAD) -> Plan:
    return read_plan(write_plan("\n".join([head, *rows, ""])))


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("a", "a"),  # two rows of one name, whose runs differ
        ("a", "A"),  # file systems that ignore case would let one overwrite the other
        ("Touch", "tOUCH"),
    ],
)
def test_two_rows_of_statistics_have_two_ids(
    write_plan: PlanWriter, first: str, second: str
) -> None:
    rows = (f"{first},{ROW},,[1 | 2],,<= 1", f"{second},{ROW},,[3 | 4],,<= 1")
    with pytest.raises(UserError, match="the row of its statistics has the id of a run") as caught:
        plan_of(write_plan, *rows)
    assert (caught.value.line, caught.value.value) == (3, f"probing-{second}")


@pytest.mark.parametrize(("name", "value"), [("a", "1"), ("A", "1"), ("a", "2")])
def test_a_row_of_statistics_has_not_the_id_of_a_run(
    write_plan: PlanWriter, name: str, value: str
) -> None:
    """Wherever that run is, and in whatever letters."""
    rows = [f"{name},{ROW},,{value},<= 1,", f"a,{ROW},2,7,,<= 1"]
    if name == "a":  # one run of this name, and the statistics over two others
        for given in (rows, rows[::-1]):
            with pytest.raises(UserError, match="has the id of a run"):
                plan_of(write_plan, *given)
    else:
        with pytest.raises(UserError, match="has the id of a run"):
            plan_of(write_plan, *rows)


def test_rows_of_one_name_without_statistics_stay_apart(write_plan: PlanWriter) -> None:
    plan = plan_of(write_plan, f"a,{ROW},,[1 | 2],<= 1,", f"a,{ROW},,[3 | 4],<= 1,")
    assert [case.run for case in plan.cases] == [f"probing-a-{n}" for n in (1, 2, 3, 4)]
    assert plan.statistics == ()


def test_each_row_of_statistics_is_over_the_runs_of_its_own_row(write_plan: PlanWriter) -> None:
    plan = plan_of(
        write_plan,
        f"a,{ROW},2,7,,<= 1", f"b,{ROW},,[3 | 4],<= 5,<= 2", f"c,{ROW},,1,<= 1,",
        f"d,{ROW},3,,,<= 3",
    )  # fmt: skip
    found = {row.run: row.runs for row in plan.statistics}
    assert found == {
        "probing-a": ("probing-a-001", "probing-a-002"),
        "probing-b": ("probing-b-3", "probing-b-4"),
        "probing-d": ("probing-d-001", "probing-d-002", "probing-d-003"),
    }
    conditions = {row.run: [c.condition.text for c in row.checks] for row in plan.statistics}
    assert conditions == {"probing-a": ["<= 1"], "probing-b": ["<= 2"], "probing-d": ["<= 3"]}
    assert [row.repeat for row in plan.statistics] == [0, 0, 0]
    rows = [row.run for row in plan.rows]
    for of in plan.statistics:
        assert rows.index(of.run) == rows.index(of.runs[-1]) + 1


def test_a_row_of_statistics_has_the_inputs_that_all_its_runs_have(write_plan: PlanWriter) -> None:
    """A list and a value that is drawn are of one run each."""
    head = f"{HEAD},plc:V.E.B,plc:V.E.C"
    plan = plan_of(
        write_plan,
        f'a,{ROW},2,7,,<= 1,5,"normal(10, 1)"', f"b,{ROW},,[3 | 4],,<= 1,-2,6", head=head,
    )  # fmt: skip
    found = {row.run: dict(row.inputs) for row in plan.statistics}
    assert found == {
        "probing-a": {"plc:V.E.A": "7", "plc:V.E.B": "5"},
        "probing-b": {"plc:V.E.B": "-2", "plc:V.E.C": "6"},
    }


@pytest.mark.parametrize(
    ("expect", "of_runs", "of_row"),
    [
        ("fail:latch_error_um", ("latch_error_um",), ()),
        ("fail:mean(latch_error_um)", (), ("mean(latch_error_um)",)),
        ("fail:latch_error_um mean(latch_error_um)", ("latch_error_um",),
         ("mean(latch_error_um)",)),
        ("", (), ()),
    ],
)  # fmt: skip
def test_what_must_fail_is_expected_where_it_is_judged(
    write_plan: PlanWriter, expect: str, of_runs: tuple[str, ...], of_row: tuple[str, ...]
) -> None:
    plan = plan_of(write_plan, f"a,{ROW},2,7,<= 1,<= 1,{expect}", head=f"{HEAD},expect")
    assert [case.expected for case in plan.cases] == [of_runs] * 2
    (row,) = plan.statistics
    assert row.expected == of_row
    for case in plan.cases:
        assert [check.metric for check in case.checks] == ["latch_error_um", "alarms"]
        assert [check.metric for check in case.sampled] == ["mean(latch_error_um)"]
