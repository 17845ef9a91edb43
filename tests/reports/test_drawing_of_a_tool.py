"""What the side view of a tool draws: places in equal scales, surface, beam, head and ghosts.

The script runs in node. A picture of 600 px has 52 px at its left and 12 px at its right, 10 px
above and 34 px below; the head of the tool needs 30 px more. The tool is above a workpiece of two
planes, the second one from 20 ms on.
"""

import json
import math
import re
from functools import cache
from itertools import pairwise
from typing import Any

import pytest
from tests.page_scripts import ELEMENTS, needs_node, value_in_node
from tests.reports.test_script_of_the_tool import PAGE, READ, SCRIPT, SIGNALS, VIEWS

pytestmark = needs_node

X = [5, 10, 20, 45]
UP = (0.6, 0.8)
"""The second plane has the normal (-0.6, 0, 0.8) and is 4 mm from the origin."""
DEPTH = [0.1, 0.002, 0.0004, 7.0]
POINTS: dict[str, Any] = {
    **{f"{name}_x": X for name in ("clamp", "tcp", "programmed", "hit")},
    **{f"{name}_y": [2, 2, 2, 2] for name in ("clamp", "tcp", "programmed", "hit")},
    "clamp_z": [100] * 4, "tcp_z": [0, 0, 1, 1], "programmed_z": [0, -1, 1, 3],
    "hit_z": [0.5, 0.25, None, 2], "distance": [None, 99.5, 50, 30], "depth": DEPTH,
    "at_work": [0, 1, 1, 1],
}  # fmt: skip
PLANES = [{"begin_ms": 0, "normal": [0, 0, 1], "at_mm": -3},
          {"begin_ms": 20, "normal": [-0.6, 0, 0.8], "at_mm": 4}]  # fmt: skip
ABOUT = {"rows": 4, "near_mm": 5, "views": VIEWS, "planes": PLANES,
         "ideal": [{"normal": [0, 0, 1], "at_mm": 7}]}  # fmt: skip
LOOK = """
const look = (name) => (parts[name].children[0]?.every ?? []).map((one) =>
  ({tag: one.tag, words: one.textContent, ...one.set}));
const whole = (name) => parts[name].children[0]?.set ?? null;
"""


VARIANTS: dict[str, dict[str, Any]] = {
    "plain": {},
    "wide": {f"{name}_x": [0, 500, 1000, 2000] for name in ("clamp", "tcp", "programmed", "hit")},
    "shallow": {"depth": [0.1, 0.0005, 0.1, 0.1]},
    "lean": {"tcp_x": [-95, -90, -80, -55], "tcp_z": [0, 0, 0, 0]},
    "flat": {"tcp_z": [0] * 4, "hit_z": [0] * 4, "programmed_z": [0, 0.001, 0.001, 0]},
    "without planes": {},
    "900 px": {},
    "neither": {"hit_z": [None] * 4, "offset": [0, 0, None, 0]},
    "an offset": {"hit_z": [None] * 4, "offset": [0, 0, -0.5, 0]},
    "a surface": {"hit_z": [None, None, None, 1], "offset": [0, 0, 0, 0]},
    "no work": {"at_work": [0, 0, 0, 0]},
    "above": {"depth": [-5.0, -4.9, 4.9, 5.0], "hit_z": [1, 1, 1, 1]},
}
"""What differs from the signals above."""


def page_of(name: str) -> str:
    signals = {**SIGNALS, **POINTS, **VARIANTS[name]}
    signals["hit_x"] = [None if z is None else x for x, z in
                        zip(signals["hit_x"], signals["hit_z"], strict=True)]  # fmt: skip
    about = ABOUT | ({"planes": [], "ideal": []} if name == "without planes" else {})
    page = PAGE.removeprefix(ELEMENTS).replace(json.dumps(SIGNALS), json.dumps(signals))
    begin, _, end = page.partition("node.dataset.about = JSON.stringify(")
    page = f"{begin}node.dataset.about = JSON.stringify({json.dumps(about)}{end[end.index(');') :]}"
    return page.replace("clientWidth = 600", "clientWidth = 900") if name == "900 px" else page


