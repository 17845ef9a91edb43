"""Timelines of runs to a fixed stop: what they show, in words, instants and drawings."""

import re
import shutil
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from tests.reports.formulas import made, write_runs
from tests.reports.pages import opened, whole
from tests.reports.stops import (
    BEGIN,
    CONTACT,
    FORCE,
    MS,
    PENETRATION,
    STOP,
    Sample,
    V,
    info,
    samples,
    stop,
    trace,
)
from tests.reports.test_report import Page

from axisrig.bench.judge.fixed_stop.stop_findings import BrokenContact
from axisrig.bench.judge.observed.event import Event
from axisrig.kernel.errors import UserError
from axisrig.reports.build import build_report
from axisrig.reports.fixed_stop.section import sections
from axisrig.reports.fixed_stop.signals import stops_of, with_changes
from axisrig.reports.fixed_stop.timeline import HEIGHT, Row, Span, axis, lane, span_of
from axisrig.reports.signals import chart

ALARMS = {"ID 900034": "Drive of axis Z is in fault"}
SAMPLES = {sample.name: sample for sample in samples()}
FINDINGS = {name: info(sample) for name, sample in SAMPLES.items()}


def shown(name: str) -> dict[str, Any]:
    """The last timeline of a case."""
    sample = SAMPLES[name]
    return sections(info(sample), trace(sample), name, ALARMS)[-1]


def answers(name: str) -> Mapping[str, str]:
    return dict(shown(name)["answers"])


def row(name: str, key: str) -> Mapping[str, Any]:
    return next(row for row in shown(name)["rows"] if row["key"] == key)


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("found-by-lag", "stop found"),
        ("found-by-window", "stop found"),
        ("found-by-a-gantry-slave", "stop found"),
        ("moving-stop", "stop found"),
        ("on-a-real-bus", "stop found"),
        ("false-trigger", "false trigger"),
        ("contact-after-a-false-trigger", "false trigger"),
        ("not-found", "no stop found"),
        ("drive-fault", "ended by Z: fault reaction active"),
    ],
)
def test_how_a_run_ended_is_the_first_thing_told(name: str, word: str) -> None:
    assert shown(name)["word"] == word


def test_why_here_names_axis_criteria_and_the_later_one() -> None:
    assert answers("found-by-lag")["why here"] == "Z: lag above 1 mm for 100 ms"
    assert answers("found-by-window")["why here"] == "Z: moved no more than 1 µm in 100 ms"
    both = answers("found-by-both")["why here"]
    assert both.endswith("and moved no more than 1 µm in 100 ms; the lag came last")
    assert answers("found-by-a-gantry-slave")["why here"].startswith("Z2: ")


def test_an_alarm_after_the_detection_is_told_beside_it() -> None:
    sample = Sample("late", trouble=(("alarm", "ID 900034"),))
    (found,) = sections(info(sample), trace(sample), "late", ALARMS)
    assert found["word"] == "stop found, then ID 900034"
    assert dict(found["answers"])["ended by"] == "ID 900034: Drive of axis Z is in fault"


def test_a_real_stop_is_told_from_a_false_trigger_by_the_plant_alone() -> None:
    """Contact at 1500 ms; the lag needs (1 - 0.25 + 0.025)/10 s + 100 ms = 177.5 ms more."""
    assert answers("found-by-lag")["real stop"] == "yes: in contact for 177.6 ms when detected"
    assert answers("false-trigger")["real stop"] == "no: nothing was touched"
    later = answers("contact-after-a-false-trigger")["real stop"]
    assert later == "no: contact came 9.4 ms after the detection"
    assert answers("on-a-real-bus")["real stop"] == "not known: no plant gives a contact"


@pytest.mark.parametrize(
    ("since_ms", "word", "answer"),
    [
        (1600, "stop found", "yes: in contact for 77.6 ms when detected"),
        (None, "false trigger", "no: Z had lost its contact when detected"),
    ],
)
def test_a_contact_that_was_lost_counts_from_its_return(
    since_ms: int | None, word: str, answer: str
) -> None:
    """First contact at 1500 ms, detected at 1677.6 ms, apart for 60 ms of them."""
    sample = SAMPLES["found-by-lag"]
    since_ns = None if since_ms is None else since_ms * MS
    broken = info(sample, broken_contacts={"Z": BrokenContact(1500 * MS, since_ns, 60 * MS)})
    (found,) = sections(broken, trace(sample), "x", {})
    lost = "; first contact 177.6 ms before, lost for 60 ms"
    assert dict(found["answers"])["real stop"] == answer + lost
    assert found["word"] == word


