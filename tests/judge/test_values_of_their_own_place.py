"""Metrics of the user, of other topics, of blocks and of a program that has begun: each its own."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.judge import test_tool_recording as tool
from tests.judge.test_own_metrics import MS, _case
from tests.judge.test_program import PLACE_MM, ROWS, alarm, driven, peaks, recorded, seen
from tests.judge.test_statistics_summary import rows
from tests.recordings import kept

from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.topic import Topic
from axisrig.bench.judge.run_findings import of_facts
from axisrig.bench.judge.statistics.summary import statistics_data
from axisrig.bench.judge.topics import TOPICS, judged, observe
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.series import SeriesWriter

# Metrics of the user


def own(value: str) -> str:
    return f"def metric_width(recording):\n    return {value}, 'mm', 0.125\n"


def test_a_file_that_was_changed_meanwhile_counts_as_it_is_now(tmp_path: Path) -> None:
    """Also where it has the same name; and as it was before when it is put back."""
    recording = recorded()
    for value in (1.5, 2.5, 1.5):
        case = _case(tmp_path, own(str(value)), "check:width", "> 0")
        assert case.module is not None
        _, (result, *_) = judged(recording, case.checks, module=case.module)
        assert (result.value, result.uncertainty) == (value, 0.125)
        found = observe(recording, case.checks[0], module=case.module)
        assert (found.value, found.uncertainty) == (value, 0.125)


def test_what_fails_outside_of_the_file_is_named_without_a_line(tmp_path: Path) -> None:
    """The function is gone since the plan was read: no line of the file has led to that."""
    recording, case = recorded(), _case(tmp_path, own("1.5"), "check:width", "> 0")
    assert case.module is not None
    (tmp_path / "own.py").write_text("def metric_other(recording):\n    return 1.0, '', 0.0\n")
    _, (result, *_) = judged(recording, case.checks, module=case.module)
    assert result.verdict is Verdict.ERROR
    assert result.note == f"{case.module.name}: KeyError: 'metric_width'"
    (tmp_path / "own.py").write_text("\n\ndef metric_width(recording):\n    return 1 / 0\n")
    _, (result, *_) = judged(recording, case.checks, module=case.module)
    assert result.note.startswith(f"{case.module.name}:4: ZeroDivisionError: ")


# Topics


def test_checks_are_judged_by_the_topics_that_are_given() -> None:
    """One topic in the place of all: its metric has another value, and no mark is another's."""
    mine = Topic("mine", {"duration_s": lambda _o, _a: Observation(42.0, 0.5)}, lambda _: [])
    observed = recorded(start_ns=0)
    check = parse_check("duration_s", "40 .. 44", "")
    for topics, value, verdict in (
        ((mine,), 42.0, Verdict.PASS), ((mine, *TOPICS), 42.0, Verdict.PASS),
        (TOPICS, 0.019, Verdict.FAIL),
    ):  # fmt: skip
        found, (result,) = judged(observed, [check], topics)
        assert (found, result.value) == (verdict, pytest.approx(value))


def test_all_alarms_of_a_run_are_among_its_findings() -> None:
    given = (alarm(3, 1, ends=False), alarm(2, 5), alarm(9, 6, further=True))
    assert list(of_facts(recorded(alarms=given).facts).alarms) == list(given)


# A program that has begun


@pytest.mark.parametrize("start_row", [0, 3, 8])
@pytest.mark.parametrize("metric", ["set_acceleration_mm_s2_max:Z", "set_jerk_mm_s3_max:Z"])
def test_what_the_set_positions_did_before_the_drives_were_on_counts_nowhere(
    metric: str, start_row: int
) -> None:
    """A step of 1 mm at row 4, taken over before the drives are enabled; 0.01 mm at row 14."""
    k = np.arange(ROWS)
    set_mm = np.where(k >= 4, 1.0, 0.0) + np.where(k >= 14, 0.01, 0.0)
    found = seen(recorded({"Z.set_mm": set_mm}, start_ns=start_row * MS), metric)
    step_mm = 1.0 if start_row <= 4 else 0.01
    order = 2 if "acceleration" in metric else 3
    factor = 1.0 if order == 2 else 2.0  # third differences of a step: 1, -2, 1
    assert found.value == pytest.approx(factor * step_mm * 1e3**order)


@pytest.mark.parametrize("row", [5, 9, 10, 11, 13])
@pytest.mark.parametrize("size", [1, 9, 10, 11, 12])
def test_the_doubt_of_a_lag_is_the_same_wherever_a_block_ends(
    row: int, size: int, tmp_path: Path
) -> None:
    """An encoder that is off around the largest lag, in row 10."""
    actual = PLACE_MM.copy()
    actual[row] += 0.016
    whole = driven(peaks((10, 0.5)), actual)
    table, writer = whole.series.table(), SeriesWriter(tmp_path / "a.parquet")
    for part in (table.slice(0, size), table.slice(size)):
        writer.add({name: part[name].combine_chunks() for name in part.column_names})
    parts = Observed(whole.facts, writer.close())
    one, other = (seen(each, "drive_lag_mm_max:Z") for each in (whole, parts))
    assert (other.value, other.note) == (one.value, one.note)
    assert other.uncertainty == pytest.approx(one.uncertainty)


@pytest.mark.parametrize(("x_mm", "speed_mm_s"), [(0.0, 70.0), (0.024, 74.0), (-0.24, 250.0)])
def test_a_contact_is_as_uncertain_as_the_tool_is_fast_in_all_its_coordinates(
    x_mm: float, speed_mm_s: float
) -> None:
    """0.07 mm along Y in the step before it, and something along X: sqrt(x^2 + y^2) in 1 ms."""
    row = tool.ON + 50
    of = tool.measured(dict.fromkeys(tool.AXES, 0.0)).facts
    table = tool.changed(tool.trace(), {"Y.truth_mm": {row: 0.02}, "X.truth_mm": {row: x_mm}})
    found = tool.seen(Observed(of, kept(table)), "tcp_latch_error_um")
    assert found.uncertainty == pytest.approx(speed_mm_s * 1e3 * (tool.INSTANT_NS + 20.0) * 1e-9)


# Statistics


@pytest.mark.parametrize("metrics", [("latch_mm:X", "latch_mm:Z"), ("latch_mm", "latch_mm:Z")])
def test_the_same_metric_of_two_axes_has_its_own_statistics(metrics: Sequence[str]) -> None:
    checks: list[dict[str, str]] = []
    for place, metric in enumerate(metrics):
        of_axis, cases = rows([10.0 * place + n for n in range(4)])
        checks += [{**row, "metric": metric, "unit": f"u{place}"} for row in of_axis]
    found = {entry.metric: entry for entry in statistics_data(checks, cases)}
    assert list(found) == list(metrics)
    for place, metric in enumerate(metrics):
        mean: Any = found[metric].found.mean
        assert mean.value == pytest.approx(10.0 * place + 1.5)
        assert (found[metric].unit, found[metric].found.n) == (f"u{place}", 4)


def test_a_case_keeps_to_its_own_plan() -> None:
    """Two plans have a case of the same name."""
    checks, cases = rows([1.0, 2.0, 3.0, 4.0])
    other = [{**row, "plan": "q", "run": row["run"].replace("p-", "q-")} for row in cases]
    of_other = [
        {**row, "plan": "q", "run": row["run"].replace("p-", "q-"), "value": "7.0"}
        for row in checks
    ]
    found = statistics_data([*checks, *of_other], [*cases, *other])
    assert [(entry.plan, entry.found.n) for entry in found] == [("p", 4), ("q", 4)]
    assert replace(found[0], plan="q") != found[1]
