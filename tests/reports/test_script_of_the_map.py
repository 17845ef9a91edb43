"""The map of a campaign, as its script draws it, and which cell a pointer or a key means.

The script runs in node; a letter of a word is 5 px wide, and a canvas writes down what is drawn.
"""

import json
from pathlib import Path
from typing import Any

import pytest
from tests.page_scripts import ELEMENTS, needs_node, value_in_node

from axisrig.reports.campaign_map import section

pytestmark = needs_node

SCRIPT = Path(section.__file__).with_name("map.js")
PAGE = f"""{ELEMENTS}
const made = [];
const createElement = document.createElement;
document.createElement = (tag) => {{
  const element = createElement(tag);
  if (tag !== "canvas") return element;
  made.push(element);
  element.drawn = [];
  const ctx = {{measureText: (text) => ({{width: 5 * text.length}})}};
  for (const name of ["scale", "translate"])
    ctx[name] = (...all) => element.drawn.push([name, ...all]);
  ctx.fillRect = (...all) => element.drawn.push(["box", ctx.fillStyle, ...all]);
  ctx.strokeRect = (...all) => element.drawn.push(["frame", ctx.strokeStyle, ...all]);
  ctx.fillText = (text, x, y) => element.drawn.push(["text", text, ctx.fillStyle, x, y]);
  ctx.drawImage = (stamp, ...all) => element.drawn.push(["cell", stamp.drawn.at(-1)[1], ...all]);
  element.getContext = () => ctx;
  element.getBoundingClientRect = () => ({{left: 10, top: 20}});
  return element;
}};
const place = new Shown("div"), opened = [];
place.clientWidth = 100;
for (const name of ["map-at", "map-plans"]) {{
  const inside = new Shown("div");
  inside.className = name;
  place.append(inside);
}}
const words = () => place.querySelector(".map-at").textContent;
let maps = null;
const canvas = (n = 0) => maps.plans[n].canvas;
function start(data) {{
  maps = axisrigMap.make(place, data, (id) => opened.push(id));
  maps.draw();
}}
function last(kind, n = 0) {{  // what was drawn since the last time that all of it was
  const all = canvas(n).drawn;
  const begin = all.findLastIndex(([name]) => name === "translate");
  return all.slice(begin).filter(([name]) => name === kind);
}}
function key(...names) {{
  return names.map((key) => {{ canvas().fire("keydown", {{key}}); return words(); }});
}}
"""
VERDICTS = [["pass", "✔"], ["fail", "✘"], ["marginal", "~"], ["error", "!"]]
RUNS = [["r0", "0-0"], ["r1", "110"], ["r2", "0-0"], ["r3", "322"], ["r4", "000"]]


def plan(runs: Any = RUNS, metrics: Any = ("m1", "m22"), name: str = "plan", left: int = 0) -> Any:
    return {"name": name, "metrics": list(metrics), "left_out": left, "runs": runs}


def read(what: str, *plans: Any) -> Any:
    """An expression after the map of these plans has been drawn.

    Three letters are 15 px and the label 21, so that there are five columns of 15 px in 100 px.
    """
    data = json.dumps({"plans": plans or [plan()], "verdicts": VERDICTS})
    return value_in_node(f"(start({data}), {what})", [SCRIPT], PAGE)


def test_each_run_is_a_column_and_each_metric_a_row() -> None:
    """A cell leaves a pixel to the next one."""
    found = read('last("cell")')
    columns = [(21 + 15 * number, cells) for number, (_, cells) in enumerate(RUNS)]
    signs = {"-": "", **{str(place): sign for place, (_, sign) in enumerate(VERDICTS)}}
    assert found == [
        ["cell", signs[cells[row]], x, 15 * row, 14, 14] for x, cells in columns for row in range(3)
    ]


def test_what_does_not_fit_goes_on_in_a_line_below() -> None:
    """Two columns in 54 px, of which 21 are for the label; three rows of 15 px and a gap of 6."""
    read_ = '[last("cell").filter((one, n) => n % 3 === 0).map((one) => one.slice(2, 4)),' \
            " canvas().style, canvas().width, canvas().height]"  # fmt: skip
    cells, style, width, height = read(f"(place.clientWidth = 54, resized(), {read_})")
    assert cells == [[21, 0], [36, 0], [21, 51], [36, 51], [21, 102]]
    assert style == {"width": "51px", "height": "151px"}
    assert (width, height) == (51, 151)