def test_plots_open_with_the_axis_of_the_run_that_is_open() -> None:
    """X has an event and a run before; the last run is that of Z."""
    found = info(SAMPLES["three-runs"])
    found = replace(found, events=[Event(0, "mark", "X: homed", "X"), *found.events])
    signals = trace(SAMPLES["three-runs"])
    signals = signals.append_column("X.actual_mm", signals.column("Z.actual_mm"))
    assert chart(signals, found)[0]["axis"] == "Z"


def test_a_contact_of_another_axis_names_it() -> None:
    """The master of a gantry lags behind while its slave stands at a stop."""
    sample = SAMPLES["found-by-lag"]
    marks = [replace(m, axis="Z2") if m.key == "contact" else m for m in stop(sample).marks]
    (found,) = sections(info(sample, marks=marks), trace(sample), "x", {})
    assert dict(found["answers"])["real stop"].startswith("yes: Z2 in contact for 177.6 ms")


def test_what_was_missing_shows_lag_and_way_beside_their_limits() -> None:
    """In free motion the lag is 0.25 mm; 10 mm/s for 100 ms are 1 mm."""
    missing = answers("not-found")["what was missing"]
    assert "largest lag 0.25 mm of 1 mm" in missing
    assert "window 1 µm" in missing
    short = answers("stop-too-far-for-the-time")["what was missing"]
    assert re.search(r"above it for 7\d of 200 ms", short)
    assert "armed after 5 mm" in answers("never-armed")["what was missing"]
    assert answers("drive-fault")["ended by"] == (
        "Z: fault reaction active; ID 900034: Drive of axis Z is in fault"
    )


def test_the_longest_time_beyond_the_limit_is_told_not_the_last_or_the_sum() -> None:
    """Beyond for 40 ms, below for 20, beyond for 10."""
    sample = SAMPLES["stop-too-far-for-the-time"]
    signals = trace(sample)
    first = int(BEGIN / MS) + 200
    lag = np.full(signals.num_rows, 0.25)
    lag[first : first + 41] = 1.2
    lag[first + 60 : first + 71] = -1.2
    place = signals.column_names.index("Z.cnc_lag_mm")
    signals = signals.set_column(place, "Z.cnc_lag_mm", pa.array(lag))
    (found,) = sections(info(sample), signals, sample.name, ALARMS)
    missing = dict(found["answers"])["what was missing"]
    assert "largest lag 1.2 mm of 1 mm, above it for 40 of 200 ms" in missing


def test_how_hard_it_pressed_and_what_was_left() -> None:
    assert answers("found-by-lag")["pressed with"] == "at most 505 N, 498.2 N at the end"
    assert answers("found-by-lag")["left after relaxing"] == "lag 0 µm, 500 N"
    assert answers("not-found")["pressed with"] == "nothing: no force at the stop"
    assert answers("on-a-real-bus")["pressed with"] == "not known: no plant gives the force"
    assert re.match(r"at most [\d.]+ N", answers("drive-fault")["pressed with"])


def test_instants_count_from_the_contact_beside_the_closed_form() -> None:
    beyond = row("found-by-lag", "beyond")
    assert (beyond["at"], beyond["form"], beyond["apart"]) == ("77.60", "77.50", "+0.10")
    assert beyond["is_inside"]
    assert row("found-by-lag", "contact")["at"] == "0.00"
    assert row("found-by-lag", "armed")["at"] == "-945.00"
    assert shown("false-trigger")["origin"] == "begin"
    assert row("false-trigger", "begin")["at"] == "0.00"


def test_what_never_came_keeps_the_place_where_it_was_expected() -> None:
    never = row("drive-fault", "detected")
    assert (never["at"], never["form"], never["apart"]) == ("never", "177.50", "")
    assert "tl-band" in never["lane"]
    assert "tl-mark" not in never["lane"]


