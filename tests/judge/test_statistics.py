"""Statistics over samples of runs: what counts, what is inconclusive, and their verdicts."""

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pytest
from scipy import stats
from tests.recordings import facts, kept

from axisrig.bench.judge.fixed_stop import run as stops
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.statistics.verdict import Reading, RunSample, judge_statistic, readings
from axisrig.bench.judge.topics import judged
from axisrig.bench.plan.checks import Check, CheckResult
from axisrig.bench.plan.statistic_checks import StatisticCheck, parse_any_check
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord, Contact, ProbeRecord
from axisrig.bench.record.measuring import FixedStop, MeasurementRun

MS = 1_000_000
VALUES = (0.4, 0.1, -0.2, 0.3, 0.0, 0.2)


def asked(metric: str, condition: str = "-1 .. 1") -> StatisticCheck:
    check = parse_any_check(metric, condition, "here")
    assert isinstance(check, StatisticCheck)
    return check


def sample(
    run: str, values: Sequence[float], *, u: float = 0.0, sides: Sequence[float] = (), **more: str
) -> RunSample:
    found = tuple(
        Reading(
            number,
            Observation(value, u),
            (Observation(sides[number - 1]),) if sides else (),
        )
        for number, value in enumerate(values, start=1)
    )
    return RunSample(run, found, more.pop("missing", ""), more, frames=more.pop("frames", run))


def test_a_mean_is_known_to_its_interval_and_the_uncertainty_of_its_values() -> None:
    found = judge_statistic(asked("mean(latch_error_um)"), [sample("a", VALUES, u=0.01)])
    interval = stats.ttest_1samp(VALUES, 0.0).confidence_interval(0.95)
    assert found.value == pytest.approx(np.mean(VALUES))
    assert found.uncertainty == pytest.approx((interval.high - interval.low) / 2 + 0.01)
    assert found.verdict is Verdict.PASS
    assert found.note.startswith("n = 6; t s / sqrt(n)")


def test_values_of_all_runs_and_touches_make_one_sample() -> None:
    runs = [sample("a", VALUES[:2]), sample("b", VALUES[2:])]
    found = judge_statistic(asked("spread(latch_error_um)"), runs)
    assert found.value == pytest.approx(stats.tstd(VALUES))
    assert "n = 6 from 2 of 2 runs; small sample (fewer than 10)" in found.note


def test_runs_with_equal_frames_and_inputs_count_once() -> None:
    runs = [
        sample("a", [1.0], frames="f"),
        sample("b", [1.0], frames="f"),
        sample("c", [2.0], frames="g"),
    ]
    found = judge_statistic(asked("mean(latch_error_um)"), runs)
    assert found.value == 1.5
    assert "n = 2 from 2 of 3 runs; same frames as an earlier run, not counted: b" in found.note


def test_equal_frames_of_other_inputs_count() -> None:
    runs = [
        sample("a", [1.0], frames="f", **{"plc:V.E.FEED": "300"}),
        sample("b", [1.0], frames="f", **{"plc:V.E.FEED": "600"}),
    ]
    assert judge_statistic(asked("count(latch_error_um)"), runs).value == 2.0


@pytest.mark.parametrize("reason", ["is missing", "is aborted", "is in error"])
def test_a_run_without_values_makes_it_inconclusive(reason: str) -> None:
    runs = [sample("a", VALUES), sample("b", (), missing=reason)]
    found = judge_statistic(asked("mean(latch_error_um)"), runs)
    assert (found.value, found.verdict) == (None, Verdict.INCONCLUSIVE)
    assert found.note == f"without values of 1 of 2 runs: b {reason}"


def test_too_few_values_and_no_spread_are_inconclusive() -> None:
    few = judge_statistic(asked("mean(latch_error_um)"), [sample("a", [1.0])])
    assert (few.value, few.verdict) == (None, Verdict.INCONCLUSIVE)
    assert few.note == "n = 1; mean needs 2 values"
    repeats = [sample(name, [1.0], frames="f") for name in ("a", "b")]
    note = judge_statistic(asked("mean(latch_error_um)"), repeats).note
    assert "mean needs 2 values; nothing in the row is random" in note
    assert "drive:<drive>.input_jitter_us" in note
    flat = judge_statistic(asked("cpk(latch_error_um; -1 .. 1)"), [sample("a", [1.0, 1.0])])
    assert flat.verdict is Verdict.INCONCLUSIVE
    assert "all values are equal" in flat.note


