"""What the report tells of distance control, on runs made of formulas."""

from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.reports.distances import MS, control, info, law, limit, samples, trace
from tests.reports.formulas import made, write_runs
from tests.reports.pages import opened, whole
from tests.reports.test_report import Page

from axisrig.bench.judge.distance.control_findings import DeadCycles
from axisrig.bench.oracles.distance.lists import Control
from axisrig.bench.oracles.distance.loop import CONST_DIST
from axisrig.kernel.errors import UserError
from axisrig.reports.build import build_report
from axisrig.reports.distance.path import drawing
from axisrig.reports.distance.section import sections
from axisrig.reports.distance.signals import with_surfaces
from axisrig.reports.distance.words import law_words, state
from axisrig.reports.parts.axes import ticks
from axisrig.reports.signals import chart

ALARMS = {"ID 70331": "Distance control of axis Z wants an offset of 5.004 mm"}
SAMPLES = {sample.name: sample for sample in samples()}
FINDINGS = {name: info(sample) for name, sample in SAMPLES.items()}


def shown(name: str) -> dict[str, Any]:
    sample = SAMPLES[name]
    (found,) = sections(info(sample), trace(sample), name, ALARMS)
    return found


def happened(name: str) -> dict[str, str]:
    return dict(shown(name)["happened"])


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("surface-with-freeze", "follows the surface"),
        ("profile", "keeps the distance"),
        ("oscillates", "above the limit of stability"),
        ("dry-run", "dry run"),
        ("alarm", "ended by ID 70331"),
    ],
)
def test_what_became_of_it(name: str, word: str) -> None:
    assert shown(name)["word"] == word


@pytest.mark.parametrize(
    ("is_dry", "found"),
    [
        ((False, False), "unstable"),
        ((True, True), "dry"),  # nothing follows the law: nothing oscillates
        ((True, False), "unstable"),
        ((False, True), "unstable"),
    ],
)
def test_a_law_beyond_its_limit_counts_where_the_offset_follows_it(
    is_dry: tuple[bool, bool], found: str
) -> None:
    made = control(SAMPLES["oscillates"])
    on = next(part for part in made.stretches if part.law is not None)
    parts = [replace(on, is_dry_run=each) for each in is_dry]
    assert state(replace(made, stretches=parts), [])[0] == found


def test_a_loop_beyond_its_limit_is_told_in_words() -> None:
    """A mean of 4 with one dead cycle: 2N sin^2(w/2)/sin(Nw/2), w = pi/(N + 2n), is 0.619."""
    (row,) = shown("oscillates")["laws"]
    assert row["words"].startswith(
        "kp 1 is above the limit 0.619 for 1 dead cycle and mean of 4: the loop oscillates"
    )
    assert (row["limit"], row["margin"], row["unstable"]) == ("0.619", "0.62", True)
    assert "the error swings by ±" in happened("oscillates")["100.0 ms"]


def test_a_stable_loop_is_told_with_its_settling() -> None:
    words = law_words(law(Control(kp=0.2, count=4), CONST_DIST))
    assert words.startswith(
        "kp 0.2 is below the limit 0.619 for 1 dead cycle and mean of 4: stable"
    )
    # ln 0.05/ln 0.8137, the largest pole of the loop
    assert words.endswith("down to 5 % in 15 cycles")


def test_a_sensor_of_the_wrong_sign_has_no_stable_kp() -> None:
    row = replace(law(Control(kp=0.2), CONST_DIST), kp_limit=0.0, growth=1.2)
    assert "no kp keeps this loop stable" in law_words(row)
    assert "sign of the sensor" in law_words(row)


def test_each_part_says_who_and_what() -> None:
    answer = happened("surface-with-freeze")
    assert answer["100.0 ms"].startswith(
        "ON by the PLC, SET_POS 40 mm: offset 0 mm to 0 mm, between"
    )
    assert answer["1000.0 ms"] == (
        "FREEZE by the PLC: the offset is held at 0 mm, bit for bit;"
        " the sensor goes from -2 mm to -1.5 mm"
    )
    assert "to 0.5 mm" in answer["1300.0 ms"]
    assert answer["1600.0 ms"] == "OFF by the PLC: 0.5 mm run out, 90 ms"
    assert "1690.0 ms" not in answer  # INACTIVE by itself


