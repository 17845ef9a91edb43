"""Every statistic of two and three values by its formula: value, uncertainty and words."""

import math
from collections.abc import Sequence
from statistics import NormalDist

import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.statistics.functions import FUNCTIONS
from axisrig.bench.judge.statistics.summary import describe, statistics_data
from axisrig.bench.judge.statistics.verdict import (
    Reading,
    RunSample,
    counted_values,
    judge_statistic,
    readings,
)
from axisrig.bench.plan.checks import Check, CheckResult
from axisrig.bench.plan.statistic_checks import StatisticCheck, parse_any_check
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.measuring import MeasurementRun

U = 0.01
"""Uncertainty of each value."""
TWO, THREE = (0.1, 0.3), (0.0, 1.0, 5.0)
S = 0.1 * math.sqrt(2.0)
"""Of TWO; the rests of THREE about its line over 0, 1, 2 are 0.5, -1, 0.5."""


def t_1(two_sided: float) -> float:
    """Student's t of one degree of freedom."""
    return math.tan(math.pi / 2.0 * two_sided)


def z(probability: float) -> float:
    return NormalDist().inv_cdf(probability)


T, Z = t_1(0.95), z(0.975)
# Chi-square of one degree is the square of a normal number
LOW, HIGH = 1.0 / z(0.9875), 1.0 / z(0.5125)
OF_SLOPE = T * math.sqrt(1.5 / 2.0)
OF_INTERCEPT = T * math.sqrt(1.5 * (1.0 / 3.0 + 1.0 / 2.0))
CP, CPK, CG, CGK = 2.0 / (6 * S), 0.8 / (3 * S), 0.8 / (6 * S), (0.4 - 0.2) / (3 * S)


def bissell(value: float) -> float:
    return Z * math.sqrt(1.0 / 18.0 + value**2 / 2.0)


def asked(metric: str, condition: str = "-1e6 .. 1e6") -> StatisticCheck:
    check = parse_any_check(metric, condition, "here")
    assert isinstance(check, StatisticCheck)
    return check


def run_of(
    values: Sequence[float], sides: Sequence[float] = (), name: str = "a", u: float = U
) -> RunSample:
    found = [
        Reading(
            number,
            Observation(value, u),
            tuple(Observation(side, 2 * u) for side in sides[number - 1 : number]),
        )
        for number, value in enumerate(values, start=1)
    ]
    return RunSample(name, tuple(found), frames=name)


