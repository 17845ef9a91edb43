"""Headers that ask for a statistic: their grammar, their limits, and the rows that they make."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.judge.statistics.functions import FUNCTIONS
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.plan.statistic_checks import (
    StatisticCheck,
    known_statistics,
    parse_any_check,
)
from axisrig.kernel.errors import UserError

ROOT = Path(__file__).parents[2]
HEAD = "case,program,rig,repeats,plc:V.E.FEED,check:latch_error_um"
Read = Callable[..., Plan]


@pytest.fixture
def read(tmp_path: Path) -> Read:
    """Read a plan with one more column; its cells are those of the header where not given."""

    def call(header: str, *rows: str) -> Plan:
        for name in ("a.nc", "r.toml"):
            (tmp_path / name).touch()
        text = "\n".join([f"{HEAD},{header}", *rows, ""])
        (tmp_path / "p.csv").write_text(text, encoding="utf-8")
        return read_plan(tmp_path / "p.csv")

    return call


def parsed(metric: str, condition: str = "<= 1") -> StatisticCheck:
    check = parse_any_check(metric, condition, "here")
    assert isinstance(check, StatisticCheck)
    return check


def test_the_table_names_the_functions_that_there_are() -> None:
    assert list(FUNCTIONS) == list(known_statistics())
    for row in known_statistics().values():
        assert row.arguments[0] == "metric"
        assert row.least <= row.few
        assert row.formula
        assert row.uncertainty
        assert row.meaning
        assert row.source or row.name == "count"


def test_the_page_has_the_table() -> None:
    page = (ROOT / "docs" / "statistics.md").read_text(encoding="utf-8")
    shown = [line.split("|")[1].strip(" `") for line in page.splitlines() if "(metric" in line]
    assert [name for name in shown if name.endswith(")")] == [
        row.form for row in known_statistics().values()
    ]


@pytest.mark.parametrize(
    ("metric", "unit"),
    [
        ("mean(latch_error_um)", "um"),
        ("spread_2s( latch_error_um:Z )", "um"),
        ("cpk(latch_error_um; -1 .. 1)", ""),
        ("slope(latch_error_um:Z; plc:V.E.FEED)", "um/(plc:V.E.FEED)"),
        ("slope(latch_error_um:Z; plant:probe.pretravel_um)", "um/um"),
        ("slope(latch_error_um; contact_velocity_mm_s)", "um/mm/s"),
        ("slope(latch_error_um; touch)", "um/touch"),
        ("drift(latch_error_um)", "um/value"),
        ("grr_pct(latch_mm; plant:probe.surface_mm; run)", "%"),
        ("mean(msg:N30.2)", ""),
    ],
)
def test_units_follow_from_the_metric(metric: str, unit: str) -> None:
    assert parsed(metric).unit == unit


def test_arguments_are_read() -> None:
    check = parsed("cpk(latch_error_um:Z; -0.5 .. 0.25; last)")
    assert (check.limits, check.is_last, check.axis) == ((-0.5, 0.25), True, "Z")
    assert check.name == "cpk(latch_error_um)"
    assert parsed("cpk(latch_error_um; <= 0.25)").limits == (None, 0.25)
    assert parsed("cg(latch_error_um; 40)").tolerance == 40.0
    assert parsed("share(latch_error_um; plc:V.E.FEED)").columns == ("plc:V.E.FEED",)


def test_a_statistic_of_each_run_stays_with_its_run(read: Read) -> None:
    """The runs of one case, each with a condition of its own, beside one over all of them."""
    plan = read(
        "expand,check:mean(latch_error_um; each),check:slope(latch_error_um; plc:V.E.FEED)",
        "a,a.nc,r.toml,,[60 | 600 | 900],,zip,[1 | 2 | 3] +- 0.1,0 +- 1",
    )
    texts = [[(c.metric, c.condition.text) for c in case.checks[:-1]] for case in plan.cases]
    metric = "mean(latch_error_um; each)"
    assert texts == [[(metric, f"{place} +- 0.1")] for place in (1, 2, 3)]
    (row,) = plan.statistics
    assert [check.metric for check in row.checks] == ["slope(latch_error_um; plc:V.E.FEED)"]
    alone = read("check:mean(latch_error_um; each)", "a,a.nc,r.toml,,[60 | 600],,0 +- 1")
    assert (len(alone.cases), alone.statistics) == (2, ())
    with pytest.raises(UserError, match="one value of plc:V"):
        read(
            "check:slope(latch_error_um; plc:V.E.FEED; each)",
            "a,a.nc,r.toml,,[60 | 600 | 900],,0 +- 1",
        )


@pytest.mark.parametrize(
    ("metric", "words"),
    [
        ("men(latch_error_um)", "unknown statistic.*did you mean: mean"),
        ("mean(latch_eror_um)", "unknown metric.*latch_error_um"),
        ("mean()", "not the arguments of the statistic"),
        ("mean(latch_error_um; 3)", r"not the arguments.*mean\(metric\)"),
        ("slope(latch_error_um)", r"not the arguments.*slope\(metric; column\)"),
        ("slope(latch_error_um; feed)", "neither an input column nor a metric"),
        ("share(latch_error_um; latch_mm)", "not an input column"),
        ("mean(alarms)", "needs a metric that is a number"),
        ("bias(latch_mm; latch_error_um)", "different units"),
        ("cp(latch_error_um; == 3)", "not limits"),
        ("cg(latch_error_um; 0)", "is not positive"),
        ("cg(latch_error_um; much)", "not a number"),
    ],
)
def test_what_cannot_be_asked_for_is_refused(metric: str, words: str) -> None:
    with pytest.raises(UserError) as refused:
        parsed(metric)
    assert re.search(words, str(refused.value)), str(refused.value)


def test_one_run_has_its_statistics_among_its_checks(read: Read) -> None:
    plan = read("check:mean(latch_error_um)", "a,a.nc,r.toml,,600,-1 .. 1,<= 1")
    assert plan.statistics == ()
    (case,) = plan.cases
    assert [check.metric for check in case.checks] == [
        *("latch_error_um", "mean(latch_error_um)", "alarms"),
    ]
    assert case.sampled == ()


def test_several_runs_get_a_row_after_the_last_of_them(read: Read) -> None:
    rows = ("a,a.nc,r.toml,2,600,-1 .. 1,<= 1", "b,a.nc,r.toml,,300,-1 .. 1,")
    plan = read("check:mean(latch_error_um)", *rows)
    assert [row.run for row in plan.rows] == ["p-a-001", "p-a-002", "p-a", "p-b"]
    (row,) = plan.statistics
    assert row.runs == ("p-a-001", "p-a-002")
    assert [check.metric for check in row.checks] == ["mean(latch_error_um)"]
    assert [case.run for case in plan.cases] == ["p-a-001", "p-a-002", "p-b"]
    assert [check.metric for check in plan.cases[0].checks] == ["latch_error_um", "alarms"]
    assert plan.cases[0].sampled == row.checks


def test_runs_of_a_sweep_are_one_case(read: Read) -> None:
    header = '"check:slope(latch_error_um:Z; plc:V.E.FEED)",checks,expect'
    checks = '"mean(latch_error_um) <= 0 ;; cpk(latch_error_um; <= 5) = > 1"'
    expected = '"fail:cpk(latch_error_um; <= 5)"'
    plan = read(header, f"a,a.nc,r.toml,,[300 | 600 | 900],,> 1,{checks},{expected}")
    (row,) = plan.statistics
    assert [case.run for case in plan.rows] == ["p-a-300", "p-a-600", "p-a-900", "p-a"]
    assert [check.metric for check in row.checks] == [
        "slope(latch_error_um:Z; plc:V.E.FEED)",
        "mean(latch_error_um)",
        "cpk(latch_error_um; <= 5)",
    ]
    assert row.expected == ("cpk(latch_error_um; <= 5)",)
    assert [case.expected for case in plan.cases] == [(), (), ()]
    assert row.inputs == {}


@pytest.mark.parametrize(
    ("expected", "of_runs", "of_row"),
    [
        ("fail:latch_error_um", ("latch_error_um",), ()),
        ("fail:mean(latch_error_um)", (), ("mean(latch_error_um)",)),
        (
            "fail:latch_error_um fail:mean(latch_error_um)",
            ("latch_error_um",),
            ("mean(latch_error_um)",),
        ),
    ],
)
def test_what_has_to_fail_is_expected_where_it_is_judged(
    read: Read, expected: str, of_runs: tuple[str, ...], of_row: tuple[str, ...]
) -> None:
    """A check of each run in the runs, a statistic over them in its row."""
    plan = read("check:mean(latch_error_um),expect", f"a,a.nc,r.toml,2,600,-1 .. 1,<= 1,{expected}")
    assert [case.expected for case in plan.cases] == [of_runs, of_runs]
    assert [row.expected for row in plan.statistics] == [of_row]


def test_a_row_of_statistics_has_an_id_of_its_own(read: Read) -> None:
    rows = ("a,a.nc,r.toml,,[300 | 600],,<= 1", "A,a.nc,r.toml,,600,,")
    with pytest.raises(UserError, match="has the id of a run"):
        read("check:mean(latch_error_um)", *rows)


def test_cpk_takes_the_limits_of_the_row(read: Read) -> None:
    (row,) = read("check:cpk(latch_error_um)", "a,a.nc,r.toml,2,600,-1 .. 2,> 1").statistics
    (check,) = row.checks
    assert isinstance(check, StatisticCheck)
    assert check.limits == (-1.0, 2.0)


@pytest.mark.parametrize(
    ("header", "row", "words"),
    [
        ("check:cpk(latch_mm)", "a,a.nc,r.toml,2,600,,> 1", "the row has no limits for latch_mm"),
        ("check:cp(latch_error_um)", "a,a.nc,r.toml,2,600,<= 1,> 1", "needs two different limits"),
        (
            "check:slope(latch_error_um; plc:V.E.FEED)",
            "a,a.nc,r.toml,2,600,,> 1",
            "one value of plc:V.E.FEED",
        ),
        (
            "check:slope(latch_error_um; plc:V.E.OTHER)",
            "a,a.nc,r.toml,2,600,,> 1",
            "does not set the column",
        ),
        (
            "check:slope(latch_error_um; plc:V.E.FEED)",
            "a,a.nc,r.toml,2,600 ; 0 at=1s,,> 1",
            "needs numbers",
        ),
        ("check:share(latch_error_um; run)", "a,a.nc,r.toml,,600,,> 1", "one value of run"),
    ],
)
def test_a_refusal_names_its_cell(read: Read, header: str, row: str, words: str) -> None:
    with pytest.raises(UserError) as refused:
        read(header, row)
    assert words in refused.value.message
    assert refused.value.line == 2
    assert refused.value.column is not None


@pytest.mark.parametrize(
    ("over", "flags"), [("", (False, False)), ("; last", (True, False)), ("; each", (False, True))]
)
def test_last_is_not_each_and_neither_is_all(over: str, flags: tuple[bool, bool]) -> None:
    check = parsed(f"mean(latch_error_um{over})")
    assert (check.is_last, check.is_each) == flags


@pytest.mark.parametrize("conditions", ["<= [1 | 2]", "[<= | >=] 1"])
def test_runs_of_a_case_have_one_condition_for_a_statistic(read: Read, conditions: str) -> None:
    """Which one would be asked of all their values? Those of a metric may differ."""
    row = "a,a.nc,r.toml,,[300 | 600],<= [1 | 2],zip,"
    with pytest.raises(UserError, match="the runs of a case have one condition") as caught:
        read("expand,check:mean(latch_error_um)", row + conditions)
    assert (caught.value.line, caught.value.column) == (2, 8)
    assert "`each`" in str(caught.value.hint)
    plan = read("expand,check:mean(latch_error_um)", row + "<= 1")
    assert [check.condition.text for check in plan.statistics[0].checks] == ["<= 1"]
    assert [case.checks[0].condition.upper for case in plan.cases] == [1.0, 2.0]


@pytest.mark.parametrize(
    ("header", "row", "group", "runs"),
    [
        ("check:slope(latch_error_um; touch)", "a,a.nc,r.toml,,600,,> 1", "touch", 1),
        ("check:slope(latch_error_um; run)", "a,a.nc,r.toml,2,600,,> 1", "run", 2),
        ('set:Z.edge,"check:share(latch_error_um; set:Z.edge)"',
         "a,a.nc,r.toml,,600,,[NEG | POS],> 0.5", "set:Z.edge", 2),
    ],
)  # fmt: skip
def test_columns_that_every_run_has_and_words_serve_as_groups(
    read: Read, header: str, row: str, group: str, runs: int
) -> None:
    """Touches are many in one run, which has the check itself; else it is of a row of its own."""
    plan = read(header, row)
    rows = plan.statistics if runs > 1 else plan.cases
    found = [one for one in rows[0].checks if isinstance(one, StatisticCheck)]
    assert [check.columns for check in found] == [(group,)]
    assert (len(plan.cases), len(plan.statistics)) == (runs, int(runs > 1))


def test_words_are_no_numbers_for_a_slope(read: Read) -> None:
    header = 'set:Z.edge,"check:slope(latch_error_um; set:Z.edge)"'
    with pytest.raises(UserError, match="the statistic needs numbers") as caught:
        read(header, "a,a.nc,r.toml,,600,,[NEG | POS],> 0.5")
    assert (caught.value.value, caught.value.column) == ("NEG", 7)