@cache
def every_picture() -> Any:
    """The elements of both pictures: of each variant, view and instant."""
    act = "(view) => (view.fire('click'), [0, 1, 2, 3].map((to) => (slide(to), {" \
          "side: look('tv-side'), near: look('tv-near')," \
          " frames: [whole('tv-side'), whole('tv-near')]})))"  # fmt: skip
    made = [f"[{json.dumps(name)}, (() => {{ {page_of(name)} {READ} {LOOK}"
            f" return views().map({act}); }})()]" for name in VARIANTS]  # fmt: skip
    return value_in_node(f"Object.fromEntries([{', '.join(made)}])", [SCRIPT], ELEMENTS)


def pictures(variant: str = "plain") -> Any:
    return every_picture()[variant]


def of(name: str, view: int = 0, row: int = 0, picture: str = "side") -> list[dict[str, str]]:
    shown = pictures()[view][row][picture]
    return [one for one in shown if name in one.get("class", "").split()]


def numbers(path: str) -> list[float]:
    return [float(text) for text in re.findall(r"-?\d+(?:\.\d+)?", path)]


def places(path: str) -> list[tuple[float, float]]:
    found = numbers(path)
    return list(zip(found[::2], found[1::2], strict=True))


# From the front: X from 5 to 45 and Z from -1 to 100, with 0.05 * 101 + 3 mm of room, and 10 mm
# more below for what the beam cuts. The height decides: 400 px are 101 + 2 * 8.05 + 10 mm.
ROOM = 0.05 * 101 + 3
SCALE = 400 / (101 + 2 * ROOM + 10)
MIDDLE = 52 + (600 - 52 - 12) / 2


def px(x: float, z: float) -> tuple[float, float]:
    """The middle of X is in the middle of the picture, the lowest place at its foot."""
    return MIDDLE + (x - 25) * SCALE, 10 + 430 - (z + 1 + ROOM + 10) * SCALE


def same(found: list[tuple[float, float]], *points: tuple[float, float]) -> None:
    assert len(found) == len(points)
    for one, other in zip(found, points, strict=True):
        assert one == pytest.approx(px(*other), abs=0.06)


ENDS = (25 - 268 / SCALE, 25 + 268 / SCALE)
"""X at both edges of the picture."""


@pytest.mark.long
def test_a_picture_has_equal_scales_and_its_room() -> None:
    side, near = pictures()[0][0]["frames"]
    assert side["viewBox"] == "0 0 600 474"
    assert near["viewBox"] == "0 0 600 194"  # 150 px and what is around them
    (clamp,) = of("tv-clamp")
    same(places(clamp["d"]), *((x, 100) for x in X))


def test_a_wide_way_is_as_wide_as_the_picture_and_a_low_one_is_150_px_high() -> None:
    """X over 2000 mm: 536 px less twice the head are 2000 mm and their room, 103 mm at each end."""
    shown = pictures("wide")[0][0]
    clamps = [each for each in shown["side"] if each.get("class") == "tv-clamp"]
    (first, *_, last) = places(clamps[0]["d"])
    scale = (536 - 60) / (2000 + 2 * 103)
    assert last[0] - first[0] == pytest.approx(2000 * scale, abs=0.11)
    assert (first[0] + last[0]) / 2 == pytest.approx(MIDDLE, abs=0.06)
    assert shown["frames"][0]["viewBox"] == "0 0 600 194"
    assert pictures("900 px")[0][0]["frames"][0]["viewBox"] == "0 0 900 474"


def test_contours_go_through_the_places_of_tip_and_program() -> None:
    (tcp,), (programmed,) = of("tv-tcp"), of("tv-programmed")
    same(places(tcp["d"]), *zip(X, POINTS["tcp_z"], strict=True))
    same(places(programmed["d"]), *zip(X, POINTS["programmed_z"], strict=True))