def test_a_touch_without_its_metric_fails() -> None:
    readings_ = (Reading(1, Observation(1.0)), Reading(2, Observation(None, note="met nothing")))
    found = judge_statistic(asked("mean(latch_error_um)"), [RunSample("a", readings_)])
    assert (found.verdict, found.note) == (Verdict.FAIL, "a, touch 2: met nothing")
    hidden = (Reading(1, Observation(None, note="real", is_hidden=True)),)
    seen = judge_statistic(asked("mean(latch_error_um)"), [RunSample("a", hidden)])
    assert seen.verdict is Verdict.INCONCLUSIVE


def test_cpk_is_judged_by_its_lower_bound() -> None:
    """Cpk 1.5 of 6 values: with Bissell's bound of 0.95 it is not above 1, but above 0.5."""
    values = np.array(VALUES) - np.mean(VALUES)
    limit = 4.5 * stats.tstd(values)
    metric = f"cpk(latch_error_um; {-limit} .. {limit})"
    bound = 1.959964 * (1 / 54 + 1.5**2 / 10) ** 0.5
    for condition, verdict in (("> 1", Verdict.INCONCLUSIVE), ("> 0.5", Verdict.MARGINAL)):
        found = judge_statistic(asked(metric, condition), [sample("a", list(values))])
        assert found.value == pytest.approx(1.5)
        assert found.uncertainty == pytest.approx(bound, rel=1e-6)
        assert found.verdict is verdict


def test_a_slope_is_over_a_column_of_the_runs_or_over_another_metric() -> None:
    runs = [
        sample(str(feed), [2.0 * feed + 1.0, 2.0 * feed + 1.2], **{"plc:V.E.FEED": str(feed)})
        for feed in (300, 600, 900)
    ]
    over = judge_statistic(asked("slope(latch_error_um; plc:V.E.FEED)", "== 2"), runs)
    assert over.value == pytest.approx(2.0)
    assert over.check.unit == "um/(plc:V.E.FEED)"
    words = [replace(run, inputs={"plc:V.E.FEED": "fast"}) for run in runs]
    open_ = judge_statistic(asked("slope(latch_error_um; plc:V.E.FEED)"), words)
    assert open_.verdict is Verdict.INCONCLUSIVE
    assert "holds no number" in open_.note
    zero = judge_statistic(asked("intercept(latch_error_um; plc:V.E.FEED)"), runs)
    assert zero.value == pytest.approx(1.1)
    beside = [sample("a", [1.0, 3.0, 5.0], sides=[0.0, 1.0, 2.0])]
    metric = asked("slope(latch_error_um; contact_velocity_mm_s)", "1 .. 3")
    assert judge_statistic(metric, beside).value == pytest.approx(2.0)
    metric = asked("slope(latch_error_um; touch)", "1 .. 3")
    assert judge_statistic(metric, [sample("a", [1.0, 3.0, 5.0])]).value == pytest.approx(2.0)