OF_LINE = "r^2 0.8929, s about the line 1.22"
METRIC = "latch_error_um"
CASES: dict[str, tuple[Sequence[float], float, float, str]] = {
    f"count({METRIC})": (TWO, 2.0, 0.0, ""),
    f"mean({METRIC})": (TWO, 0.2, 0.1 * T + U, "t s / sqrt(n) 1.27"),
    f"spread({METRIC})": (
        *(TWO, S, S * (HIGH - 1.0) + U * math.sqrt(2.0)),
        f"95 % {S * LOW:.4g} .. {S * HIGH:.4g}",
    ),
    f"spread_2s({METRIC})": (
        *(TWO, 2 * S, 2 * S * (HIGH - 1.0) + 2 * U * math.sqrt(2.0)),
        f"95 % {2 * S * LOW:.4g} .. {2 * S * HIGH:.4g}",
    ),
    # P(chi2 > s^2/0.1^2 = 2) = erfc(1)
    f"spread_p({METRIC}; 0.1)": (TWO, 2.0 * math.erfc(1.0), 0.0, "s 0.1414 against 0.1"),
    f"range({METRIC})": (TWO, 0.2, 2 * U, ""),
    f"cp({METRIC}; -1 .. 1)": (
        *(TWO, CP, CP * (1.0 / LOW - 1.0)),
        f"limits -1 .. 1; 95 % {CP / HIGH:.3g} .. {CP / LOW:.3g}",
    ),
    f"cpk({METRIC}; -2 .. 1)": (
        *(TWO, CPK, bissell(CPK)),
        f"limits -2 .. 1; 95 % {CPK - bissell(CPK):.3g} .. {CPK + bissell(CPK):.3g}",
    ),
    f"cpk({METRIC}; <= 1)": (TWO, CPK, bissell(CPK), "limits open .. 1; 95 %"),
    f"cpk({METRIC}; >= -0.6)": (TWO, CPK, bissell(CPK), "limits -0.6 .. open; 95 %"),
    f"slope({METRIC}; contact_velocity_mm_s)": (THREE, 2.5, OF_SLOPE, OF_LINE),
    f"intercept({METRIC}; contact_velocity_mm_s)": (THREE, -0.5, OF_INTERCEPT + U, OF_LINE),
    f"intercept({METRIC}; touch)": (THREE, -3.0, T * math.sqrt(1.5 * (1 / 3 + 4 / 2)) + U, OF_LINE),
    f"drift({METRIC})": (THREE, 2.5, OF_SLOPE, "rank test p 0.333"),
    f"drift_p({METRIC})": (THREE, 1 / 3, 0.0, "Kendall's tau 1"),
    # Of three values W = (range^2/2)/sum of squares, p = 6/pi (asin sqrt W - asin sqrt(3/4))
    f"normality_p({METRIC})": (
        *(THREE, 6 / math.pi * (math.asin(math.sqrt(12.5 / 14)) - math.pi / 3), 0.0),
        "",
    ),
    # The others have mean 3 and s sqrt(8)
    f"first_sample({METRIC})": (
        *(THREE, 3.0 / (T * math.sqrt(8 * 1.5)), 0.0),
        f"3 against {T * math.sqrt(12):.4g}",
    ),
    f"bias({METRIC}; latch_error_um)": (TWO, 0.2, 0.1 * T + U + 2 * U, "t s / sqrt(n) 1.27"),
    f"bias_p({METRIC})": (TWO, 1.0 - 2.0 / math.pi * math.atan(2.0), 0.0, "bias 0.2"),
    f"cg({METRIC}; 4)": (
        *(TWO, CG, CG * (1.0 / LOW - 1.0)),
        f"bias 0.2, s 0.1414, tolerance 4; 95 % {CG / HIGH:.3g} .. {CG / LOW:.3g}",
    ),
    f"cgk({METRIC}; 4)": (
        *(TWO, CGK, bissell(CGK)),
        f"tolerance 4; 95 % {CGK - bissell(CGK):.3g} .. {CGK + bissell(CGK):.3g}",
    ),
}
SIDES = {"bias": (0.0, 0.0), "slope": (0.0, 1.0, 2.0), "intercept": (0.0, 1.0, 2.0)}


@pytest.mark.parametrize("metric", CASES)
def test_a_statistic_is_its_formula(metric: str) -> None:
    values, value, uncertainty, words = CASES[metric]
    name = metric.partition("(")[0]
    sides = SIDES.get(name, ()) if "touch" not in metric else ()
    found = judge_statistic(asked(metric), [run_of(values, sides)])
    assert found.value == pytest.approx(value, rel=1e-6)
    assert found.uncertainty == pytest.approx(uncertainty, rel=1e-6)
    assert words in found.note
    few = "" if asked(metric).statistic.few <= len(values) else "small sample"
    assert few in found.note
    assert "; ;" not in found.note


def test_an_outlier_is_the_value_that_is_farthest() -> None:
    """THREE has mean 2 and s^2 7: the last is 3 off; G is at most 2/sqrt(3)."""
    t = t_1(1.0 - 0.05 / 3)
    critical = 2.0 / math.sqrt(3.0) * math.sqrt(t**2 / (1.0 + t**2))
    found = judge_statistic(asked(f"outlier({METRIC})", "<= 1"), [run_of(THREE)])
    assert found.value == pytest.approx(3.0 / math.sqrt(7.0) / critical)
    assert f"value 3 (5) is the farthest: G 1.134, {critical:.4g}" in found.note


