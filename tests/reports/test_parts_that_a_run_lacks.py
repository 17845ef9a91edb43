"""What the page shows where a part of a run is missing: signals, criteria, values, one of two."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.reports import tilted
from tests.reports.short_stops import at, during, stop
from tests.reports.short_stops import trace as rows_of_a_stop
from tests.reports.test_signals_of_distance import CONST, ON, STATE, control, part, shown
from tests.reports.test_signals_of_distance import trace as rows_of_a_control
from tests.reports.test_statistics_section import drawn, lines
from tests.reports.test_ways_of_failing import cards, check, run, text
from tests.reports.test_words_of_a_stop import answers_of

from axisrig.bench.judge.fixed_stop.stop_findings import Decision
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.reports.distance.signals import with_surfaces
from axisrig.reports.kinematics.motion import motion_of, moved_mm
from axisrig.reports.kinematics.section import sections, source_words
from axisrig.reports.kinematics.signals import with_signals
from axisrig.reports.parts.topic import Plots, ReportTopic
from axisrig.reports.statistics.section import statistics_views

# The tool of a kinematic

ECS = tilted.trace()
TOOL = tilted.tool(ECS, tilted.left())


def moved_in_time(trace: pa.Table, by_ms: int) -> pa.Table:
    times = trace.column("time_ns").to_numpy() + by_ms * tilted.MS
    return trace.set_column(0, "time_ns", pa.array(times))


@pytest.mark.parametrize("by_ms", [-10_000, 10_000])
@pytest.mark.parametrize("sensor", [TOOL.sensor, None])
def test_signals_outside_the_time_of_a_kinematic_show_no_tool(
    by_ms: int, sensor: str | None
) -> None:
    """As of a recording that was cut: nothing is drawn, and nothing was moved."""
    tool = replace(TOOL, sensor=sensor)
    other = moved_in_time(ECS, by_ms)
    assert motion_of(other, tool) is None
    assert np.isnan(moved_mm(other, tool)).all()
    (found,) = sections(RunFindings(of_topics=[tool]), other, "a", {})
    assert (found["scene"], found["rows"], found["has_surface"]) == (None, [], False)
    assert found["source"] == source_words(tool, None) == "The run left no signals of the tool."
    if sensor is None:
        names = with_signals(other, RunFindings(of_topics=[tool])).column_names
        assert not {"channel.tilt_true_deg", "channel.tool_length_true_mm"} & set(names)


@pytest.mark.parametrize("missing", ["gap.tilt_deg", "gap.clamping_x_mm", "gap.along_mm"])
def test_a_signal_of_the_tool_that_has_to_be_there_is_named(missing: str) -> None:
    with pytest.raises(LookupError, match=missing):
        motion_of(ECS.drop_columns([missing]), TOOL)


def test_of_two_stretches_of_a_kinematic_one_may_have_no_row() -> None:
    """What the other one moved is there, and outside of both there is nothing."""
    (stretch,) = TOOL.kinematics
    later = replace(stretch.record, begin_ns=10_000 * tilted.MS, end_ns=11_000 * tilted.MS)
    both = [stretch, replace(stretch, record=later, end_ns=11_000 * tilted.MS)]
    for order in (both, both[::-1]):
        tool = replace(TOOL, kinematics=order)
        assert moved_mm(ECS, tool) == pytest.approx(moved_mm(ECS, TOOL), nan_ok=True)
        found, alone = motion_of(ECS, tool), motion_of(ECS, TOOL)
        assert found is not None
        assert alone is not None
        assert found.times_ns.tolist() == alone.times_ns.tolist()


def test_without_an_offset_the_tool_is_not_moved() -> None:
    """0 while the kinematic is on, nothing before; without its signal nothing at all."""
    still = tilted.trace(offset_mm=0.0)
    moved = moved_mm(still, TOOL)
    assert np.isnan(moved[: tilted.KINEMATIC]).all()
    assert (moved[tilted.KINEMATIC : tilted.OFF] == 0.0).all()
    assert np.isnan(moved_mm(ECS.drop_columns(["channel.offset_mm"]), TOOL)).all()


# Runs to a fixed stop


def test_a_stop_without_a_known_criterion_has_no_reason() -> None:
    found = answers_of(stop(decided_by=None))
    assert "why here" not in found
    assert found["real stop"]


@pytest.mark.parametrize("criterion", ["lag", "window"])
def test_of_an_axis_without_limits_the_criterion_alone_is_named(criterion: str) -> None:
    found = stop(decided_by=Decision("Z", criterion), limits={})
    assert answers_of(found)["why here"] == f"Z: {criterion}"


@pytest.mark.parametrize(
    ("lag_mm", "force_n", "words"),
    [
        (0.25, 40.0, "lag 0.25 mm, 40 N"), (None, 40.0, "40 N"), (0.25, None, "lag 0.25 mm"),
        (-0.05, -40.0, "lag 50 µm, -40 N"), (None, None, None),
    ],
)  # fmt: skip
def test_what_is_left_after_relaxing_is_what_is_known(
    lag_mm: float | None, force_n: float | None, words: str | None
) -> None:
    """At the end of its motion: from 190 ms on, as long as the signals go."""
    known = {"cnc_lag_mm": lag_mm, "stop_force_n": force_n}
    columns = {f"Z__{name}": during(value, 190, 299) for name, value in known.items()
               if value is not None}  # fmt: skip
    signals = {"Z": {name: f"Z.{name}" for name, value in known.items() if value is not None}}
    found = stop(at("relax_end", 195, "Z"), at("end", 198), signals=signals)
    assert answers_of(found, rows_of_a_stop(**columns)).get("left after relaxing") == words


# Distance control


def test_the_gap_is_shown_without_a_truth_of_the_axis_and_the_surface_is_not() -> None:
    table = rows_of_a_control(Z__distance_state=STATE, gap__distance_true_mm=[8, 9, 10])
    found = with_surfaces(table, [control(part(0, 9, ON), part(9, 20, CONST), zero_mm=3.0)])
    assert shown(found, "Z.gap_true_mm") == [5, 6, 7]
    assert "Z.surface_truth_mm" not in found.column_names


def test_without_set_pos_what_is_filtered_is_a_distance_alone() -> None:
    table = rows_of_a_control(Z__distance_state=STATE, Z__filtered_mm=[1, 2, 3])
    found = with_surfaces(table, [control(part(0, 9, ON), part(9, 20, CONST))])
    assert shown(found, "Z.filtered_distance_mm") == pytest.approx([np.nan, np.nan, 3], nan_ok=True)
    assert "Z.filtered_surface_mm" not in found.column_names


# Failures and samples


def test_runs_without_a_value_have_the_sentence_of_the_one_that_is_shown() -> None:
    """They ended before they were judged: there is nothing that they have in common in numbers."""
    runs = [run(name, check("", "error", note="no plant")) for name in "ab"]
    (card,) = cards(*runs)
    assert card["count"]
    assert (card["sentence"], card["worst"]) == (f"sentence of {card['id']}", "")
    assert card["besides"] == ""


def test_values_that_are_words_have_no_worst_one() -> None:
    (card,) = cards(run("a", text("OFF")), run("b", text("OFF")))
    assert card["worst"] == ""
    assert card["sentence"] != f"sentence of {card['id']}"
    assert "OFF" in card["sentence"]


@pytest.mark.parametrize(("values", "is_drawn"), [((0.4,), False), ((0.4, 0.5), False),
                                                  ((0.4, 0.5, 0.7), True)])  # fmt: skip
def test_a_sample_is_drawn_from_three_values_on(values: tuple[float, ...], is_drawn: bool) -> None:
    assert [lines(svg, "st-limit") for svg in drawn(values, -1.0, 1.0)] == (
        [2, 2, 0] if is_drawn else []
    )


def test_runs_that_left_no_facts_or_no_signals_are_no_part_of_a_sample() -> None:
    def member(name: str) -> Any:
        case = {"plan": "p", "case": "c", "frame_log_sha256": name}
        return SimpleNamespace(run=name, case=case, checks=[], is_statistic=False,
                               judged_facts=None, trace=None)  # fmt: skip

    asked = SimpleNamespace(metric="mean(latch_mm:Z)", asked="<= 9", reference="here", lower="",
                            upper="")  # fmt: skip
    row = SimpleNamespace(
        run="p-c", case={"plan": "p", "case": "c"}, checks=[asked], is_statistic=True
    )
    results: Any = SimpleNamespace(planned=[member("a"), member("b"), row])
    assert list(statistics_views(results)) == []


def test_a_topic_that_only_has_a_section_leaves_signals_and_plots_alone() -> None:
    topic = ReportTopic("own", "own.package", lambda *_: [])
    assert topic.with_signals(ECS, RunFindings()) is ECS
    assert topic.plots(ECS, RunFindings()) == Plots()