def test_bias_is_the_mean_difference_from_the_truth() -> None:
    runs = [sample("a", [1.1, 2.2, 3.0], sides=[1.0, 2.0, 3.0])]
    found = judge_statistic(asked("bias(latch_mm; contact_mm)"), runs)
    assert found.value == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("metric", "condition", "n", "words"),
    [
        ("drift_p", "> 0.05", 3, "at least, whatever they are; 5 values can go beyond the limit"),
        ("drift_p", "> 0.05", 4, "the p-value of 4 values is 0.08333 at least"),
        ("drift_p", "> 0.05", 5, ""),
        ("drift_p", "< 0.001", 6, "7 values can go beyond the limit"),
        ("drift_p", "0.01 .. 0.5", 5, "6 values"),
        ("drift_p", "> 0", 3, ""),
        ("normality_p", "> 0.001", 4, "the p-value of 4 values is 0.001241 at least"),
        ("normality_p", "> 0.01", 4, ""),
        ("outlier", "<= 1", 3, ""),  # 1.0003 is above 1
        ("outlier", "<= 1.01", 3, "the ratio of 3 values is 1 at most"),
        ("outlier", "<= 1.01", 4, ""),
        ("first_sample", "<= 1", 3, ""),
    ],
)
def test_a_limit_that_so_few_values_cannot_get_to_decides_nothing(
    metric: str, condition: str, n: int, words: str
) -> None:
    """Of n values in a row upwards: the strongest drift that there is."""
    values = [1.0, 2.0, 3.1, 4.3, 5.2, 6.6, 7.7][:n]
    found = judge_statistic(asked(f"{metric}(latch_error_um)", condition), [sample("a", values)])
    assert (found.value is None) == bool(words)
    assert words in found.note
    if words:
        assert found.verdict is Verdict.INCONCLUSIVE


def test_few_values_of_a_study_or_a_share_are_no_proof() -> None:
    """Repeats of 0.1 um in a study of 8 values: s is known to 0.27 only; a share of 4 to 0.9."""
    runs = [
        sample(
            f"{a}{b}",
            [10.0 * a + b, 10.0 * a + b + 0.1 * (-1) ** (a + b)],
            **{"plc:V.E.A": str(a), "plc:V.E.B": str(b)},
        )
        for a in range(2)
        for b in range(2)
    ]
    words = "(latch_mm; plc:V.E.A; plc:V.E.B)"
    for metric in ("repeatability", "grr", "reproducibility"):
        found = judge_statistic(asked(f"{metric}{words}", "<= 1.1"), runs)
        assert found.value is not None
        assert found.uncertainty > 0.1
        assert "95 %" in found.note
    found = judge_statistic(asked(f"repeatability{words}", "<= 0.15"), runs)
    assert found.verdict is Verdict.INCONCLUSIVE
    few = [sample(f"{a}", [1.0 + a, 2.0 + a], **{"plc:V.E.A": str(a)}) for a in range(2)]
    share = judge_statistic(asked("share(latch_mm; plc:V.E.A)", ">= 0.4"), few)
    assert share.value == pytest.approx(0.5)
    assert share.verdict is Verdict.INCONCLUSIVE


def test_shares_and_studies_group_by_columns() -> None:
    """y = 3 a + 4 b: shares 9 / 25, 16 / 25; with repeats a study without any spread of them."""
    runs = [
        sample(f"{a}{b}", [3.0 * a + 4.0 * b] * 2, **{"plc:V.E.A": str(a), "plc:V.E.B": str(b)})
        for a in range(5)
        for b in range(5)
    ]
    share = judge_statistic(asked("share(latch_mm; plc:V.E.A)", "0 .. 1"), runs)
    assert share.value == pytest.approx(9 / 25)
    words = "(latch_mm; plc:V.E.A; plc:V.E.B)"
    found = {
        name: judge_statistic(asked(f"{name}{words}", "0 .. 99"), runs).value
        for name in ("repeatability", "reproducibility", "grr")
    }
    operator = 4.0 * stats.tstd(range(5))
    assert found == {
        "repeatability": pytest.approx(0.0, abs=1e-9),
        "reproducibility": pytest.approx(operator),
        "grr": pytest.approx(operator),
    }
    part = judge_statistic(asked(f"repeatability{words}", "<= 1"), runs[:-1])
    assert part.verdict is Verdict.INCONCLUSIVE
    assert "not balanced" in part.note


# Touches of one program


