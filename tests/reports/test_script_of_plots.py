"""Plots of a run, as their script gives them to uPlot and draws what is on them besides signals.

The script runs in node with plots that write down what is drawn: 1 px is 1 ms from 0 to 400, and
heights go from 0 at 200 px to 100 at 100 px. A letter is 5 px wide.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.page_scripts import ELEMENTS, needs_node, value_in_node

from axisrig import reports
from axisrig.reports.parts.encode import encode_signal, pack

pytestmark = needs_node

SCRIPT = Path(reports.__file__).with_name("plots.js")
UNPACKER = SCRIPT.parent / "vendor" / "pako" / "pako_inflate.min.js"
MS = 1_000_000
PAGE = f"""{ELEMENTS}
globalThis.exports = undefined;
const all = [];
function context(drawn) {{
  const ctx = {{measureText: (text) => ({{width: 5 * text.length}})}};
  let begin = null, end = null;
  for (const name of ["save", "restore", "beginPath", "setLineDash"]) ctx[name] = () => {{}};
  ctx.moveTo = (x, y) => {{ begin = [x, y]; }};
  ctx.lineTo = (x, y) => {{ end = [x, y]; }};
  ctx.stroke = () => drawn.push(["line", ctx.strokeStyle, ...begin, ...end]);
  ctx.fillRect = (...where) => drawn.push(["box", ctx.fillStyle, ...where]);
  ctx.fillText = (text, x, y) =>
    drawn.push(["text", text, ctx.fillStyle, x, y, ctx.textAlign, ctx.textBaseline]);
  return ctx;
}}
globalThis.uPlot = class {{
  constructor(options, data) {{
    Object.assign(this, {{options, data, drawn: [], scales: {{}}, is_there: true, cursor: null,
      width: options.width, height: options.height}});
    this.ctx = context(this.drawn);
    this.bbox = {{left: 0, top: 100, width: 400, height: 100}};
    all.push(this);
  }}
  valToPos(value, axis) {{ return axis === "y" ? 200 - value : value; }}
  setScale(key, {{min, max}}) {{ this.scales[key] = {{min, max}}; }}
  setSize(size) {{ this.size = size; }}
  setCursor(cursor) {{ this.cursor = cursor.left; }}
  destroy() {{ this.is_there = false; }}
}};
uPlot.paths = {{stepped: () => "steps"}};
globalThis.axisrigBlocks = {{
  lane: () => "lane", band: () => () => {{}}, connect() {{}}, click() {{}},
  at: (state, ms, number) => (ms < 2 ? [0, 0, 0, 0, 0, 0, "N1"] : null),
}};
const figure = new Shown("figure");
figure.clientWidth = 400;
for (const name of ["tools", "stack"]) {{
  const inside = new Shown("div");
  inside.className = name;
  figure.append(inside);
}}
const there = () => all.filter((one) => one.is_there);
function drawn(u, hook) {{
  u.drawn.length = 0;
  for (const act of u.options.hooks[hook]) act(u);
  return u.drawn;
}}
const buttons = () => figure.querySelectorAll(".tools button");
const pressed = () => buttons().filter((one) => one.set["aria-pressed"] === "true")
  .map((one) => one.textContent);