def test_without_a_closed_form_the_measured_instants_stand_alone() -> None:
    for name in ("no-closed-form", "on-a-real-bus"):
        assert all(row["form"] == "" and row["bar"] == "" for row in shown(name)["rows"])
        assert not any("tl-band" in row["lane"] for row in shown(name)["rows"])
    assert shown("no-closed-form")["notes"] == ("friction is above the torque limit",)
    assert row("on-a-real-bus", "detected")["at"] == "1177.60"


def test_an_instant_outside_its_band_is_marked() -> None:
    late = Sample("late", extra={"late": 20 * MS})
    (found,) = sections(info(late), trace(late), "late", {})
    detected = next(row for row in found["rows"] if row["key"] == "detected")
    assert detected["is_inside"] is False
    assert detected["apart"] == "+20.10"
    assert "v-fail" in detected["bar"]


def test_values_outside_their_bounds_are_marked() -> None:
    sample = SAMPLES["found-by-lag"]
    values = list(stop(sample).values)
    values[1] = replace(values[1], measured=40.03)
    (found,) = sections(info(sample, values=values), trace(sample), "x", {})
    assert [value["is_inside"] for value in found["values"]].count(False) == 1


def test_a_value_on_its_bound_to_the_digits_shown_is_inside() -> None:
    """500.39287786 N with 500.39287785 N allowed; bounds that are one number are no bounds."""
    sample = SAMPLES["found-by-lag"]
    values = list(stop(sample).values)
    values[1] = replace(values[1], low=40.025, high=40.025)
    values[3] = replace(values[3], measured=500.392877864, high=500.392877863)
    (found,) = sections(info(sample, values=values), trace(sample), "x", {})
    assert (found["values"][3]["is_inside"], found["values"][1]["is_inside"]) == (True, None)
    assert found["values"][1]["apart"] == "+0.200 µm"


# Drawing


def places(svg: str, kind: str) -> list[float]:
    return [float(x) for x in re.findall(rf'class="{kind}[^"]*" x1?="([\d.]+)%?"', svg)]


def test_the_lane_puts_an_instant_at_its_share_of_the_width() -> None:
    row = Row("latch", 25.0, "25 ms", stretch=(0.0, 25.0), band=(20.0, 25.0, 30.0))
    svg = lane(Span(0.0, 100.0), row, "g")
    assert places(svg, "tl-mark") == [25.0]
    assert places(svg, "tl-band") == [20.0]
    assert places(svg, "tl-form") == [25.0]
    assert f'y2="{HEIGHT}"' in svg


def test_an_instant_before_the_drawing_is_an_arrow_at_its_end() -> None:
    svg = lane(Span(0.0, 100.0), Row("mark", -900.0, "", band=(-901.0, -900.0, -899.0)), "g")
    assert "tl-arrow" in svg
    assert "tl-band" not in svg


@pytest.mark.parametrize("length", [1e-3, 0.7, 9.99, 10.0, 95.0, 5000.0, 3.6e6])
def test_a_scale_of_any_length_has_some_round_ticks(length: float) -> None:
    for low in (-0.1 * length, 0.0, 12345.6):
        ticks = Span(low, low + length).ticks()
        assert 4 <= len(ticks) <= 11
        assert all(low <= tick <= low + length for tick in ticks)
        assert axis(Span(low, low + length), "g").count("<text") == len(ticks)


def test_a_stretch_of_no_length_still_has_a_scale() -> None:
    assert span_of([5.0, 5.0]).low < 5.0 < span_of([5.0, 5.0]).high


# Signals


def test_the_way_within_the_minimum_time_is_that_of_the_window_criterion() -> None:
    """10 mm/s for 100 ms are 1000 um; before the run and behind it nothing is compared."""
    sample = SAMPLES["found-by-window"]
    table = with_changes(trace(sample), stops_of(info(sample), ["Z.actual_mm"]))
    change = table.column("Z.change_um").to_numpy()
    times = table.column("time_ns").to_numpy()
    assert np.isnan(change[times < BEGIN]).all()
    free = (times > BEGIN + 110 * MS) & (times < CONTACT - MS)
    assert change[free] == pytest.approx(V * 0.1 * 1000.0, abs=0.2)
    assert np.isnan(change[times > sample.end_ns]).all()