def test_seven_ghosts_are_even_in_the_rows() -> None:
    """Of 4 rows: 0, 0.5, 1 .. 3, halves upwards."""
    rows = [0, 1, 1, 2, 2, 3, 3]
    lines, dots = of("tv-ghost"), of("tv-dot")
    assert (len(lines), len(dots)) == (7, 7)
    for line, dot, row in zip(lines, dots, rows, strict=True):
        same(places(line["d"]), (X[row], 100), (X[row], POINTS["tcp_z"][row]))
        same([(float(dot["cx"]), float(dot["cy"]))], (X[row], 100))


def test_what_the_beam_cuts_is_10_mm_behind_the_surface_where_it_ends_near() -> None:
    """Rows 0 and 1 end near to it; of row 2 nothing is known, and row 3 ends 7 mm below."""
    (cut,) = of("tv-cut")
    same(places(cut["d"]), (5, 0.5), (5, -9.5), (10, -9.75), (10, 0.25))
    (deep,) = of("tv-deep")  # more than half a micrometre, from the surface to the tip
    same(places(deep["d"]), (5, 0.5), (5, 0), (10, 0), (10, 0.25))
    found = [one["d"] for one in pictures("shallow")[0][0]["side"] if one.get("class") == "tv-deep"]
    assert found == [""]


def test_planes_of_the_workpiece_and_ideal_ones_go_through_the_whole_picture() -> None:
    """z = -3 and z = (4 + 0.6 x)/0.8; ideal is z = 7. A workpiece is filled down to the foot."""
    works, edges, (ideal,) = of("tv-work"), of("tv-other"), of("tv-ideal")
    heights = [[-3, -3], [(4 + UP[0] * x) / UP[1] for x in ENDS]]
    assert (len(works), len(edges)) == (2, 2)
    for work, edge, (first, last) in zip(works, edges, heights, strict=True):
        same(places(edge["d"]), (ENDS[0], first), (ENDS[1], last))
        assert work["d"].startswith(edge["d"])
        foot, left = numbers(work["d"])[4:]
        assert (foot, left) == pytest.approx((440.0, 52.0))
    same(places(ideal["d"]), (ENDS[0], 7), (ENDS[1], 7))


def test_from_the_side_a_plane_is_as_high_as_at_the_begin_of_the_tool() -> None:
    """Along Y the inclined plane is level, at the X of the first TCP: (4 + 0.6 * 5)/0.8 = 8.75."""
    edges = of("tv-other", view=1)
    same_height = [numbers(edge["d"])[1::2] for edge in edges]
    clamps = [y for _, y in places(of("tv-clamp", view=1)[0]["d"])]
    tips = places(of("tv-tcp", view=1)[0]["d"])
    scale = (tips[0][1] - clamps[0]) / 100
    for heights, z in zip(same_height, (-3, 8.75), strict=True):
        for height in heights[:2]:
            assert (tips[0][1] - height) / scale == pytest.approx(z, abs=0.05)


def test_from_above_no_plane_has_a_height_and_no_beam_a_depth_below() -> None:
    """Tip and clamping point are one line, and the picture has no room for what the beam cuts.

    X over 40 mm with 5 mm at each end is 476 px wide: 9.52 px/mm. Y needs 10 mm and the head 30 px,
    less than the 150 px of the lowest picture; 10 mm more for the beam would need 220 px.
    """
    assert pictures()[2][0]["frames"][0]["viewBox"] == "0 0 600 194"
    assert of("tv-work", view=2) == of("tv-other", view=2) == of("tv-ideal", view=2) == []
    assert of("tv-surface", view=2) == []
    assert of("tv-tcp", view=2)[0]["d"] == of("tv-clamp", view=2)[0]["d"]
    bare = pictures("without planes")
    assert [one for one in bare[2][0]["side"] if "tv-surface" in one.get("class", "")] == []


