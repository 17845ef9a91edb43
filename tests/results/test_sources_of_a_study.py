"""`axisrig sources`: the line of a case in the units of its table, and what a plan leaves out."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.errors import UserError
from axisrig.results import sources
from axisrig.results.sources import METRIC, OF_STOP, VELOCITY, SourceRow, source_rows, sources_table

SIGNALS = {"set:Z.kenngr.measure.signal": "PLC", "set:X.kenngr.measure.signal": "",
           "set:Z.kenngr.measure.edge": "POS"}  # fmt: skip


def point(run: str, x: float, y: float, spread: float | None = 0.2) -> Any:
    return SimpleNamespace(run=run, x=x, y=y, spread=spread)


def line(
    *points: Any, metric: str = METRIC, column: str = VELOCITY, slope: str = "0.5 +- 0.01",
    intercept: str = "8 +- 1",
) -> Any:  # fmt: skip
    """Slope 0.503 with a bound of 0.002."""
    ends = (SimpleNamespace(asked=slope, uncertainty="0.002"), SimpleNamespace(asked=intercept))
    fitted = SimpleNamespace(name="case", slope=0.503, points=points)
    return SimpleNamespace(metric=metric, column=column, fitted=(fitted,), rows=(ends,))


def results(monkeypatch: pytest.MonkeyPatch, *found: Any, ranges: Any = None) -> Any:
    """Runs a and b of the case; ranges: of `range(metric)`, by run."""
    checks = ranges or {"a": 0.7, "b": 0.9}
    runs = [
        SimpleNamespace(
            run=run, case=SIGNALS,
            checks=[SimpleNamespace(metric="other", number=99.0)] + [
                SimpleNamespace(metric=f"range({one.metric})", number=checks[run])
                for one in found if run in checks
            ],
        )
        for run in ("a", "b")
    ]  # fmt: skip
    monkeypatch.setattr(sources, "lines", lambda _: list(found))
    return SimpleNamespace(runs=runs, folder="out")


@pytest.mark.interpreted
def test_a_row_is_of_the_fastest_run_whichever_way_it_goes(monkeypatch: pytest.MonkeyPatch) -> None:
    """-20 mm/s are 1200 mm/min; 18.5 um there are 10.5 more than the pre-travel of 8."""
    made = line(point("a", -20.0, 18.5), point("b", 5.0, 11.0, 0.4))
    (row,) = source_rows(results(monkeypatch, made))
    assert row == SourceRow("PLC", "case", 0.5, 0.503, 0.002, 1200.0, 10.5, 0.2, 0.7)
    assert sources_table(results(monkeypatch, made)).splitlines()[2] == (
        "| `PLC` | `case` | 0.500 | 0.503 ± 0.002 | 1200 | 10.500 | 0.200 | 0.700 |"
    )


@pytest.mark.interpreted
def test_of_a_fixed_stop_the_value_itself_is_in_mm(monkeypatch: pytest.MonkeyPatch) -> None:
    made = line(point("a", 1.0, 99.9, 0.001), point("b", 2.0, 100.002, 0.0005), metric=OF_STOP,
                slope="0.5 +- 0.1", intercept="100 +- 0.1")  # fmt: skip
    (row,) = source_rows(results(monkeypatch, made, ranges={"b": 0.004}))
    found = [row.expected_ms, row.found_ms, row.bound_ms, row.feed_mm_min, row.off_um,
             row.spread_um, row.range_um]  # fmt: skip
    assert found == pytest.approx([500.0, 503.0, 2.0, 120.0, 2.0, 0.5, 4.0])


@pytest.mark.interpreted
def test_what_a_plan_does_not_ask_for_is_left_open(monkeypatch: pytest.MonkeyPatch) -> None:
    """No `range`, no `spread`, limits that have no middle; a line without runs is no row."""
    made = line(point("a", 10.0, 9.0, None), slope="<= 0.6", intercept="7 .. 9")
    both = results(monkeypatch, line(), made, ranges={"b": 1.0})
    (row,) = source_rows(both)
    assert (row.expected_ms, row.off_um, row.spread_um, row.range_um) == (None,) * 4
    assert sources_table(both).splitlines()[2:] == [
        "| `PLC` | `case` | - | 0.503 ± 0.002 | 600 | - | - | - |"
    ]


@pytest.mark.interpreted
def test_a_line_of_another_metric_or_over_another_column_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    others = [line(point("a", 1.0, 1.0), metric="lag_mm"),
              line(point("a", 1.0, 1.0), column="plc:V.E.FEED")]  # fmt: skip
    with pytest.raises(UserError, match="no case has slope and intercept of latch_error_um"):
        source_rows(results(monkeypatch, *others))


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("bound", "delay", "found"),
    [
        ("0.0", "0.5000", "0.5030"),  # no spread at all: one digit more, and no bound
        ("0.0009", "0.5000", "0.5030"),
        ("0.001", "0.500", "0.503 ± 0.001"),
    ],
)
def test_a_delay_has_the_digits_that_its_bound_leaves(
    monkeypatch: pytest.MonkeyPatch, bound: str, delay: str, found: str
) -> None:
    made = line(point("a", 10.0, 8.0, 0.0))
    made.rows[0][0].uncertainty = bound
    text = sources_table(results(monkeypatch, made, ranges={"a": 0.0}))
    assert text.splitlines()[2] == (
        f"| `PLC` | `case` | {delay} | {found} | 600 | 0.000 | 0.000 | 0.000 |"
    )


@pytest.mark.interpreted
def test_several_signals_are_named_once_each_and_every_line_is_a_row(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The line of a fixed stop beside that of a latch, each in its own unit."""
    stop = line(point("b", 1.0, 100.25), metric=OF_STOP, intercept="100 +- 1")
    both = results(monkeypatch, line(point("a", 10.0, 9.0)), stop)
    both.runs[0].case = {"set:Z.kenngr.measure.signal": "PLC", "set:X.kenngr.measure.signal": "CNC",
                         "set:Y.kenngr.measure.signal": "PLC"}  # fmt: skip
    first, second = source_rows(both)
    assert (first.source, second.source) == ("CNC, PLC", "PLC")
    assert (first.off_um, second.off_um) == (1.0, 250.0)


def test_a_range_is_that_of_the_metric_of_its_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """Latch and fixed stop of one run, each with its own: 0.7 um and 0.004 mm."""
    latch = line(point("a", 10.0, 9.0))
    stop = line(point("a", 10.0, 100.25), metric=OF_STOP, intercept="100 +- 1")
    both = results(monkeypatch, latch, stop)
    ranges = {METRIC: 0.7, OF_STOP: 0.004}
    for order in (1, -1):
        for one in both.runs:
            one.checks = [type(one.checks[0])(metric=f"range({name})", number=number)
                          for name, number in [*ranges.items()][::order]]  # fmt: skip
        first, second = source_rows(both)
        assert (first.range_um, second.range_um) == pytest.approx((0.7, 4.0))
