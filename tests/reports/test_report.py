"""The page: nothing from outside, nothing unescaped, everything that a reader looks for."""

import csv
import json
import re
import shutil
from collections import Counter
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from tests.recordings import alarm
from tests.reports.pages import whole

from axisrig.bench.judge.observed.event import WARNING, Event
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.record.axes import PlantRecord
from axisrig.bench.record.bus import RealTime
from axisrig.bench.record.facts import AlarmRecord, read_run, run_text
from axisrig.bench.record.measuring import Criteria, FixedStop, MeasurementRun
from axisrig.kernel.errors import Alarm, UserError
from axisrig.reports.build import build_report
from axisrig.reports.parts.bar import WIDTH, bar, scale
from axisrig.reports.parts.shipped import shipped_table
from axisrig.reports.run import alarm_words, event_rows
from axisrig.reports.signals import chart, signals, windows

VOID = {"meta", "link", "input", "br", "img", "hr"}


class Page(HTMLParser):
    """Collects tags, checks that they close in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.stack: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text: list[str] = []
        self.feed(text)
        assert self.stack == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.stack.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.stack.pop() == tag

    def handle_data(self, data: str) -> None:
        if not {"script", "style"} & set(self.stack):
            self.text.append(data)

    def find(self, tag: str, **attributes: str) -> list[dict[str, str | None]]:
        return [
            found
            for name, found in self.tags
            if name == tag and all(found.get(k.strip("_")) == v for k, v in attributes.items())
        ]


@pytest.fixture(scope="module")
def source(campaign: Path) -> str:
    return whole(build_report(campaign))


@pytest.fixture(scope="module")
def page(source: str) -> Page:
    return Page(source)


def test_nothing_is_loaded_from_outside(page: Page, source: str) -> None:
    for tag, attributes in page.tags:
        for name in ("src", "srcset", "href", "action", "data", "poster"):
            target = attributes.get(name)
            # A link that the reader follows may lead to a file of the campaign, nothing loads it
            is_file = (tag, name) == ("a", "href") and re.fullmatch(
                r"(\.\./)*[\w%+-][\w./%+-]*(#[\w.:~=%]+)?", target or ""
            )
            assert target is None or target.startswith("#") or is_file, (tag, target)
    assert page.find("link") == []
    style = "".join(re.findall(r"<style>(.*?)</style>", source, re.DOTALL))
    assert "url(" not in style
    assert "@import" not in style
    policy = page.find("meta", http_equiv="x") or [
        a for _, a in page.tags if a.get("http-equiv") == "Content-Security-Policy"
    ]
    assert (policy[0]["content"] or "").startswith("default-src 'none'")


@pytest.mark.long
def test_equal_inputs_give_equal_bytes(campaign: Path, tmp_path: Path) -> None:
    """Also from a folder of another name and place, and over an older report."""
    other = tmp_path / "elsewhere"
    shutil.copytree(campaign, other)
    first = build_report(campaign).read_bytes()
    assert build_report(campaign).read_bytes() == first
    assert build_report(other).read_bytes() == first


def test_text_of_the_bench_cannot_become_markup(page: Page, source: str) -> None:
    assert "status error in step 1204 <div>" in "".join(page.text)
    assert "<b>&amp; end of program" in "".join(page.text)
    assert (
        "<div>"
        not in re.sub(r"<script.*?</script>", "", source, flags=re.DOTALL).split("step 1204", 1)[1][
            :8
        ]
    )


def test_every_run_has_a_target_a_row_a_cell_and_a_replay_command(page: Page, source: str) -> None:
    rows = [a for a in page.find("tbody") if "data-run" in a]
    runs = [a["data-run"] for a in rows]
    assert len(runs) == len(set(runs)) == 14
    assert runs[0] == "probing-feed_1_a"
    assert [a["id"] for a in rows] == runs
    links = Counter(a["href"] for a in page.find("a"))
    # Row, and a card where it did not pass
    good = {"pass", "marginal"}
    wanted = {f"#{a['data-run']}": 1 + (a["data-verdict"] not in good) for a in rows}
    assert {link: links[link] for link in wanted} == wanted
    found = re.search(r'id="map_data">(.*?)</script>', source)
    assert found is not None
    (plan,) = json.loads(found[1])["plans"]
    assert [run for run, _ in plan["runs"]] == runs
    copies = [a["data-text"] for a in page.find("button") if a.get("class") == "copy"]
    assert copies[0] == "axisrig replay out/probing probing-feed_1_a"
    ids = [a["id"] for _, a in page.tags if a.get("id")]
    assert len(ids) == len(set(ids))


def test_verdicts_are_glyph_word_and_colour(page: Page) -> None:
    text = " ".join(" ".join(page.text).split())
    for words in ("✔ pass", "~ marginal", "? inconclusive", "✖ fail", "■ aborted", "! error"):
        assert words in text
    counts = [a for a in page.find("li") if (a.get("class") or "").startswith("tile")]
    assert len(counts) == 6


def test_missing_values_say_why(page: Page) -> None:
    text = "".join(page.text)
    assert "the probe was actuated before the run: no latch" in text
    assert "stopped with Ctrl-C" in text
    assert "This run left no signals." in text


def test_tables_are_readable_without_eyes(page: Page) -> None:
    assert len(page.find("caption")) == len(page.find("table"))
    assert all(a.get("scope") for a in page.find("th"))
    assert all(a.get("aria-label") or a.get("aria-hidden") == "true" for a in page.find("svg"))
    assert page.find("html", lang="en")


@pytest.mark.long
def test_an_interrupted_campaign_is_said_to_be_one(campaign: Path, tmp_path: Path) -> None:
    part = tmp_path / "part"
    shutil.copytree(campaign, part)
    for name, keep in (("cases.csv", 3), ("results.csv", 13)):
        lines = (part / name).read_text(encoding="utf-8").splitlines(keepends=True)
        (part / name).write_text("".join(lines[:keep]), encoding="utf-8")
    text = "".join(Page(whole(build_report(part))).text)
    assert "12 of 14 planned runs left no result" in text


def test_a_run_on_a_real_bus_is_not_called_simulated(campaign: Path, tmp_path: Path) -> None:
    """A run of which real time is told, whatever the figures are, ran outside."""
    part = tmp_path / "part"
    shutil.copytree(campaign, part)
    path = part / "runs" / "probing-feed_1_a.json"
    facts = read_run(path).facts
    assert facts is not None
    none_sent = RealTime(1000.0, 100.0, 0, 0, None, None, (), (), 0, 0.0, 0, 0.0, 0)
    path.write_text(run_text(replace(facts, real_time=none_sent)), encoding="utf-8")
    text = whole(build_report(part))
    assert text.count("<dt>ran</dt>") == 1
    assert "<dt>on a real bus</dt>" in text
    assert "s in 13 runs" in text


@pytest.mark.long
def test_a_recording_that_contradicts_itself_is_refused_with_its_run(
    campaign: Path, tmp_path: Path
) -> None:
    """A run to a fixed stop of an axis whose signals the trace does not have."""
    part = tmp_path / "part"
    shutil.copytree(campaign, part)
    path = part / "runs" / "probing-feed_1_a.json"
    facts = read_run(path).facts
    assert facts is not None
    stop = FixedStop({"Q": Criteria(1.0)}, axes=("Q",))
    run = MeasurementRun(
        ("Q",), inputs={"Q": 1}, start_ns=0, signal_ns=1, end_ns=2, fixed_stop=stop
    )
    axes = {**facts.axes, "Q": replace(facts.axes["Z"], plant="q")}
    changed = replace(facts, runs=(run,), axes=axes, plants={"q": PlantRecord()})
    path.write_text(run_text(changed), encoding="utf-8")
    with pytest.raises(
        UserError, match=r"of run probing-feed_1_a cannot be read: the recording has no signal Q\."
    ):
        build_report(part)


@pytest.mark.long
def test_a_run_without_its_series_keeps_what_needs_none(campaign: Path, tmp_path: Path) -> None:
    part = tmp_path / "part"
    shutil.copytree(campaign, part)
    before = Page(whole(build_report(part)))
    (part / "traces" / "probing-feed_1_a.parquet").unlink()
    after = Page(whole(build_report(part)))
    assert len(after.find("figure")) == len(before.find("figure")) - 1
    assert len(after.find("pre")) == len(before.find("pre"))


@pytest.mark.long
def test_cards_are_of_planned_rows_that_are_not_good(campaign: Path, tmp_path: Path) -> None:
    """A row that the plan no longer has keeps its line, and has no card; the same for a probe."""
    for column in ("in_plan", "probe"):
        part = tmp_path / column
        shutil.copytree(campaign, part)
        with (part / "cases.csv").open(encoding="utf-8", newline="") as file:
            table = list(csv.DictReader(file))
        bad = [row["run"] for row in table if row["verdict"] not in ("pass", "marginal")]
        before = Page(whole(build_report(part))).find("article", **{"data-run": bad[0]})
        assert len(before) == 1
        for row in table:
            row[column] = "" if row["run"] != bad[0] else {"in_plan": "no"}.get(column, bad[1])
        with (part / "cases.csv").open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(table)
        after = Page(whole(build_report(part)))
        assert after.find("article", **{"data-run": bad[0]}) == []
        assert len(after.find("article", **{"data-run": bad[1]})) == 1


def test_other_folders_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no results folder"):
        build_report(tmp_path)


@pytest.mark.long
def test_a_run_whose_trace_is_empty_is_shown_without_plots(campaign: Path, tmp_path: Path) -> None:
    other = tmp_path / "empty"
    shutil.copytree(campaign, other)
    trace = other / "traces" / "probing-feed_1_a.parquet"
    pq.write_table(pq.read_table(trace).slice(0, 0), trace)
    assert len(Page(whole(build_report(other))).find("figure")) == 11


def test_a_signal_that_the_table_does_not_know_gets_a_plot() -> None:
    trace = pa.table({"time_ns": [0, 1], "Z.gap_mm": [0.5, 0.25], "Z.set_mm": [1.0, 2.0]})
    description, _ = chart(trace, RunFindings())
    assert [plot["plot"] for plot in description["plots"]] == ["position", "gap_mm"]
    assert description["axes"] == ["Z"]


def test_scripts_cannot_end_early() -> None:
    folder = Path(build_report.__code__.co_filename).parent
    for name in ("page.js", "vendor/uplot/uPlot.iife.min.js"):
        assert "</script" not in (folder / name).read_text(encoding="utf-8").lower()
    assert "MIT License" in (folder / "vendor/uplot/LICENSE").read_text(encoding="utf-8")


def _x(svg: str, kind: str) -> list[float]:
    return [float(x) for x in re.findall(rf'class="{kind}[^"]*" x1?="([\d.]+)"', svg)]


def test_the_bar_puts_a_value_between_its_limits() -> None:
    """In the middle of both limits the marker (3 wide) stands in the middle of the drawing."""
    svg = bar(67.0, 0.0, 66.99, 67.01, "pass", "67 mm")
    (marker,) = _x(svg, "bar-value")
    assert marker + 1.5 == pytest.approx(WIDTH / 2, abs=0.1)
    left, right = _x(svg, "bar-limit")
    assert left < marker < right
    assert (left + right) / 2 == pytest.approx(WIDTH / 2, abs=0.1)


def test_the_bar_shows_a_value_far_outside_as_an_arrow() -> None:
    assert "<path" in bar(99.0, 0.0, 66.99, 67.01, "fail", "99 mm")
    assert "bar-inconclusive" in bar(0.4, 0.05, None, 0.5, "marginal", "0.4 um")


def test_the_bands_of_the_bar_lie_where_the_verdict_changes() -> None:
    """Marginal between the limits, from one to two uncertainties inside of each; inconclusive
    within one of it on both sides.
    """
    lower, upper, uncertainty = 66.0, 68.0, 0.2
    svg = bar(67.0, uncertainty, lower, upper, "pass", "67 mm")
    area = scale(67.0, uncertainty, lower, upper)
    rects = re.findall(
        r'class="bar-(marginal|inconclusive)" x="([\d.]+)"[^>]*? width="([\d.]+)"', svg
    )
    found = sorted((kind, float(x), float(x) + float(width)) for kind, x, width in rects)
    wanted = [
        ("inconclusive", lower - uncertainty, lower + uncertainty),
        ("inconclusive", upper - uncertainty, upper + uncertainty),
        ("marginal", lower + uncertainty, lower + 2 * uncertainty),
        ("marginal", upper - 2 * uncertainty, upper - uncertainty),
    ]
    for (kind, left, right), (word, low, high) in zip(found, wanted, strict=True):
        assert kind == word
        assert (left, right) == pytest.approx((area.clipped(low), area.clipped(high)), abs=0.11)


def test_times_of_events_count_from_the_contact() -> None:
    """Also those behind an edge that comes later, until the next contact."""
    kinds = [("mark", 1), ("contact", 10), ("edge", 12), ("latch", 13), ("edge", 40), ("mark", 50)]
    kinds += [("contact", 60), ("edge", 62)]
    events = [Event(ms * 1_000_000, kind, kind) for kind, ms in kinds]
    answer = [row["since"] and float(row["since"]) for row in event_rows(events)]
    assert answer == ["", 0.0, 2.0, 3.0, 30.0, 40.0, 0.0, 2.0]
    without = [event for event in events if event.kind != "contact"]
    answer = [row["since"] and float(row["since"]) for row in event_rows(without)]
    assert answer == ["", 0.0, 1.0, 28.0, 38.0, 50.0], "else from the first edge"


@pytest.mark.parametrize(
    ("value", "lower", "upper"),
    [(0.1, None, 0.5), (-3.0, None, 0.5), (5.0, 2.0, None), (70331.0, 70331.0, 70331.0),
     (0.0, 0.0, 0.0), (0.0, None, 0.0), (-5.0, -2.0, None)],
)  # fmt: skip
def test_every_bar_has_room(value: float, lower: float | None, upper: float | None) -> None:
    area = scale(value, 0.01, lower, upper)
    assert area.low < area.high
    assert area.holds(lower if lower is not None else upper if upper is not None else 0.0)


@pytest.mark.parametrize(
    ("lower", "upper", "least", "most"), [(None, 2.0, 0.7, 1.0), (2.0, None, 0.3, 0.6)]
)
def test_one_limit_leaves_room_on_its_good_side(
    lower: float | None, upper: float | None, least: float, most: float
) -> None:
    """From 0 on: an upper limit is near the right end, above a lower one there is as much again."""
    area = scale(1.0, 0.01, lower, upper)
    assert area.low == 0.0
    assert least < 2.0 / area.high < most


def test_a_measurement_is_shown_from_before_contact_to_after_standstill() -> None:
    """100 ms long: 60 ms before, 40 ms after; the second one, 1 s later, is cut by the end."""
    ms = 1_000_000
    events = [
        Event(1000 * ms, "contact", ""),
        Event(1010 * ms, "brake", ""),
        Event(1100 * ms, "standstill", ""),
        Event(1300 * ms, "edge", ""),  # the probe leaves the surface
        Event(2100 * ms, "contact", ""),
        Event(2200 * ms, "standstill", ""),
        Event(5 * ms, "alarm", ""),
    ]
    found = {w["label"]: (w["start_ns"], w["end_ns"]) for w in windows(events, 0, 2210 * ms)}
    assert found["measurement 1"] == (940 * ms, 1140 * ms)
    assert found["edge 1"] == (994 * ms, 1014 * ms)
    assert found["measurement 2"] == (2040 * ms, 2210 * ms)
    assert found["alarm"] == (0, 155 * ms)
    assert len(found) == 5
    assert windows([], 0, 100) == []
    (edge,) = windows([Event(500 * ms, "edge", "")], 0, 1000 * ms)
    assert edge["label"] == "edge"
    assert (edge["start_ns"], edge["end_ns"]) == (500 * ms - 60_000, 500 * ms + 40_000)


def test_a_run_with_an_alarm_opens_there() -> None:
    """Not at a contact long before; a warning is no reason to look elsewhere."""
    ms = 1_000_000
    contact = Event(100 * ms, "contact", "probe: contact")
    ended = Event(900 * ms, "alarm", "ID 900006")
    first, *_ = windows([contact, ended], 0, 2000 * ms)
    assert (first["label"], first["start_ns"], first["end_ns"]) == ("alarm", 850 * ms, 1050 * ms)
    warning = replace(ended, label=f"ID 50052{WARNING}", is_warning=True)
    assert [w["label"] for w in windows([contact, warning], 0, 2000 * ms)] == ["edge"]


def test_a_measurement_without_an_edge_has_no_button_for_one() -> None:
    ms = 1_000_000
    end = Event(100 * ms, "standstill", "measurement run ended")
    assert [w["label"] for w in windows([end], 0, 2000 * ms)] == ["measurement"]


def shown(record: AlarmRecord) -> dict[str, str]:
    return alarm_words(record)


def test_an_alarm_says_in_words_what_it_is() -> None:
    answer = shown(alarm(900031, segment="can1"))
    assert answer["id"] == "900031"
    assert answer["text"].startswith("A SYNC could not be sent")


def test_the_table_shows_the_first_sentence_of_an_alarm() -> None:
    """Without the place in the program; the whole text stands at the run."""
    place = "a.nc line 6, block N50"
    line = f"ID 900005 class 5: Drive of axis Z is at 0.5 mm ({place}). Look it up."
    answer = shown(AlarmRecord(0, 900005, 5, True, line, place=place))
    assert answer["short"] == "Drive of axis Z is at 0.5 mm"
    assert answer["text"].endswith("Look it up.")


def test_an_alarm_keeps_what_stands_behind_a_colon_of_its_own_words() -> None:
    answer = shown(AlarmRecord(0, 900005, 5, True, "ID 900005 class 5: Axes: Z at 0:5. Look: up."))
    assert answer["text"] == "Axes: Z at 0:5. Look: up."
    assert answer["short"] == "Axes: Z at 0:5"


def test_what_came_up_during_the_stop_is_told_beside_the_alarm() -> None:
    first = shown(alarm(900031, segment="can1"))
    second = shown(alarm(900034, is_further=True, axis="Z", node=3, state="stopped"))
    assert (first["id"], second["id"]) == ("900031", "900034")
    assert not first["text"].startswith("besides: ")
    assert second["text"].startswith("besides: Drive of axis Z")


def test_an_alarm_with_a_newer_twin_names_it() -> None:
    values = {"owner": "axis Z", "deviation_mm": 6, "limit_mm": 5, "offset_mm": 5}
    answer = shown(alarm(70331, **values))
    assert answer["text"].endswith("Newer builds report 310017.")
    assert str(Alarm(310017, **values)).endswith("Older builds report 70331.")


def test_the_tables_of_the_report_fit_together() -> None:
    plots = {row["plot"] for row in shipped_table("plots.csv")}
    assert {signal.plot for signal in signals().values()} <= plots