def test_a_freeze_that_moves_says_so() -> None:
    sample = SAMPLES["surface-with-freeze"]
    signals = trace(sample)
    offset = signals.column("Z.offset_mm").to_numpy().copy()
    offset[1200] += 0.001
    at = signals.column_names.index("Z.offset_mm")
    signals = signals.set_column(at, "Z.offset_mm", pa.array(offset))
    (found,) = sections(info(sample), signals, "x", {})
    assert "and moves by 0.001 mm" in dict(found["happened"])["1000.0 ms"]


def test_an_alarm_stands_with_its_words() -> None:
    found = shown("alarm")
    assert (found["glyph"], found["state"]) == ("■", "ended")
    assert ("480.0 ms", f"ID 70331: {ALARMS['ID 70331']}") in found["happened"]


def test_a_dry_run_leaves_the_offset() -> None:
    assert "DRYRUN, the offset stays" in happened("dry-run")["100.0 ms"]


def test_limits_say_what_was_used_of_them() -> None:
    rows = {row["key"]: row for row in shown("surface-with-freeze")["limits"]}
    assert (rows["v_max"]["used"], rows["v_max"]["word"]) == ("100", "reached")
    assert rows["max_deviation"]["word"] == ""
    sample = SAMPLES["profile"]
    used = [*control(sample).limits[:-1], limit("min_pos", 420, -8.0, "mm", -8.5)]
    (found,) = sections(info(sample, limits=used), None, "x", {})
    assert (found["limits"][-1]["word"], found["limits"][-1]["off"]) == ("outside", True)


def test_dead_cycles_of_the_frames_that_differ_are_marked() -> None:
    (found,) = sections(info(SAMPLES["profile"], dead=DeadCycles(1, 2)), None, "x", {})
    assert found["laws"][0]["dead_off"] is True
    unknown = DeadCycles(1, note="no step")
    (found,) = sections(info(SAMPLES["profile"], dead=unknown), None, "x", {})
    assert (found["laws"][0]["measured"], found["laws"][0]["dead_off"]) == ("–", False)


def test_errors_stand_beside_their_closed_form() -> None:
    (row,) = shown("profile")["errors"]
    assert (row["measured"], row["expected"], row["apart"]) == ("0.40", "0.00", "+0.40")
    (row,) = shown("alarm")["errors"]
    assert (row["expected"], row["note"]) == ("–", "the transient needs 40 cycles")


def test_measured_spread_and_closed_form_have_the_unit_of_their_column() -> None:
    """0.4 um with a spread of 0.1 um, under headings in um."""
    section = shown("profile")
    assert (section["unit"], section["small"]) == ("mm", "µm")
    (row,) = section["errors"]
    assert (row["measured"], row["spread"]) == ("0.40", "0.10")
    folder = resources.files("axisrig.reports.distance")
    page = folder.joinpath("section.html").read_text("utf-8")
    head = page.split("Too near at the end of")[1].split("</tr>")[0]
    assert [word in head for word in ("true", "±", "closed form")] == [True] * 3
    assert head.count("{{ control.small }}") == 4


# Signals


def test_surfaces_are_put_together_from_what_was_recorded() -> None:
    """Filtered surface = SET_POS + filtered deviation; true surface = tool less true distance."""
    sample = SAMPLES["surface-with-freeze"]
    before = trace(sample)
    after = with_surfaces(before, [control(sample)])
    names = set(after.column_names)
    assert not {"Z.filtered_mm", "Z.distance_cnc_mm", "gap.distance_mm", "gap.valid"} & names
    truth = after.column("Z.surface_truth_mm").to_numpy()
    assert np.allclose(truth, sample.surface(np.arange(sample.rows, dtype=float)))
    filtered = after.column("Z.filtered_surface_mm").to_numpy()
    on = before.column("Z.distance_state").to_numpy() == 1
    assert np.isfinite(filtered[on]).all()
    assert np.isnan(filtered[~on]).all()
    settled = slice(600, 890)
    assert np.allclose(filtered[settled], 42.0)


def test_a_mode_shows_only_what_it_needs() -> None:
    sample = SAMPLES["profile"]
    description, _ = chart(trace(sample), info(sample))
    plots = [plot["plot"] for plot in description["plots"]]
    assert plots[:2] == ["state", "position"]
    assert "distance" in plots
    assert not {"surface", "sensor"} & set(plots)
    assert description["axis"] == "Z"
    assert description["axes"] == ["X", "Z"]  # the sensor stands with its axis


