"""What a statistic takes beside its metric: the numbers of runs and touches, inputs, doubts."""

from collections.abc import Mapping, Sequence

import pytest

from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.statistics.summary import statistics_data
from axisrig.bench.judge.statistics.verdict import Reading, RunSample, judge_statistic
from axisrig.bench.plan.checks import CheckResult
from axisrig.bench.plan.statistic_checks import StatisticCheck, parse_any_check

METRIC = "latch_error_um"
FEED, LOAD = "plc:V.E.FEED", "plant:z.load"


def asked(statistic: str, samples: Sequence[RunSample]) -> CheckResult:
    check = parse_any_check(statistic, "-1e6 .. 1e6", "here")
    assert isinstance(check, StatisticCheck)
    return judge_statistic(check, samples)


def run_of(
    name: str,
    values: Sequence[float],
    frames: str = "",
    inputs: Mapping[str, str] | None = None,
    sides: Sequence[Observation] = (),
    u: float = 0.0,
) -> RunSample:
    found = [
        Reading(number, Observation(value, u), tuple(sides[number - 1 : number]))
        for number, value in enumerate(values, start=1)
    ]
    return RunSample(name, tuple(found), inputs=inputs or {}, frames=frames or name)


def test_a_run_keeps_its_number_behind_one_that_does_not_count() -> None:
    """0 in run 1, which run 2 repeats, 4 in run 3 and 6 in run 4: y = 2 x - 2."""
    runs = [run_of("a", [0.0]), run_of("b", [0.0], frames="a"), run_of("c", [4.0]),
            run_of("d", [6.0])]  # fmt: skip
    assert asked(f"slope({METRIC}; run)", runs).value == pytest.approx(2.0)
    assert asked(f"intercept({METRIC}; run)", runs).value == pytest.approx(-2.0)


def test_all_touches_of_a_run_have_its_number() -> None:
    """10 and 12 in run 1, 13 in run 2, 15 and 17 in run 3.

    Over the runs the sums are 2 (16 - 11) = 10 of 4; touch 1 has 10, 13, 15, touch 2 12 and 17.
    """
    runs = [run_of("a", [10.0, 12.0]), run_of("b", [13.0]), run_of("c", [15.0, 17.0])]
    assert asked(f"slope({METRIC}; run)", runs).value == pytest.approx(2.5)
    # (12 + 17)/2 less (10 + 13 + 15)/3
    assert asked(f"slope({METRIC}; touch)", runs).value == pytest.approx(14.5 - 38.0 / 3.0)


def test_an_input_is_that_of_its_own_run() -> None:
    """Two inputs that differ: y = 3 FEED + 1, while LOAD goes the other way."""
    runs = [
        run_of(str(feed), [3.0 * feed + 1.0], inputs={FEED: str(feed), LOAD: str(9 - feed)})
        for feed in (5, 1, 2)
    ]
    for column, slope, at_0 in ((FEED, 3.0, 1.0), (LOAD, -3.0, 28.0)):
        assert asked(f"slope({METRIC}; {column})", runs).value == pytest.approx(slope)
        assert asked(f"intercept({METRIC}; {column})", runs).value == pytest.approx(at_0)


@pytest.mark.parametrize("place", [0, 1, 2])
def test_the_largest_doubt_counts_wherever_it_is(place: int) -> None:
    """Of the values and of the truth beside them: 0.3 and 0.5 against 0.1."""
    doubts, of_truth = [0.1] * 3, [0.1] * 3
    doubts[place], of_truth[place - 1] = 0.3, 0.5
    runs = [
        run_of(name, [4.0], sides=[Observation(3.0, beside)], u=u)
        for name, u, beside in zip("abc", doubts, of_truth, strict=True)
    ]
    found = asked(f"bias({METRIC}; {METRIC})", runs)
    assert (found.value, found.uncertainty) == (1.0, pytest.approx(0.8))


def test_an_open_limit_and_one_at_zero_are_written() -> None:
    runs = [run_of("a", [1.0, 3.0])]
    assert "limits 0 .. open; 95 %" in asked(f"cpk({METRIC}; >= 0)", runs).note
    assert "limits open .. 0; 95 %" in asked(f"cpk({METRIC}; <= 0)", runs).note
    assert "limits 0 .. 4; 95 %" in asked(f"cp({METRIC}; 0 .. 4)", runs).note


def test_a_case_of_two_runs_of_which_one_alone_has_the_metric() -> None:
    """The other one is named as missing: its rows ended before this one."""
    cases = [{"plan": "p", "case": "a", "run": run, "frame_log_sha256": run} for run in "xy"]
    checks = [
        {"run": "x", "metric": METRIC, "unit": "um", "value": "1.5", "verdict": "pass"},
        {"run": "x", "metric": "latch_mm", "unit": "mm", "value": "2", "verdict": "pass"},
        {"run": "y", "metric": "latch_mm", "unit": "mm", "value": "3", "verdict": "pass"},
    ]
    found = {entry.metric: entry for entry in statistics_data(checks, cases)}
    assert list(found) == [METRIC, "latch_mm"]
    assert found[METRIC].found.values == [("x", 1.5)]
    assert found[METRIC].missing == ["y"]
    assert (found["latch_mm"].missing, found["latch_mm"].unit) == ([], "mm")
    assert statistics_data(checks[:1], cases[:1]) == []
