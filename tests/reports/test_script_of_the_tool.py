"""The instant that the side view of a tool shows: its words, slider, cursor, play and projections.

The script runs in node with a tool that moves over 40 ms and is inclined most at 10 ms.
"""

import json
from pathlib import Path
from typing import Any

from tests.page_scripts import ELEMENTS, needs_node, value_in_node

from axisrig import reports

pytestmark = needs_node

SCRIPT = Path(reports.__file__).parent / "kinematics" / "view.js"
TIMES = [0, 10, 20, 40]
SIGNALS: dict[str, Any] = {
    "time_ms": TIMES, "tilt": [0, 30, 15, 30], "length": [100, 100.5, 101, 102],
    "distance": [None, 1.5, None, 0], "offset": [None, -0.25, 0, None],
    "moved": [None, None, 0.5, None], "depth": [None, -0.0123, 0.002, 0], "at_work": [0, 1, 1, 1],
    **{f"{name}_x": [0, 10, 20, 40] for name in ("clamp", "tcp", "programmed", "hit")},
    **{f"{name}_y": [0, 0, 0, 0] for name in ("clamp", "tcp", "programmed", "hit")},
    **{f"{name}_z": [0, 0, 0, 0] for name in ("tcp", "programmed", "hit")},
    "clamp_z": [100, 100, 100, 100],
}  # fmt: skip
VIEWS = [
    {"name": "tilt", "x": "X in mm", "y": "Z in mm", "right": [1, 0, 0], "up": [0, 0, 1]},
    {"name": "path", "x": "Y in mm", "y": "Z in mm", "right": [0, 1, 0], "up": [0, 0, 1]},
    {"name": "from above", "x": "X in mm", "y": "Y in mm", "right": [1, 0, 0], "up": [0, 1, 0]},
]
ABOUT = {"rows": 4, "near_mm": 5, "views": VIEWS, "ideal": [],
         "planes": [{"begin_ms": 0, "normal": [0, 0, 1], "at_mm": 0}]}  # fmt: skip
PAGE = f"""{ELEMENTS}
const at = [];
let now = 0, next = null;
const signals = {json.dumps(SIGNALS)};
globalThis.axisrigPlots = {{decode: () => signals, point: (plots, ms) => at.push(ms)}};
globalThis.performance = {{now: () => now}};
globalThis.requestAnimationFrame = (act) => {{ next = act; return 1; }};
globalThis.cancelAnimationFrame = () => {{ next = null; }};
const node = new Shown("div");
node.clientWidth = 600;
node.dataset.about = JSON.stringify({json.dumps(ABOUT)});
const parts = {{}};
for (const [tag, name] of [["input", ""], ["output", ""], ["button", "tv-play"],
    ["div", "tv-views"], ["div", "tv-side"], ["div", "tv-near"]]) {{
  parts[name || tag] = new Shown(tag);
  parts[name || tag].className = name;
  node.append(parts[name || tag]);
}}
const plots = {{}};
"""
READ = """
const tool = axisrigTool.make(node, plots);
const row = () => parts.input.value;
const words = () => parts.output.textContent;
const slide = (to) => { parts.input.value = String(to); parts.input.fire("input"); };
const play = () => parts["tv-play"].fire("click");
const frame = (ms) => { now = ms; const act = next; next = null; act(ms); };
const views = () => parts["tv-views"].children;
"""


def read(what: str) -> Any:
    return value_in_node(f"((() => {{ {READ} return {what}; }})())", [SCRIPT], PAGE)


def test_it_begins_where_the_tool_is_inclined_most() -> None:
    """The first of such instants; the slider goes over all of them."""
    assert read('[row(), parts.input.max, parts.input.set["aria-valuetext"]]') == [1, 3, "10.0 ms"]


def test_an_instant_has_its_values_in_words_and_what_is_not_known_is_left_out() -> None:
    assert read("[0, 1, 2, 3].map((to) => (slide(to), words()))") == [
        "t 0.0 ms · tilt 0.0000° · L2 100.0000 mm",
        "t 10.0 ms · tilt 30.0000° · L2 100.5000 mm · h 1.5000 mm · o -0.2500 mm"
        " · beam ends 12.3 µm above the surface",
        "t 20.0 ms · tilt 15.0000° · L2 101.0000 mm · o 0.0000 mm · o/cos b 0.5000 mm"
        " · beam ends 2.0 µm below the surface",
        "t 40.0 ms · tilt 30.0000° · L2 102.0000 mm · h 0.0000 mm"
        " · beam ends 0.0 µm below the surface",
    ]  # fmt: skip


def test_the_slider_points_at_its_instant_in_the_plots() -> None:
    assert read("[3, 0].map((to) => (slide(to), [row(), at.at(-1)]))") == [[3, 40], [0, 0]]


def test_the_cursor_of_the_plots_chooses_the_nearest_instant() -> None:
    """Halfway the later one; outside of the run, and without a cursor, it stays."""
    places = [0, 4.9, 5, 14.9, 29.9, 30, 40, 40.1, -0.1, None, 20]
    found = read(f"{json.dumps(places)}.map((ms) => (plots.pointed(ms), row()))")
    assert found == [0, 0, 1, 1, 2, 3, 3, 3, 3, 3, 2]
    assert read("(plots.pointed(20), at)") == []


def test_it_plays_from_its_instant_to_the_end_and_then_from_the_begin() -> None:
    """All of the run would take 5 s: from 20 ms on, half of it."""
    steps = "(ms) => (frame(ms), [row(), parts['tv-play'].textContent])"
    anew = f"(now = 3000, play(), {steps})(3000)"
    found = read(f"(slide(2), play(), [...[0, 1250, 2499, 2500].map({steps}), {anew},"
                 f" ...[4249, 4250, 5500].map({steps})])")  # fmt: skip
    assert found == [[2, "stop"], [2, "stop"], [2, "stop"], [3, "play"],
                     [0, "stop"], [0, "stop"], [1, "stop"], [2, "stop"]]  # fmt: skip


def test_play_is_stopped_by_its_button_and_by_the_slider() -> None:
    state = "[parts['tv-play'].textContent, next === null]"
    assert read(f"[(play(), {state}), (play(), {state}), (play(), slide(0), {state}),"
                f" (play(), tool.remove(), {state})]") == [
        ["stop", False], ["play", True], ["play", True], ["play", True],
    ]  # fmt: skip


def test_each_projection_has_a_button_and_from_above_there_is_no_height() -> None:
    state = "[views().map((one) => one.set['aria-pressed']), parts['tv-near'].children.length," \
            " parts['tv-side'].children[0].set['aria-label']]"  # fmt: skip
    assert read("views().map((one) => one.textContent)") == [
        "plane of the tilt", "along the path", "from above",
    ]  # fmt: skip
    assert read(f"views().map((one) => (one.fire('click'), {state}))") == [
        [["true", "false", "false"], 1, "Tool from the side, Z in mm over X in mm"],
        [["false", "true", "false"], 1, "Tool from the side, Z in mm over Y in mm"],
        [["false", "false", "true"], 0, "Tool from the side, Y in mm over X in mm"],
    ]  # fmt: skip
