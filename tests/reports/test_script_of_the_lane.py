"""The lane of NC blocks as its script draws it, and which block a pointer means.

The script runs in node, with a canvas that writes down what is drawn: 1 px is 1 ms from 0 to 100.
"""

import json
from pathlib import Path
from typing import Any

from tests.page_scripts import needs_node, value_in_node

from axisrig.reports.blocks import section

pytestmark = needs_node

SCRIPT = Path(section.__file__).with_name("lane.js")
MS = 1_000_000
PAGE = """
globalThis.devicePixelRatio = 1;
globalThis.document = {documentElement: null};
globalThis.getComputedStyle = () => ({getPropertyValue: (name) => name});
const BOX = {left: 0, top: 0, width: 100, height: 40};
function canvas(box = BOX) {
  const drawn = [], ctx = {font: "", fillStyle: ""};
  for (const name of ["save", "restore", "beginPath", "clip", "moveTo", "lineTo", "stroke"])
    ctx[name] = () => {};
  ctx.rect = (x, y, width, high) => drawn.push(["hatch", null, x, y, width, high]);
  ctx.fillRect = (x, y, width, high) => drawn.push(["box", ctx.fillStyle, x, y, width, high]);
  ctx.measureText = (text) => ({width: 5 * text.length});
  ctx.fillText = (text, x, y) => drawn.push(["text", text, x, y]);
  Object.defineProperty(ctx, "strokeStyle", {set(colour) { drawn.at(-1)[1] = colour; }});
  return {drawn, ctx, bbox: box, valToPos: (ms) => ms};
}
"""


def node(script: str) -> Any:
    """The value of an expression after the script of the lane."""
    return value_in_node(script, [SCRIPT], PAGE)


def row(at: int, due: float, begin: float, end: float, number: int = 0, group: str = "motion",
        label: str = "N1 G1") -> list[Any]:  # fmt: skip
    """A block of a lane; times in ms."""
    return [at, due * MS, begin * MS, end * MS, group, number, label]


ROWS = [
    row(0, 0, 0, 10),
    row(1, 10, 12, 20),  # waits for 2 ms
    row(2, 20, 20, 60),
    row(3, 25, 25, 90, number=1),  # an axis beside the path
    row(4, 30, 30, 50),  # blocks that overlap, as those of two nested programs
    row(5, 40, 40, 45),
    row(6, 60, 60, 60),  # takes no time
    row(7, 60, 60, 80),
    row(8, 80, 80, 80),
]


def found_at(*places: tuple[float, int | None]) -> list[int | None]:
    state = json.dumps({"chart": {"blocks": {"rows": ROWS}}})
    given = json.dumps(places)
    return list(
        node(f"{given}.map(([ms, number]) => axisrigBlocks.at({state}, ms, number)?.[0] ?? null)")
    )


def test_of_blocks_that_overlap_the_last_one_that_has_begun_is_meant() -> None:
    places = [(21, 0), (31, 0), (39.9, 0), (40, 0), (44.9, 0), (45, 0), (49, 0), (50, 0), (59, 0)]
    assert found_at(*places) == [2, 4, 4, 5, 5, 4, 4, 2, 2]


def test_a_block_is_meant_from_its_due_time_up_to_its_end() -> None:
    """While it waits too; one without a length at its instant, and none outside."""
    places = [(0, 0), (9.99, 0), (10, 0), (11, 0), (12, 0), (60, 0), (60.1, 0), (80, 0), (80.1, 0),
              (-1, 0), (95, 0)]  # fmt: skip
    assert found_at(*places) == [0, 0, 1, 1, 1, 7, 7, 8, None, None, None]


def test_a_lane_has_its_own_blocks() -> None:
    """Without the number of a lane, of all."""
    assert found_at((31, 0), (31, 1), (31, 2), (31, None), (85, 0), (85, 1), (85, None)) == [
        4, 3, None, 4, None, 3, 3,
    ]  # fmt: skip


def drawn(rows: list[Any], lanes: int = 1, holds: Any = (), box: str = "BOX") -> list[Any]:
    chart = json.dumps({"chart": {"blocks": {"rows": rows, "lanes": lanes, "holds": holds}}})
    return list(
        node(f"(() => {{ const u = canvas({box}); axisrigBlocks.lane({chart})(u);"
             " return u.drawn; })()")
    )  # fmt: skip