def test_a_surface_without_planes_is_where_the_beam_met_it() -> None:
    bare = pictures("without planes")
    (line,) = [one for one in bare[0][0]["side"] if one.get("class") == "tv-surface"]
    assert re.sub(r"[^ML]", "", line["d"]) == "MLM"
    same(places(line["d"]), (5, 0.5), (10, 0.25), (45, 2))


# The tool at an instant


@pytest.mark.parametrize(("row", "plane"), [(0, 0), (1, 0), (2, 1), (3, 1)])
def test_the_plane_of_an_instant_is_that_of_its_time(row: int, plane: int) -> None:
    (line,) = [one for one in of("tv-surface", row=row) if "tv-other" not in one["class"]]
    heights = [-3, -3] if plane == 0 else [(4 + UP[0] * x) / UP[1] for x in ENDS]
    same(places(line["d"]), (ENDS[0], heights[0]), (ENDS[1], heights[1]))


@pytest.mark.parametrize(
    ("row", "foot"), [(0, None), (1, (10, 0.5)), (2, (20 + 0.6 * 50, 100 - 0.8 * 50)),
                      (3, (45 + 0.6 * 30, 100 - 0.8 * 30))],
)  # fmt: skip
def test_the_distance_is_along_the_normal_of_that_plane(
    row: int, foot: tuple[float, float] | None
) -> None:
    """From the clamping point; where it is not known nothing is drawn."""
    lines = of("tv-distance", row=row)
    assert len(lines) == (foot is not None)
    if foot is not None:
        same(places(lines[0]["d"]), (X[row], 100), foot)


@pytest.mark.parametrize(("row", "is_near"), [(0, True), (1, True), (2, False), (3, False)])
def test_the_beam_goes_from_the_clamp_to_its_tip_and_on_where_it_works(
    row: int, is_near: bool
) -> None:
    (beam,), through = of("tv-beam", row=row), of("tv-through", row=row)
    same(places(beam["d"]), (X[row], 100), (X[row], POINTS["tcp_z"][row]))
    assert len(through) == is_near
    if is_near:
        z = POINTS["hit_z"][row]
        same(places(through[0]["d"]), (X[row], z), (X[row], z - 10))
    for name, height in (("tv-at-tcp", "tcp_z"), ("tv-at-programmed", "programmed_z")):
        (dot,) = of(name, row=row)
        same([(float(dot["cx"]), float(dot["cy"]))], (X[row], POINTS[height][row]))


def test_a_beam_that_ends_5_mm_above_or_below_the_surface_does_not_work_on_it() -> None:
    shown = pictures("above")[0]
    assert [
        any(one.get("class") == "tv-through" for one in picture["side"]) for picture in shown
    ] == [False, True, True, False]


def test_the_head_is_above_the_clamp_in_the_direction_of_the_tool() -> None:
    """6 px wide at the clamping point, 18 px from 14 px on, 30 px long; upright and inclined."""
    (head,) = of("tv-head", row=1)
    x, y = px(10, 100)
    corners = [(-3, 0), (3, 0), (9, -14), (9, -30), (-9, -30), (-9, -14)]
    for found, (right, down) in zip(places(head["d"]), corners, strict=True):
        assert found == pytest.approx((x + right, y + down), abs=0.06)
    # Inclined by 45 degrees towards X: the whole head is at the upper right of the clamp
    (head,) = [one for one in pictures("lean")[0][1]["side"] if one.get("class") == "tv-head"]
    found = places(head["d"])
    (beam,) = [one for one in pictures("lean")[0][1]["side"] if one.get("class") == "tv-beam"]
    (x, y), _ = places(beam["d"])
    (a, b), (c, d) = found[3:5]
    far = (a + c) / 2 - x, (b + d) / 2 - y
    assert far == pytest.approx((30 / math.sqrt(2), -30 / math.sqrt(2)), abs=0.1)


# The picture of the surface