def test_a_dense_screen_has_more_pixels_for_the_same_size() -> None:
    scale = 'canvas().drawn.filter(([name]) => name === "scale").at(-1)'
    sizes = f"[canvas().width, canvas().style.width, {scale}]"
    assert read(f"(globalThis.devicePixelRatio = 2, maps.draw(), {sizes})") == [
        192, "96px", ["scale", 2, 2],
    ]  # fmt: skip


def test_of_many_runs_the_cells_are_smaller_also_where_few_of_them_are_left() -> None:
    few = [[f"r{number}", "000"] for number in range(60)]
    many = [*few, ["r60", "000"]]
    size = 'last("cell")[0].at(-1)'
    both = f'[{size}, (maps.filter((id) => id === "r1"), {size})]'
    assert read(both, plan(few)) == [14, 14]
    assert read(both, plan(many)) == [9, 9]


def test_each_row_has_its_name_shortened_to_its_room() -> None:
    """A third of 100 px: six letters; the run in ink, metrics in a soft colour; for each line."""
    found = read('last("text")', plan(metrics=("metric", "metrics")))
    names = [("run", "--ink", 7.5), ("metric", "--soft", 22.5), ("metri…", "--soft", 37.5)]
    assert found == [
        ["text", name, ink, 34, top + y] for top in (0, 51) for name, ink, y in names
    ]  # fmt: skip


def pointed(*places: tuple[float, float], then: str = "words()") -> list[Any]:
    """Words of places in px of the canvas."""
    move = '{canvas().fire("mousemove", {clientX: 10 + x, clientY: 20 + y}); return ' + then + ";}"
    return list(read(f"{json.dumps(places)}.map(([x, y]) => {move})"))


def test_a_pointer_means_a_cell_and_its_words_are_shown() -> None:
    """The canvas begins 2 px above the first row."""
    assert pointed((21, 2), (35.9, 16.9), (36, 2), (36, 17), (51, 17), (66, 46.9), (95.9, 40)) == [
        "r0: ✔ pass", "r0: ✔ pass", "r1: ✘ fail", "r1 · m1: ✘ fail", "r2 · m1: no such check",
        "r3 · m22: ~ marginal", "r4 · m22: ✔ pass",
    ]  # fmt: skip


def test_outside_of_the_cells_nothing_is_meant() -> None:
    outside = [(20.9, 10), (96, 10), (30, 1.9), (30, 47), (30, 60)]
    assert pointed((30, 10), *outside) == ["r0: ✔ pass", *[""] * len(outside)]


def test_the_gap_between_lines_and_the_rest_of_the_last_one_are_outside() -> None:
    places = [(21, 2), (36, 53), (21, 104), (36, 104), (21, 47.5), (21, 52.9)]
    move = '{canvas().fire("mousemove", {clientX: 10 + x, clientY: 20 + y}); return words();}'
    found = read(
        f"(place.clientWidth = 54, resized(), {json.dumps(places)}.map(([x, y]) => {move}))"
    )
    assert found == ["r0: ✔ pass", "r3: ! error", "r4: ✔ pass", "", "", ""]


def test_a_click_opens_the_run_of_its_cell() -> None:
    click = 'canvas().fire("click", {clientX: 10 + x, clientY: 30})'
    assert read(f"([21, 36, 10, 200].forEach((x) => {click}), opened)") == ["r0", "r1"]


def test_arrow_keys_choose_a_cell_and_stay_inside() -> None:
    """The first one chooses the first cell; Enter opens the run of it."""
    steps = ["Right", "Right", "Down", "Down", "Down", "Up", "Left", "Left"]
    pressed = ["Enter", *(f"Arrow{step}" for step in steps), "x", "ArrowRight", "Enter"]
    assert read(f"[...key(...{json.dumps(pressed)}), opened]") == [
        "", "r0: ✔ pass", "r1: ✘ fail", "r1 · m1: ✘ fail", "r1 · m22: ✔ pass", "r1 · m22: ✔ pass",
        "r1 · m1: ✘ fail", "r0 · m1: no such check", "r0 · m1: no such check",
        "r0 · m1: no such check", "r1 · m1: ✘ fail", "r1 · m1: ✘ fail", ["r1"],
    ]  # fmt: skip
    assert read('key(..."ArrowRight ".repeat(6).trim().split(" "))')[-2:] == ["r4: ✔ pass"] * 2