def touches(errors_um: Sequence[float]) -> Observed:
    """A program that touches the place 1 mm in Z once each 10 ms, with these errors."""
    runs = tuple(
        MeasurementRun(
            ("Z",),
            inputs={"Z": 1},
            begin_ns=10 * number * MS,
            signal_ns=(10 * number + 6) * MS,
            end_ns=(10 * number + 8) * MS,
            latched_mm={"Z": 1.0 + error / 1e3},
        )
        for number, error in enumerate(errors_um)
    )
    contacts = tuple(
        Contact((10 * number + 5) * MS, {"z": 1.0}) for number in range(len(errors_um))
    )
    rows = 10 * len(errors_um)
    table = pa.table(
        {
            "time_ns": np.arange(rows, dtype=np.int64) * MS,
            "Z.truth_mm": np.linspace(0.0, 1.0, rows),
            "Z.velocity_mm_s": np.zeros(rows),
        }
    )
    axis = AxisRecord("can1", 1, 10_000.0, plant="z", signals={"probe_1": "probe"})
    left = facts(
        runs=runs,
        axes={"Z": axis},
        probes={"probe": ProbeRecord(True, 1.0, contacts=contacts)},
        end_ns=rows * MS,
    )
    return Observed(left, kept(table))


def values_of(observed: Observed, metric: str) -> list[object]:
    def observe(part: Observed, check: Check) -> Observation:
        (found,) = judged(part, [replace(check)])[1]
        return Observation(found.value, found.uncertainty, found.note)

    return [reading.metric.value for reading in readings(observed, asked(metric), observe)]


def test_a_metric_of_a_measurement_run_is_asked_of_each_of_them() -> None:
    observed = touches(VALUES)
    for metric in ("mean(latch_error_um)", "mean(latch_error_um:Z)"):
        assert values_of(observed, metric) == pytest.approx(list(VALUES), abs=1e-9)
    assert values_of(observed, "mean(latch_error_um; last)") == pytest.approx([VALUES[-1]])
    assert len(values_of(observed, "mean(duration_s)")) == 1


@pytest.mark.parametrize(("axis", "ends_ns"), [("Z", [1, 2, 3]), ("Z2", [1, 3]), ("X", [2, 3])])
def test_a_stop_counts_for_every_axis_that_takes_part_in_it(axis: str, ends_ns: list[int]) -> None:
    """Z measures in each; its slave is held in the first and the last, X from the second on."""
    taking_part = ("Z", "Z2"), ("Z", "X"), ("Z", "X", "Z2")
    runs = tuple(
        MeasurementRun(("Z",), inputs={"Z": 1}, end_ns=end_ns, fixed_stop=FixedStop({}, axes=axes))
        for end_ns, axes in enumerate(taking_part, start=1)
    )
    observed = Observed(facts(runs=runs), kept(pa.table({"time_ns": np.arange(4) * MS})))

    def last(part: Observed, _check: Check) -> Observation:
        return Observation(part.facts.runs[-1].end_ns)

    found = readings(observed, asked(f"mean(stop_force_n:{axis})"), last)
    assert [reading.metric.value for reading in found] == ends_ns
    assert [reading.touch for reading in found] == list(range(1, len(ends_ns) + 1))


def test_of_a_series_of_stops_each_is_looked_at_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not every one before it once more: 50 stops would cost as much as 1275."""
    made: list[int] = []

    def look(_observed: Observed, number: int, _record: MeasurementRun) -> SimpleNamespace:
        made.append(number)
        return SimpleNamespace(earliest_contact=None)

    monkeypatch.setattr(stops, "_made", look)
    observed = touches(VALUES)
    runs = tuple(replace(run, fixed_stop=FixedStop({})) for run in observed.facts.runs)
    observed = Observed(replace(observed.facts, runs=runs), observed.series)
    assert values_of(observed, "mean(latch_mm)") == [1.0 + value / 1e3 for value in VALUES]
    assert made == list(range(1, len(VALUES) + 1))


def test_statistics_of_one_run_are_judged_with_its_checks() -> None:
    checks = [
        parse_any_check("latch_error_um", "0.19 .. 0.21", "here"),
        asked("mean(latch_error_um)"),
        asked("range(latch_error_um)", "<= 0.65"),
    ]
    verdict, found = judged(touches(VALUES), checks)
    assert verdict is Verdict.PASS
    by_name: dict[str, CheckResult] = {item.check.metric: item for item in found}
    assert by_name["mean(latch_error_um)"].value == pytest.approx(np.mean(VALUES))
    assert by_name["range(latch_error_um)"].value == pytest.approx(0.6)
    assert by_name["range(latch_error_um)"].verdict is Verdict.PASS