def test_plots_show_limits_bands_and_count_from_the_contact() -> None:
    sample = SAMPLES["found-by-both"]
    description, _ = chart(trace(sample), info(sample))
    limits = {(limit["plot"], limit["label"]): limit["value"] for limit in description["limits"]}
    assert limits["lag", "L"] == 0.5
    assert limits["change", "W"] == 1.0
    assert limits["force", "torque limit"] == FORCE
    assert limits["position", "contact at"] == pytest.approx(STOP, abs=PENETRATION)
    assert description["ranges"] == {"change": {"Z": [0.0, 5.0]}}
    first = description["windows"][0]
    assert (first["label"], first["zero"], first["origin_ns"]) == ("fixed stop", "contact", CONTACT)
    assert first["start_ns"] < CONTACT < first["end_ns"]
    assert [plot["plot"] for plot in description["plots"]] == ["position", "lag", "change", "force"]


def test_a_stop_that_the_plant_tells_is_a_line_of_its_own() -> None:
    sample = SAMPLES["moving-stop"]
    description, _ = chart(trace(sample), info(sample))
    labels = [s["label"] for s in description["plots"][0]["series"]["Z"]]
    assert "stop" in labels
    assert not any(limit["plot"] == "position" for limit in description["limits"])


def test_several_runs_have_a_button_each_and_the_last_timeline_open() -> None:
    sample = SAMPLES["three-runs"]
    description, _ = chart(trace(sample), info(sample))
    labels = [window["label"] for window in description["windows"]]
    assert labels == [f"{what} {n}" for n in (1, 2, 3) for what in ("fixed stop", "detection")]
    assert labels[description["opens"]] == "fixed stop 3"
    shown = sections(info(sample), trace(sample), "x", {})
    assert [timeline["number"] for timeline in shown] == [1, 2, 3]


def test_a_run_without_signals_still_has_its_timeline() -> None:
    (found,) = sections(info(SAMPLES["not-found"]), None, "x", {})
    assert dict(found["answers"])["what was missing"] == "Z: lag limit 1 mm, window 1 µm"


# The page


@pytest.mark.long
def test_findings_that_lack_a_value_are_refused_with_their_block(results: Path) -> None:
    lacking = FINDINGS | {"found-by-lag": info(SAMPLES["found-by-lag"], marks=None)}
    with pytest.raises(UserError, match="`fixed_stop` of run stops-found-by-lag cannot be read"):
        build_report(results, findings=made(lacking))


@pytest.mark.long
def test_a_trace_without_its_instants_is_refused(results: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    shutil.copytree(results, other)
    pq.write_table(pa.table({"Z.set_mm": [1.0]}), other / "traces" / "stops-found-by-lag.parquet")
    with pytest.raises(UserError, match="no column time_ns"):
        build_report(other)


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("stops")
    return write_runs(folder, "stops", {name: trace(sample) for name, sample in SAMPLES.items()})


@pytest.mark.long
def test_the_page_holds_a_timeline_per_run_and_stays_the_same(results: Path) -> None:
    """Ids are unique, every drawing has words, nothing comes from outside, few bytes per case."""
    first = build_report(results, findings=made(FINDINGS)).read_bytes()
    assert build_report(results, findings=made(FINDINGS)).read_bytes() == first
    page = Page(whole(first.decode()))
    runs = sum(sample.count for sample in SAMPLES.values())
    assert len([a for a in page.find("section") if a.get("class") == "stop"]) == runs
    ids = [a["id"] for _, a in page.tags if a.get("id")]
    assert len(ids) == len(set(ids))
    assert all(a.get("aria-label") for a in page.find("svg"))
    assert all((a["href"] or "").removeprefix("#") in ids for a in page.find("use"))
    assert len(page.find("caption")) == len(page.find("table"))
    article = opened(first.decode())["stops-found-by-both"].html.split('<div class="body">')[0]
    assert len(article) < 16_000