@pytest.mark.parametrize(
    ("rest", "words"), [(0.25, "with interaction"), (0.9, "interaction pooled")]
)
def test_a_study_adds_the_uncertainty_of_a_value_to_its_spreads(rest: float, words: str) -> None:
    """Of 12 values; a share of spreads is not off by it."""

    def judged(name: str, u: float) -> CheckResult:
        runs = []
        for part in range(3):
            for operator in range(2):
                middle = 3.0 * part + 4.0 * operator + (part - 1) * (2 * operator - 1)
                run = run_of((middle - rest, middle + rest), name=f"{part}{operator}", u=u)
                inputs = {"plc:V.E.P": f"{part}", "plc:V.E.O": f"{operator}"}
                runs.append(RunSample(run.run, run.readings, inputs=inputs, frames=run.frames))
        return judge_statistic(asked(f"{name}({METRIC}; plc:V.E.P; plc:V.E.O)"), runs)

    for name in ("repeatability", "reproducibility", "grr", "grr_pct"):
        sure, unsure = judged(name, 0.0), judged(name, U)
        wider = 0.0 if name == "grr_pct" else U * math.sqrt(12 / 11)
        assert unsure.value == sure.value
        assert unsure.uncertainty - sure.uncertainty == pytest.approx(wider, abs=1e-12)
        assert f"3 parts, 2 operators, 2 repeats, {words}; 95 % " in sure.note


def test_every_statistic_of_the_table_is_held_here() -> None:
    held = {metric.partition("(")[0] for metric in CASES} | {"outlier"}
    studies = {"repeatability", "reproducibility", "grr", "grr_pct", "share"}
    assert held | studies == set(FUNCTIONS)


def test_a_first_value_beside_equal_ones_has_no_ratio() -> None:
    found = judge_statistic(asked(f"first_sample({METRIC})"), [run_of((1.0, 2.0, 2.0))])
    assert (found.value, found.verdict) == (None, Verdict.INCONCLUSIVE)
    assert "all values but the first are equal" in found.note
    share = judge_statistic(
        asked(f"share({METRIC}; plc:V.E.P)"),
        [RunSample(p, run_of((1.0, 2.0)).readings, inputs={"plc:V.E.P": p}) for p in "ab"],
    )
    assert share.note.endswith(f"95 % 0 .. {share.uncertainty:.4g}")


# What counts


@pytest.mark.parametrize(("count", "named"), [(1, "a"), (3, "a, b, c"), (4, "a, b, c, ...")])
def test_three_runs_are_named_and_more_are_only_counted(count: int, named: str) -> None:
    names = "abcd"[:count]
    lost = [RunSample(name, missing="is missing") for name in names]
    found = judge_statistic(asked(f"mean({METRIC})"), [run_of(TWO, name="x"), *lost])
    words = ", ".join(n if n == "..." else f"{n} is missing" for n in named.split(", "))
    assert found.note == f"without values of {count} of {count + 1} runs: {words}"
    assert (found.value, found.uncertainty) == (None, 0.0)
    again = [RunSample(name, run_of((7.0,)).readings, frames="x") for name in names]
    found = judge_statistic(asked(f"mean({METRIC})"), [run_of(TWO, name="x"), *again])
    assert f"n = 2 from 1 of {count + 1} runs; same frames as an earlier run" in found.note
    assert f", not counted: {named};" in found.note


def test_inputs_have_no_order_and_unknown_frames_are_never_equal() -> None:
    one, other = {"plc:A": "1", "plc:B": "2"}, {"plc:B": "2", "plc:A": "1"}
    readings_ = run_of((1.0,)).readings
    alike = [RunSample("a", readings_, inputs=one, frames="f"),
             RunSample("b", readings_, inputs=other, frames="f")]  # fmt: skip
    unknown = [RunSample(name, readings_) for name in "abc"]
    check = asked(f"count({METRIC})")
    assert [judge_statistic(check, runs).value for runs in (alike, unknown)] == [1.0, 3.0]


