"""The value under the pointer, as its script finds it in a drawing of dots.

The script runs in node, with a page of two drawings of 100 x 50 units that are shown twice as large
from 10, 20 px on.
"""

import json
from pathlib import Path

from tests.page_scripts import needs_node, value_in_node

from axisrig.reports import build

pytestmark = needs_node

SCRIPT = Path(build.__file__).with_name("points.js")
PAGE = """
let moved = null, boxes = 0;
class Shown {
  constructor(name) { this.name = name; this.classes = new Set(); this.set = {}; }
  get classList() {
    return {add: (name) => this.classes.add(name), remove: (name) => this.classes.delete(name)};
  }
  setAttribute(key, value) { this.set[key] = value; }
  remove() { this.drawing.words = this.drawing.words.filter((one) => one !== this); }
}
globalThis.document = {
  addEventListener: (kind, act) => { if (kind === "pointermove") moved = act; },
  createElementNS: (space, name) => new Shown(name),
};
function dot(name, x, y) {
  const made = new Shown(name);
  made.getBBox = () => { boxes += 1; return {x: x - 3, y: y - 3, width: 6, height: 6}; };
  made.querySelector = () => ({textContent: name});
  return made;
}
function drawing(...dots) {
  const made = {
    words: [],
    querySelectorAll: () => dots,
    viewBox: {baseVal: {width: 100, height: 50}},
    getBoundingClientRect: () => ({left: 10, top: 20, width: 200, height: 100}),
    append(one) { one.drawing = made; made.words.push(one); },
  };
  made.closest = () => made;
  return {made, dots};
}
const pages = [
  drawing(dot("a", 20, 25), dot("b", 30, 25), dot("c", 90, 45)), drawing(dot("d", 50, 25)),
];
const nowhere = {closest: () => null};
function at([page, x, y]) {
  const target = page === null ? nowhere : pages[page].made;
  moved({target, clientX: 10 + 2 * x, clientY: 20 + 2 * y});
  const words = pages.flatMap(({made}) => made.words);
  const near = pages.flatMap(({dots}) => dots).filter((one) => one.classes.has("near"));
  return [words.map((one) => one.textContent), near.map((one) => one.name)];
}
"""


def shown(*moves: tuple[int | None, float, float], also: str = "null") -> list[list[str]]:
    """Words after each move: which drawing, and where in its units. A dot that is near has them."""
    found, more = value_in_node(f"[{json.dumps(moves)}.map(at), {also}]", [SCRIPT], PAGE)
    assert all(words == near for words, near in found)
    return [words for words, _ in found] + ([] if also == "null" else [more])


def test_the_nearest_dot_has_its_words_at_the_top() -> None:
    """Nearest in both directions; of dots as near as another the first."""
    assert shown((0, 20, 25), (0, 24, 25), (0, 26, 25), (0, 25, 25), (0, 88, 40), (0, 40, 45)) == [
        ["a"], ["a"], ["b"], ["a"], ["c"], ["b"],
    ]  # fmt: skip


def test_far_from_every_dot_there_are_no_words() -> None:
    """28 units, wherever: from a at 20, 25 on to the left and up."""
    assert shown((0, 20, 25), (0, -7.9, 25), (0, -8.1, 25), (0, 20, 25), (0, 20, -2.9),
                 (0, 20, -3.1), (0, 59, 25), (0, 0, 4), (0, 0, 6)) == [
        ["a"], ["a"], [], ["a"], ["a"], [], [], [], ["a"],
    ]  # fmt: skip


def test_words_go_with_the_pointer_and_are_there_once() -> None:
    """To another drawing, outside of all of them, and back."""
    outside = (None, 0.0, 0.0)
    assert shown((0, 20, 25), (1, 50, 25), outside, outside, (1, 50, 25), (0, 90, 45)) == [
        ["a"], ["d"], [], [], ["d"], ["c"],
    ]  # fmt: skip


def test_words_are_at_the_right_end_of_the_first_line() -> None:
    place = "[pages[0].made.words[0].set, boxes].map((one) => JSON.stringify(one))"
    *_, (words, boxes) = shown((0, 20, 25), (0, 30, 25), (0, 20, 25), also=place)
    assert json.loads(words) == {"class": "dots-at", "x": 92, "y": 11, "text-anchor": "end"}
    assert json.loads(boxes) == 3  # each dot of a drawing is measured once