const press = (name) => buttons().find((one) => one.textContent === name).fire("click");
const views = () => there().map((u) => [u.scales.x.min, u.scales.x.max]);
"""


def series(label: str, column: str = "x", style: str = "actual", unit: str = "mm") -> Any:
    return {"label": label, "column": column, "style": style, "unit": unit}


def plot(name: str, unit: str = "mm", /, **given: list[Any]) -> Any:
    return {"plot": name, "title": f"the {name}", "unit": unit, "height": 100, "series": given}


def read(what: str, **chart: Any) -> Any:
    """An expression after a run of 0 to 400 ms has been drawn; `state` is what `draw` gives."""
    signals = {"time_ns": np.array([0.0, 1e6, 2e6, 4e8]), "x": np.arange(4.0), "z": np.zeros(4)}
    heads, octets = zip(*(encode_signal(one, 0) for one in signals.values()), strict=True)
    columns = [
        {"name": name, "start": head.start, "planes": head.planes, "digits": 0, "gaps": head.gaps}
        for name, head in zip(signals, heads, strict=True)
    ]
    given = {
        "rows": 4, "columns": columns, "axes": ["X", "Z"], "axis": "X", "events": [], "limits": [],
        "windows": [], "plots": [plot("position", X=[series("x")], Z=[series("z", "z")]),
                                 plot("lag", **{"*": [series("lag")]})],
        **chart,
    }  # fmt: skip
    draw = f"axisrigPlots.draw(figure, {json.dumps(given)}, {json.dumps(pack(list(octets)))}, 'k')"
    return value_in_node(f"((state) => {what})({draw})", [UNPACKER, SCRIPT], PAGE)


def event(ms: float, label: str, kind: str = "edge", axis: str | None = None) -> Any:
    return {"time_ns": ms * MS, "label": label, "kind": kind, "axis": axis}


def events(*given: Any, place: int = 0) -> list[Any]:
    return list(read(f'drawn(all[{place}], "draw")', events=given))


def test_an_event_is_a_line_with_its_name_above_the_first_plot() -> None:
    """The first lane is 0.6 of 12 px above the plot; a line begins 0.4 of them above its name."""
    given = event(50, "edge 1")
    name = ["text", "edge 1", "--edge", 54, 92.8, "left", "middle"]
    assert events(given) == [name, ["line", "--edge", 50.5, 88, 50.5, 200]]
    assert events(given, place=1) == [["line", "--edge", 50.5, 95.2, 50.5, 200]]


def test_names_that_would_overlap_are_one_above_the_other_and_what_went_wrong_is_first() -> None:
    """Five lanes of 12 px; the sixth has no name, and one behind them is in the first lane."""
    kinds = ["edge", "edge", "fault", "edge", "alarm", "edge", "edge"]
    given = [event(10 + place, f"e{place}", kind) for place, kind in enumerate(kinds)]
    found = events(*given, event(60, "behind"))
    names = {name: y for what, name, _, _, y, *_ in found if what == "text"}
    expected = ["e2", "e4", "e0", "e1", "e3"]
    assert names == pytest.approx(
        {**{name: 92.8 - 12 * lane for lane, name in enumerate(expected)}, "behind": 92.8}
    )
    assert len([one for one in found if one[0] == "line"]) == 8


def test_a_name_at_the_right_border_is_at_the_left_of_its_line() -> None:
    """An edge of six letters needs 40 px."""
    found = events(event(360, "edge 1"), event(361, "edge 2"))
    texts = [one[1:] for one in found if one[0] == "text"]
    assert texts[0] == ["edge 1", "--edge", 364, 92.8, "left", "middle"]
    assert texts[1] == ["edge 2", "--edge", 357, pytest.approx(80.8), "right", "middle"]


def test_events_outside_of_the_view_and_of_other_axes_are_left_out() -> None:
    """Those of an axis that has no plots are of all; at the borders they are shown."""
    given = [
        event(-1, "before"), event(0, "first"), event(200, "X", axis="X"),
        event(250, "Z", axis="Z"),
        event(300, "Q", axis="Q"), event(400, "last"), event(401, "after"),
    ]  # fmt: skip
    assert [one[1] for one in events(*given) if one[0] == "text"] == ["first", "X", "Q", "last"]


def limits(*given: tuple[str, float], others: Any = ()) -> list[Any]:
    listed = [{"plot": "position", "label": label, "value": value} for label, value in given]
    return list(read('drawn(all[0], "draw")', limits=[*listed, *others]))


def texts_of(found: list[Any]) -> list[Any]:
    """Each text with its height in px, and whether that is the top or the bottom of the text."""
    return [(one[1], one[4], one[6]) for one in found if one[0] == "text"]


def test_a_limit_is_a_line_with_its_name_above_it_at_the_right() -> None:
    assert limits(("max", 40)) == [
        ["line", "--limit", 0, 160.5, 400, 160.5],
        ["text", "max 40", "--limit", 396, 158, "right", "bottom"],
    ]  # fmt: skip


def test_the_lowest_of_several_limits_has_its_name_below() -> None:
    found = limits(("high", 80), ("low", 20), ("middle", 50))
    assert texts_of(found) == [
        ("low 20", 183, "top"), ("middle 50", 148, "bottom"), ("high 80", 118, "bottom"),
    ]  # fmt: skip


def test_limits_that_are_close_together_have_one_name() -> None:
    """Closer than 14 px; of one name only the values are listed."""
    assert texts_of(limits(("a", 40), ("b", 53))) == [("a 40, b 53", 145, "bottom")]
    assert texts_of(limits(("a", 40), ("a", 50), ("b", 60))) == [("a 40 … 50, b 60", 138, "bottom")]
    assert texts_of(limits(("a", 40), ("b", 54))) == [
        ("a 40", 163, "top"), ("b 54", 144, "bottom"),
    ]  # fmt: skip


def test_limits_outside_of_the_picture_are_named_at_its_edge() -> None:
    """One below the other, without a line; those at the very edge are inside."""
    found = limits(("a", 150), ("b", 101), ("c", 100), ("d", 0), ("e", -1), ("f", -70))
    assert texts_of(found) == [
        ("▼ f -70", 198, "bottom"), ("▼ e -1", 186, "bottom"), ("d 0", 198, "bottom"),
        ("c 100", 98, "bottom"), ("▲ b 101", 102, "top"), ("▲ a 150", 114, "top"),
    ]  # fmt: skip
    assert [one[3] for one in found if one[0] == "line"] == [200.5, 100.5]


def test_a_plot_has_its_own_limits_and_those_of_its_axis() -> None:
    other = [{"plot": "lag", "label": "l", "value": 60},
             {"plot": "position", "axis": "Z", "label": "z", "value": 60},
             {"plot": "position", "axis": "X", "label": "x", "value": 80}]  # fmt: skip
    assert [one[0] for one in texts_of(limits(("max", 40), others=other))] == ["max 40", "x 80"]


def test_expected_instants_are_bands_inside_of_the_view() -> None:
    """A narrow one is a pixel wide; those of another axis and outside are not there."""
    stretches = [(10, 30, None), (50, 50.2, "X"), (60, 90, "Z"), (-20, 5, "X"), (390, 500, None),
                 (500, 600, None), (-9, -1, None)]  # fmt: skip
    bands = [{"start_ns": a * MS, "end_ns": b * MS, "axis": axis} for a, b, axis in stretches]
    assert read('drawn(all[0], "drawClear")', bands=bands) == [
        ["box", "--expected", left, 100, width, 100]
        for left, width in ((10, 20), (50, 1), (0, 5), (390, 10))
    ]


def test_states_of_an_axis_are_boxes_with_their_names_where_there_is_room() -> None:
    """A name has 4 px on each side."""
    stretches = [(0, 38, "X", "TURNING_OFF"), (40, 77.9, "X", "ACTIVE"), (80, 200, "Z", "ERROR"),
                 (300, 900, "X", "ACTIVE_CONST_DIST"), (500, 600, "X", "ERROR")]  # fmt: skip
    lanes = [{"start_ns": a * MS, "end_ns": b * MS, "axis": axis, "state": state, "label": "states"}
             for a, b, axis, state in stretches]  # fmt: skip
    found = read('drawn(all[0], "drawClear")', lanes=lanes, plots=[plot("state", X=[series("s")])])
    name = ["text", "states", "--ink", 4, 150, "left", "middle"]
    assert found[:2] == [["box", "--lane-turning-off", 0, 100, 38, 100], name]
    assert found[2][1] == "--lane-active"
    assert found[3:] == [
        ["box", "--lane-active-const-dist", 300, 100, 100, 100], [*name[:3], 304, *name[4:]],
    ]  # fmt: skip


def test_a_plot_is_there_where_it_has_signals_of_the_axis_or_of_all() -> None:
    plots = [plot("position", X=[series("x", "x")], Z=[series("z", "z")]),
             plot("only", Z=[series("only", "z")]),
             plot("both", X=[series("mine", "x")], **{"*": [series("all", "z")]})]  # fmt: skip
    shown = "there().map((u) => u.options.series.slice(1).map((one) => one.label))"
    data = "there().map((u) => u.data.slice(1).map((one) => one[3]))"
    assert read(f'[{shown}, {data}, (press("Z"), {shown}), {data}, pressed()]', plots=plots) == [
        [["x"], ["mine", "all"]], [[3], [3, 0]],
        [["z"], ["only"], ["all"]], [[0], [0], [0]], ["Z", "whole run"],
    ]  # fmt: skip


def test_the_first_plot_has_room_for_names_and_the_last_one_for_the_time() -> None:
    """Five lanes of 12 px above, 34 px below; printed is lower, lanes and edges are not."""
    plots = [plot(name, X=[series("x")]) for name in ("position", "lag", "probe", "state")]
    heights = "there().map((u) => u.options.height)"
    printed = 'document.documentElement.className = "printing", press("X")'
    assert read(f"[{heights}, ({printed}, {heights})]", plots=plots) == [
        [160, 100, 100, 134], [120, 60, 100, 134],
    ]  # fmt: skip
    (one,) = read(heights, plots=plots[:1])
    assert one == 194


def test_a_lane_of_blocks_is_as_high_as_it_has_lanes() -> None:
    plots = [plot("block", "", X=[series("", "block")])]
    assert read("all[0].options.height", plots=plots, blocks={"lanes": 3}) == 3 * 100 + 60 + 34
    words = "[0, 2].map((n) => all[0].options.series[1].value(all[0], 0, 1, n))"
    assert read(words, plots=plots, blocks={"lanes": 3}) == ["N1", "–"]


def test_kinds_of_signals_have_their_own_lines() -> None:
    """A set value is dashed, truth lies thin on the actual value, and a stop gives no scale."""
    styles = ("set", "actual", "truth", "stop")
    plots = [plot("position", X=[series(style, style=style) for style in styles]),
             plot("probe", "", X=[series("level")])]  # fmt: skip
    each = "one.stroke(), one.width, one.dash ?? null, one.auto, one.paths ?? null"
    lines = f"u.options.series.slice(1).map((one) => [{each}])"
    position, probe = read(f"all.map((u) => {lines})", plots=plots)
    assert position == [
        ["--set", 1.5, [5, 3], True, None], ["--actual", 4, None, True, None],
        ["--truth", 1, None, True, None], ["--stop", 1.25, None, False, None],
    ]  # fmt: skip
    assert probe[0][4] == "steps"


def test_heights_have_their_titles_units_and_ranges() -> None:
    plots = [plot(name, unit, X=[series("x")], Z=[series("z")]) for name, unit in
             (("position", "mm"), ("lag", ""), ("probe", ""), ("state", ""))]  # fmt: skip
    each = "[u.options.axes[1].label, u.options.scales.y.range ?? null]"
    ranges = {"position": {"X": [1, 2], "Z": [3, 4]}}
    found = read(f'[all.map((u) => {each}), (press("Z"), there().map((u) => {each})[0])]',
                 plots=plots, ranges=ranges)  # fmt: skip
    assert found == [
        [["the position · mm", [1, 2]], ["the lag", None], ["the probe", [-0.15, 1.15]],
         ["the state", [0, 6]]],
        ["the position · mm", [3, 4]],
    ]  # fmt: skip


def test_values_under_the_cursor_have_their_unit_and_states_their_name() -> None:
    plots = [plot("position", X=[series("x"), series("p", unit="")]),
             plot("state", "", X=[series("s")])]  # fmt: skip
    values = "[null, 0, 1.23456789, 5].map((v) => all[p].options.series[s].value(null, v))"
    read_ = f"[[0, 0], [0, 1], [0, 2], [1, 1]].map(([p, s]) => {values})"
    assert read(read_, plots=plots) == [
        ["–", "0 ms", "1.234568 ms", "5 ms"], ["–", "0 mm", "1.234568 mm", "5 mm"],
        ["–", "0", "1.234568", "5"], ["–", "INACTIVE", "–", "ERROR"],
    ]  # fmt: skip


WINDOWS = [
    {"label": "one", "start_ns": 10 * MS, "end_ns": 20 * MS},
    {"label": "contact", "start_ns": 100 * MS, "end_ns": 140 * MS, "zero": "contact",
     "origin_ns": 103 * MS},
]  # fmt: skip


def test_a_run_opens_at_its_first_window_or_at_the_one_that_is_meant() -> None:
    assert read("[views(), pressed()]") == [[[0, 400]] * 2, ["X", "whole run"]]
    assert read("[views(), pressed()]", windows=WINDOWS) == [[[10, 20]] * 2, ["X", "one"]]
    assert read("[views(), pressed()]", windows=WINDOWS, opens=1) == [
        [[100, 140]] * 2, ["X", "contact"],
    ]  # fmt: skip


def test_a_window_may_count_its_time_from_a_contact() -> None:
    """Round times are those from there: 5 ms after 103 ms is 108 ms. The other windows from 0."""
    axis = "there().at(-1).options.axes[0]"
    time = f"[{axis}.label, {axis}.splits(null, 0, 100, 114, 5), {axis}.values(null, [98, 108])," \
           " there()[0].options.axes[0].values(null, [98]), views()[0]]"  # fmt: skip
    names = ["contact", "one", "contact", "whole run"]
    found = read(f"{names}.map((name) => (press(name), {time}))", windows=WINDOWS)
    contact = ["ms from contact", [103, 108, 113], [-5, 5], [], [100, 140]]
    start = ["time in ms", [100, 105, 110], [98, 108], []]
    assert found == [contact, [*start, [10, 20]], contact, [*start, [0, 400]]]


def test_a_window_with_the_same_zero_is_shown_in_the_plots_that_are_there() -> None:
    windows = [*WINDOWS, {"label": "two", "start_ns": 30 * MS, "end_ns": 50 * MS}]
    shown = "(press(name), [views(), pressed(), all.length])"
    assert read(f'["whole run", "two", "one"].map((name) => {shown})', windows=windows) == [
        [[[0, 400]] * 2, ["X", "whole run"], 2], [[[30, 50]] * 2, ["X", "two"], 2],
        [[[10, 20]] * 2, ["X", "one"], 2],
    ]  # fmt: skip


def test_what_is_shown_of_one_plot_is_shown_of_all() -> None:
    """No button is pressed then but that of the axis, until a window is shown again."""
    zoom = 'all[1].setScale("x", {min: 5, max: 9}), all[1].options.hooks.setScale[0](all[1], "x")'
    other = 'all[1].options.hooks.setScale[0](all[1], "y")'
    exact = zoom.replace("5", "10").replace("9", "20")
    assert read(f"[({zoom}, views()), pressed(), ({exact}, pressed()), ({other}, views()),"
                ' (press("Z"), views())]', windows=WINDOWS) == [
        [[5, 9]] * 2, ["X"], ["X", "one"], [[10, 20]] * 2, [[10, 20]] * 2,
    ]  # fmt: skip


def test_an_instant_is_pointed_at_in_all_plots_where_it_is_shown() -> None:
    point = "(axisrigPlots.point(state, ms), all.map((u) => u.cursor))"
    places = "[9.9, 10, 15, 20, 20.1]"
    assert read(f"{places}.map((ms) => {point})", windows=WINDOWS) == [
        [-10, -10], [10, 10], [15, 15], [20, 20], [-10, -10],
    ]  # fmt: skip


def test_the_cursor_of_a_plot_reports_its_time() -> None:
    move = "(u.cursor = {idx}, u.options.hooks.setCursor[0](u))"
    assert read(f"((times, u) => {{ state.pointed = (ms) => times.push(ms); [2, null, 0].forEach("
                f"(idx) => {move}); return times; }})([], all[1])") == [2, None, 0]  # fmt: skip


def test_plots_are_as_wide_as_their_place_until_they_are_removed() -> None:
    sizes = "all.map((u) => u.size ?? null)"
    width = "figure.clientWidth"
    steps = [f"({width} = {px}, resized(), {sizes})" for px in (400, 0, 300)]
    *before, after, gone, watched = read(f"[{', '.join(steps)}, (state.remove(), there().length),"
                                         " resized]")  # fmt: skip
    assert before == [[None, None]] * 2
    assert after == [{"width": 300, "height": 160}, {"width": 300, "height": 134}]
    assert (gone, watched) == (0, None)