@pytest.mark.parametrize(
    ("run", "value", "note", "words"),
    [
        ("a", None, "met nothing", "a, touch 2: met nothing"),
        ("a", None, "", "a, touch 2: no number"),
        ("", None, "", "touch 2: no number"),
        ("a", "FREE", "", "a, touch 2: no number"),
        ("a", True, "", "a, touch 2: no number"),
    ],
)
def test_a_value_that_is_no_number_is_named(
    run: str, value: float | str | None, note: str, words: str
) -> None:
    both = (Reading(1, Observation(1.0)), Reading(2, Observation(value, note=note)))
    of_side = (
        Reading(1, Observation(1.0), (Observation(0.0),)),
        Reading(2, Observation(1.0), (Observation(value, note=note),)),
    )
    for metric, found in ((f"mean({METRIC})", both), (f"bias({METRIC}; {METRIC})", of_side)):
        seen = judge_statistic(asked(metric), [RunSample(run, found)])
        assert (seen.verdict, seen.note) == (Verdict.FAIL, words)


def test_the_largest_uncertainty_counts_and_columns_number_from_one() -> None:
    """3, 5 and 7 in three runs, and in three touches of one: on a line with 1 at 0."""
    runs = [
        run_of((value,), name=name, u=u)
        for value, name, u in ((3.0, "a", U), (5.0, "b", 5 * U), (7.0, "c", 2 * U))
    ]
    assert judge_statistic(asked(f"range({METRIC})"), runs).uncertainty == 10 * U
    of_runs = judge_statistic(asked(f"intercept({METRIC}; run)"), runs)
    of_touches = judge_statistic(asked(f"intercept({METRIC}; touch)"), [run_of((3.0, 5.0, 7.0))])
    assert of_runs.value == pytest.approx(1.0)
    assert of_touches.value == pytest.approx(1.0)
    assert of_runs.uncertainty == pytest.approx(5 * U, abs=1e-6)


def test_a_sample_of_as_many_values_as_are_asked_is_not_small() -> None:
    check = asked(f"mean({METRIC})")
    notes = [judge_statistic(check, [run_of([*range(n)])]).note for n in (4, 5)]
    assert ["small sample (fewer than 5)" in note for note in notes] == [True, False]


def test_the_values_that_count_have_the_names_of_run_and_touch() -> None:
    values: tuple[float | str, ...] = (1.0, math.inf, "FREE", 2.0)
    odd = tuple(Reading(number, Observation(value)) for number, value in enumerate(values, 1))
    samples = [RunSample("a", odd, frames="f"), RunSample("b", odd, frames="f"),
               RunSample("c", run_of((3.0,)).readings, frames="g")]  # fmt: skip
    assert counted_values(samples) == (
        ["a, touch 1", "a, touch 4", "c, touch 1"],
        [1.0, 2.0, 3.0],
        ["b"],
    )


def test_an_axis_is_asked_of_the_runs_in_which_it_takes_part() -> None:
    """Z measures in the first and in the third run, X in the second."""
    runs = tuple(
        MeasurementRun((axis,), inputs={axis: 1}, begin_ns=10 * n, latched_mm={axis: float(n)})
        for n, axis in enumerate("ZXZ")
    )
    axes = {name: AxisRecord("can1", 1, 1.0) for name in "XZ"}
    observed = Observed(facts(axes=axes, runs=runs), kept(pa.table({"time_ns": [0, 1]})))

    def observe(part: Observed, check: Check) -> Observation:
        last = part.last_run(check.axis)
        return Observation(None if last is None else sum(last.latched_mm.values()))

    def found(metric: str) -> list[tuple[int, object]]:
        return [(r.touch, r.metric.value) for r in readings(observed, asked(metric), observe)]

    assert found("mean(latch_mm:Z)") == [(1, 0.0), (2, 2.0)]
    assert found("mean(latch_mm:X)") == [(1, 1.0)]
    assert found("mean(latch_mm)") == [(1, 0.0), (2, 1.0), (3, 2.0)]
    assert found("mean(latch_mm:Z; last)") == [(1, 2.0)]
    assert len(found("mean(latch_mm:Y)")) == 1