def test_limits_stand_in_the_plots_in_their_sign() -> None:
    """d = -s: the upper limit of the sensor is the least distance."""
    description, _ = chart(trace(SAMPLES["profile"]), info(SAMPLES["profile"]))
    found = {(row["plot"], row["label"]): [] for row in description["limits"]}
    for row in description["limits"]:
        found[row["plot"], row["label"]].append(row["value"])
    assert found["offset", "max_deviation"] == [5.0, -5.0]
    assert found["step", "v_max"] == [0.1, -0.1]  # 100 mm/s in a cycle of 1 ms
    assert (found["distance", "max_pos"], found["distance", "min_pos"]) == ([-8.0], [8.0])
    description, _ = chart(
        trace(SAMPLES["surface-with-freeze"]), info(SAMPLES["surface-with-freeze"])
    )
    assert {"plot": "sensor", "axis": "Z", "value": 8.0, "label": "max_pos"} in description[
        "limits"
    ]


def test_states_are_a_lane_and_have_buttons() -> None:
    sample = SAMPLES["surface-with-freeze"]
    description, _ = chart(trace(sample), info(sample))
    assert [lane["label"] for lane in description["lanes"]][1:5] == [
        "ACTIVE",
        "FREEZE",
        "ACTIVE",
        "TURNING_OFF",
    ]
    labels = [window["label"] for window in description["windows"]]
    assert labels == ["distance control", "active 1", "freeze", "active 2", "turning off"]
    first = description["windows"][0]
    assert first["start_ns"] < 100 * MS < 1690 * MS < first["end_ns"]


def test_without_signals_the_section_still_stands() -> None:
    sample = SAMPLES["surface-with-freeze"]
    (found,) = sections(info(sample), None, "x", {})
    assert dict(found["happened"])["1000.0 ms"] == "FREEZE by the PLC: the offset is held"
    assert found["path"] == ""


# Tool over surface


def test_the_tool_is_drawn_over_the_surface_where_another_axis_moves() -> None:
    sample = SAMPLES["profile"]
    svg = drawing(trace(sample), control(sample))
    assert svg.count("<polyline") == 3
    assert "X in mm" in svg
    assert len(svg) < 30_000
    assert drawing(trace(SAMPLES["alarm"]), control(SAMPLES["alarm"])) == ""


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0.0, 10.0, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]),
        (39.95, 40.05, [39.96, 39.98, 40.0, 40.02, 40.04]),
    ],
)
def test_ticks_are_round(low: float, high: float, expected: list[float]) -> None:
    assert ticks(low, high) == expected


# The page


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("distance")
    return write_runs(folder, "distance", {name: trace(sample) for name, sample in SAMPLES.items()})


@pytest.mark.long
def test_the_page_tells_it_and_stays_the_same(results: Path) -> None:
    """Every drawing has words, tables have captions, nothing comes from outside, few bytes."""
    first = build_report(results, findings=made(FINDINGS)).read_bytes()
    assert build_report(results, findings=made(FINDINGS)).read_bytes() == first
    page = Page(whole(first.decode()))
    found = [a for a in page.find("section") if a.get("class") == "stop distance"]
    assert len(found) == len(SAMPLES)
    assert all(a.get("aria-label") for a in page.find("svg"))
    assert len(page.find("caption")) == len(page.find("table"))
    text = " ".join(" ".join(page.text).split())
    assert "kp 1 is above the limit 0.619 for 1 dead cycle and mean of 4" in text
    article = opened(first.decode())["distance-oscillates"].html.split('<div class="body">')[0]
    assert len(article) < 9_000


@pytest.mark.long
def test_findings_that_lack_a_value_are_refused_with_their_block(results: Path) -> None:
    lacking = FINDINGS | {"alarm": info(SAMPLES["alarm"], errors=None)}
    with pytest.raises(UserError, match="`distance` of run distance-alarm cannot be read"):
        build_report(results, findings=made(lacking))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "1 dead cycle and mean of 4:"),
        ({"dead_cycles": 2, "filter": "mean of 1"}, "2 dead cycles and no filter:"),
        ({"age_cycles": 1}, "1 dead cycle, mean of 4 and a sensor 1 cycle late:"),
        ({"age_cycles": 3}, "1 dead cycle, mean of 4 and a sensor 3 cycles late:"),
        ({"age_cycles": -1}, "mean of 4 and a sensor 1 cycle newer than 6064:"),
        ({"age_cycles": -2, "drive_lag_ms": 25.0},
         "mean of 4, a sensor 2 cycles newer than 6064 and drive lag 25 ms:"),
    ],
)  # fmt: skip
def test_what_a_limit_of_kp_holds_for(changes: dict[str, Any], words: str) -> None:
    assert words in law_words(replace(law(Control(kp=0.2, count=4), CONST_DIST), **changes))