def all_drawn(*rows: list[Any]) -> list[Any]:
    """What each of several blocks draws where it is alone."""
    charts = json.dumps(
        [{"chart": {"blocks": {"rows": [one], "lanes": 1, "holds": []}}} for one in rows]
    )
    return list(
        node(f"{charts}.map((state) => {{ const u = canvas(); axisrigBlocks.lane(state)(u);"
             " return u.drawn; })")
    )  # fmt: skip


def test_a_block_is_a_box_with_its_word_and_what_it_waited_is_hatched() -> None:
    """The lane is 40 px high; a pixel is left on each side of a box."""
    assert drawn([row(0, 10, 20, 70, label="N2 G1 X")]) == [
        ["hatch", "--block-wait", 10, 1, 10, 38],
        ["box", "--block-motion", 20, 1, 49, 38],
        ["text", "N2 G1 X", 24, 20],
    ]


def test_a_word_is_shortened_or_left_out_where_it_has_no_room() -> None:
    """A letter has 5 px and a word 4 px on each side: 45 + 8 for all of it, 15 + 8 for N20."""
    ends = (64, 63, 34, 33)
    found = all_drawn(*(row(0, 10, 10, end, label="N20 G1 X1") for end in ends))
    words = [[each[1] for each in one if each[0] == "text"] for one in found]
    assert words == [["N20 G1 X1"], ["N20"], ["N20"], []]


def test_lanes_are_one_below_the_other() -> None:
    found = drawn([row(0, 0, 0, 50, number=0), row(1, 0, 0, 50, number=1, group="wait")], lanes=2)
    boxes = [each for each in found if each[0] == "box"]
    assert boxes == [
        ["box", "--block-motion", 0, 1, 49, 18],
        ["box", "--block-wait", 0, 21, 49, 18],
    ]
    assert [each[3] for each in found if each[0] == "text"] == [10, 30]


def test_a_block_without_length_is_a_short_line_and_has_no_word() -> None:
    """At the border of the plot it is left out; one that only waited keeps its word."""
    places = ((30, 30), (0, 0), (100, 100), (10, 60))
    assert all_drawn(*(row(0, due, begin, begin) for due, begin in places)) == [
        [["box", "--soft", 30, 20, 1, 19]],
        [],
        [],
        [["hatch", "--block-wait", 10, 1, 50, 38], ["text", "N1 G1", 14, 20]],
    ]


def test_what_is_outside_of_the_view_ends_at_its_border() -> None:
    box = "{left: 40, top: 0, width: 20, height: 40}"
    found = drawn([row(0, 0, 30, 90), row(1, 0, 10, 35)], box=box)
    assert [each for each in found if each[0] == "box"] == [
        ["box", "--block-motion", 40, 1, 19, 38]
    ]
    assert [each for each in found if each[0] == "hatch"] == []


def test_feedholds_are_hatched_over_the_lane_of_the_path() -> None:
    """The first one: axes beside the path go on."""
    holds = [[10 * MS, 30 * MS], [50 * MS, 50 * MS], [90 * MS, 200 * MS]]
    assert drawn([], lanes=2, holds=holds) == [
        ["hatch", "--limit", 10, 0, 20, 20], ["hatch", "--limit", 90, 0, 10, 20],
    ]  # fmt: skip


def test_the_stretch_of_the_chosen_block_is_marked() -> None:
    """Two pixels at least, and as far as it is in the view."""
    chosen = (None, (20, 50), (30, 30), (-50, 20), (80, 300), (100, 300))
    states = json.dumps([{"chosen": one and [ms * MS for ms in one]} for one in chosen])
    found = node(f"{states}.map((state) => {{ const u = canvas(); axisrigBlocks.band(state)(u);"
                 " return u.drawn; })")  # fmt: skip
    boxes = [(20, 30), (30, 2), (0, 20), (80, 20)]
    assert found == [
        [], *([["box", "--chosen", left, 0, width, 40]] for left, width in boxes), [],
    ]  # fmt: skip