@pytest.mark.parametrize("key", ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"])
def test_each_arrow_begins_at_the_first_cell(key: str) -> None:
    assert read(f'key("{key}")') == ["r0: ✔ pass"]


def test_the_chosen_cell_has_a_frame_and_loses_it_with_the_focus() -> None:
    frame = '[last("frame"), words()]'
    chosen = 'key("ArrowDown", "ArrowDown", "ArrowRight")'
    assert read(f'[({chosen}, {frame}), (canvas().fire("blur"), {frame})]') == [
        [[["frame", "--ink", 35, 14, 16, 16]], "r1 · m1: ✘ fail"], [[], ""],
    ]  # fmt: skip


def test_when_the_pointer_leaves_the_words_of_the_chosen_cell_come_back() -> None:
    moves = 'canvas().fire("mousemove", {clientX: 31, clientY: 40}), canvas().fire("mouseleave")'
    assert read(f'[({moves}, words()), (key("ArrowRight", "ArrowRight"), {moves}, words()),'
                " canvas().title]") == ["", "r1: ✘ fail", "r1: ✘ fail"]  # fmt: skip


def test_what_is_filtered_away_is_not_drawn_and_not_counted() -> None:
    """A plan without any run is hidden, until one of them is shown again."""
    plans = [plan(), plan([["s0", "111"]], name="other")]
    label = 'canvas().set["aria-label"].split(".")[0]'
    shown = '[maps.plans.map((one) => one.figure.hidden), last("cell").length / 3,' \
            f' {label}, key("ArrowRight", "ArrowRight").at(-1)]'  # fmt: skip
    filters = ['id !== "s0" && id !== "r0"', 'id === "s0"', "true"]
    ands = ", ".join(f"(maps.filter((id) => {one}), {shown})" for one in filters)
    first, second, third = read(f"[{ands}]", *plans)
    rest = "4 runs across, 2 metrics down: 2 pass, 1 fail, 1 error"
    assert first == [[False, True], 4, f"plan: {rest}", "r2: ✔ pass"]
    assert second[0] == [True, False]
    all_of = "5 runs across, 2 metrics down: 3 pass, 1 fail, 1 error"
    assert third == [[False, False], 5, f"plan: {all_of}", "r1: ✘ fail"]


def test_a_caption_counts_the_runs_by_their_own_verdict() -> None:
    caption = "maps.plans[0].caption.textContent"
    assert read(caption) == "plan 3 pass, 1 fail, 1 error"
    assert read(caption, plan(left=3)) == "plan 3 pass, 1 fail, 1 error, 3 metrics more"


def test_a_sign_has_the_colour_of_its_verdict_and_an_ink_that_can_be_read() -> None:
    """Yellow is bright: its sign is dark."""
    drawn = "made.slice(1).map((one) => one.drawn.slice(-2).map((each) => each.slice(1, 3)))"
    assert read(drawn)[:5] == [
        [["--faint", 0], ["", ""]], [["--pass", 0], ["✔", "#ffffff"]],
        [["--fail", 0], ["✘", "#ffffff"]], [["--marginal", 0], ["~", "#1a1f26"]],
        [["--error", 0], ["!", "--error-ink"]],
    ]  # fmt: skip


def test_it_is_drawn_anew_when_its_width_changes_and_not_else() -> None:
    times = 'canvas().drawn.filter(([name]) => name === "translate").length'
    assert read(f"[{times}, (resized(), {times}), (place.clientWidth = 60, resized(), {times}),"
                f" (resized(), {times}), (place.clientWidth = 0, resized(), {times})]") == [
        1, 1, 2, 2, 2,
    ]  # fmt: skip