# The summary of a report


def test_a_description_has_what_each_part_is_called() -> None:
    found = describe(["a", "b", "c"], [0.0, 1.0, 5.0], -1.0, 7.0)
    assert found.values == [("a", 0.0), ("b", 1.0), ("c", 5.0)]
    assert found.drift
    assert (found.drift.slope.value, found.drift.rank.tau) == (pytest.approx(2.5), 1.0)
    assert found.outlier
    assert (found.outlier.run, found.outlier.is_apart) == ("c", False)
    assert found.first_sample
    assert found.first_sample.run == "a"
    assert found.cp
    assert found.cp.value == pytest.approx(8.0 / (6.0 * math.sqrt(7.0)))
    assert found.cpk
    assert found.cpk.value == pytest.approx(1.0 / math.sqrt(7.0))
    assert describe("abc", [0.0, 1.0, 5.0], None, 7.0).cp is None
    assert describe("abc", [0.0, 1.0, 5.0], -1.0, None).cp is None
    apart = describe([*"abcdefghij"], [9.0, *(0.01 * n for n in range(9))], None, None)
    assert apart.outlier
    assert apart.first_sample
    assert (apart.is_small, apart.outlier.is_apart, apart.first_sample.is_apart) == (
        *(False, True, True),
    )
    assert describe([*"abcdefghi"], [*range(9)], None, None).is_small is True
    assert describe("abc", [9.0, 1.0, 1.0], None, None).first_sample is None


def _rows(
    values: Sequence[str], limits: Sequence[str] = (), **columns: Sequence[str]
) -> tuple[list[dict[str, str]], list[dict[str, str]]]:
    cases = [
        {"run": f"r{n}", "case": "x", **{name: texts[n] for name, texts in columns.items()}}
        for n in range(len(values))
    ]
    checks = [
        {"run": f"r{n}", "metric": "gap_mm", "value": value}
        | ({"upper": limits[n]} if limits else {})
        for n, value in enumerate(values)
    ]
    return checks, cases


@pytest.mark.parametrize(
    ("limits", "upper"),
    [(("2", "2"), 2.0), (("2", "3"), None), (("", ""), None), (("inf", "inf"), None), ((), None)],
)
def test_a_limit_is_shown_where_all_runs_have_it(
    limits: Sequence[str], upper: float | None
) -> None:
    (found,) = statistics_data(*_rows(["1", "3"], limits))
    assert (found.found.lower, found.found.upper) == (None, upper)


def test_only_inputs_that_vary_are_columns() -> None:
    columns = {
        "plc:V.E.A": ["1", "2", "4"],
        "set:Z.kind": ["on", "off", "on"],
        "set:Z.same": ["1", "1", "1"],
        "title": ["1", "2", "3"],
        "check:gap_mm": ["1", "2", "3"],
        "plc": ["1", "2", "3"],
    }
    (found,) = statistics_data(*_rows(["10", "20", "40"], **columns))
    assert set(found.inputs) == {"plc:V.E.A", "set:Z.kind"}
    feed, kind = found.inputs["plc:V.E.A"], found.inputs["set:Z.kind"]
    assert feed.slope
    assert feed.intercept
    assert feed.slope.value == pytest.approx(10.0)
    assert feed.intercept.value == pytest.approx(0.0, abs=1e-9)
    assert (kind.places, kind.slope) == (["on", "off", "on"], None)
    # Means 25 and 20 about 70/3: (2 (5/3)^2 + (10/3)^2)/((40/3)^2 + (10/3)^2 + (50/3)^2)
    assert kind.share == pytest.approx(150.0 / 4200.0)


def test_a_value_that_is_not_finite_is_left_out() -> None:
    (found,) = statistics_data(*_rows(["1", "inf", "3"]))
    assert (found.found.n, found.missing) == (2, ["r1"])
    assert statistics_data(*_rows(["inf", "nan"])) == []