def test_the_contours_at_the_surface_have_a_scale_of_their_own() -> None:
    """While it works: Z of tip, program and surface from -1 to 3, with 12 % of room at each end."""
    (line,) = of("tv-tcp", picture="near")
    room = 0.12 * 4
    scale = 150 / (4 + 2 * room)
    found = places(line["d"])
    for (x, y), at, z in zip(found, X[1:], (0, 1, 1), strict=True):
        assert x == pytest.approx(px(at, 0)[0], abs=0.06)
        assert y == pytest.approx(10 + (3 + room - z) * scale, abs=0.06)
    assert of("tv-cut", picture="near") == of("tv-clamp", picture="near") == []
    labels = [each["aria-label"] for each in pictures()[0][0]["frames"]]
    assert labels == [
        "Tool from the side, Z in mm over X in mm",
        "Contours at the surface, Z in mm with its own scale over X in mm",
    ]


@pytest.mark.parametrize(
    ("variant", "is_there"),
    [("plain", True), ("neither", False), ("an offset", True), ("a surface", True),
     ("no work", False)],
)  # fmt: skip
def test_there_is_a_picture_of_the_surface_where_something_is_to_be_seen(
    variant: str, is_there: bool
) -> None:
    """A surface in any row or an offset, and an instant at which the tool works."""
    assert [bool(view[0]["near"]) for view in pictures(variant)] == [is_there, is_there, False]


def test_a_level_way_has_two_micrometres_of_room_at_least() -> None:
    """1 um of way and 2 um at each end: 150 px are 5 um."""
    shown = pictures("flat")[0][0]["near"]
    (tcp,), (programmed,) = ([one for one in shown if one.get("class") == name]
                             for name in ("tv-tcp", "tv-programmed"))  # fmt: skip
    gap = places(tcp["d"])[0][1] - places(programmed["d"])[0][1]
    assert gap == pytest.approx(0.001 * 150 / 0.005, abs=0.11)


def test_ticks_are_round_and_a_picture_names_both_directions() -> None:
    """A tick each 90 px to the right and each 45 px upwards at most, by 1, 2 or 5."""
    texts = [one for one in pictures()[0][0]["side"] if one["tag"] == "text"]
    below = [float(one["words"]) for one in texts if one.get("text-anchor") == "middle"]
    beside = [float(one["words"]) for one in texts if one.get("text-anchor") == "end"
              and one["words"] != "X in mm"]  # fmt: skip
    for found, ends, count in (
        (below, ENDS, 536 / 90), (beside, (-1 - ROOM - 10, 430 / SCALE - 1 - ROOM - 10), 430 / 45),
    ):  # fmt: skip
        (step,) = {round(b - a, 9) for a, b in pairwise(found)}
        assert step / 10 ** math.floor(math.log10(step)) in (1, 2, 5)
        assert (ends[1] - ends[0]) / step <= count
        finer = step / (2.5 if round(step / 10 ** math.floor(math.log10(step))) == 5 else 2)
        assert (ends[1] - ends[0]) / finer > count
        assert all(ends[0] <= tick <= ends[1] for tick in found)
        assert found[0] - step < ends[0] < ends[1] < found[-1] + step
    for one in texts:
        if one.get("text-anchor") == "middle":
            assert float(one["x"]) == pytest.approx(px(float(one["words"]), 0)[0], abs=0.06)
    assert [one["words"] for one in texts][-2:] == ["X in mm", "Z in mm"]


@pytest.mark.long
def test_a_picture_is_drawn_again_in_another_width_only() -> None:
    act = "(width) => (node.clientWidth = width, resized(), parts['tv-side'].made)"
    widths = [600, 600.4, 700, 0, 700]
    found = value_in_node(
        f"((() => {{ {READ} const first = parts['tv-side'].made;"
        f" return {json.dumps(widths)}.map({act}).map((made) => made - first); }})())",
        [SCRIPT], PAGE,
    )  # fmt: skip
    assert found == [0, 0, 1, 1, 1]
