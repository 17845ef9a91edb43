"""Views, instants and surfaces of the side view of a tool, from motions in round numbers."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.reports.kinematics.scene import (
    INSTANTS,
    NEAR_MM,
    PLANES,
    at_work,
    ideal,
    instants,
    path_direction,
    planes,
    projections,
    tilt_direction,
)

MS = 1_000_000


def motion(rows: int = 100, **parts: Any) -> Any:
    """Stands at the origin, upright, without distance control and surface."""
    still = np.zeros((rows, 3))
    known = {
        "times_ns": np.arange(rows) * MS, "clamp_mm": still, "tcp_mm": still,
        "programmed_mm": still, "hit_mm": np.full((rows, 3), np.nan),
        "distance_mm": np.full(rows, np.nan), "depth_mm": np.full(rows, np.nan),
        "is_on": np.zeros(rows, dtype=bool), "tilt_deg": np.zeros(rows),
        "direction": np.tile([0.0, 0.0, -1.0], (rows, 1)), "set_pos_mm": np.full(rows, np.nan),
    }  # fmt: skip
    return SimpleNamespace(**{**known, **parts})


def along(rows: int, *way: float) -> Any:
    """From the origin to a place, evenly."""
    return np.linspace(0.0, 1.0, rows)[:, None] * np.array(way)


@pytest.mark.parametrize(
    ("way", "words"),
    [
        ((10, 0, 0), (1.0, 0.0)), ((-10, 0, 0), (1.0, 0.0)), ((0, -5, 0), (0.0, 1.0)),
        ((3, 4, 0), (0.6, 0.8)), ((-3, -4, 9), (0.6, 0.8)), ((3, -4, 0), (-0.6, 0.8)),
        ((-4, 3, 0), (0.8, -0.6)), ((0, 0, 50), None), ((0.99, 0, 0), None),
        ((1.01, 0, 0), (1.0, 0.0)),
    ],
)  # fmt: skip
def test_the_path_is_looked_at_along_its_longest_level_way(
    way: tuple[float, float, float], words: tuple[float, float] | None
) -> None:
    """From 1 mm on; its larger part is positive."""
    found = path_direction(motion(programmed_mm=along(100, *way)))
    assert found == (None if words is None else pytest.approx((*words, 0.0)))


@pytest.mark.parametrize(
    ("tilt_deg", "lean", "found"),
    [
        (0.9, (1.0, 0.0), None), (1.1, (1.0, 0.0), (1.0, 0.0)), (30.0, (-0.3, 0.4), (-0.6, 0.8)),
        (30.0, (0.0, -0.5), (0.0, 1.0)), (30.0, (-0.4, 0.3), (0.8, -0.6)),
    ],
)  # fmt: skip
def test_the_plane_of_the_tilt_is_where_the_tool_leans_most(
    tilt_deg: float, lean: tuple[float, float], found: tuple[float, float] | None
) -> None:
    """The row of the largest tilt counts, in the midst of others."""
    tilts, directions = np.full(9, tilt_deg / 2), np.tile([0.5, 0.5, -0.7], (9, 1))
    tilts[4], directions[4] = tilt_deg, (*lean, -0.8)
    made = tilt_direction(motion(9, tilt_deg=tilts, direction=directions))
    assert made == (None if found is None else pytest.approx((*found, 0.0)))


def test_views_have_their_names_in_words() -> None:
    tilts, directions = np.full(9, 30.0), np.tile([0.3, 0.4, -0.8], (9, 1))
    made = motion(9, tilt_deg=tilts, direction=directions, programmed_mm=along(9, 0, 7, 0))
    assert [(view["name"], view["x"], view["y"]) for view in projections(made)] == [
        ("tilt", "level way at 53.13° from X to Y, in mm", "Z in mm"),
        ("path", "Y in mm", "Z in mm"),
        ("X-Z", "X in mm", "Z in mm"),
        ("Y-Z", "Y in mm", "Z in mm"),
        ("X-Y", "X in mm", "Y in mm"),
    ]
    assert [view["name"] for view in projections(motion())] == ["X-Z", "Y-Z", "X-Y"]
    assert projections(made)[0]["up"] == (0.0, 0.0, 1.0)
    assert projections(made)[-1]["up"] == (0.0, 1.0, 0.0)


def test_few_rows_are_all_shown_and_of_many_the_first_the_last_and_every_move() -> None:
    """10 rows of motion among 5000 have half of the instants."""
    assert list(instants(motion(INSTANTS))) == list(range(INSTANTS))
    places = np.zeros((5000, 3))
    places[2000:2010, 0] = np.arange(1, 11)
    places[2010:, 0] = 10.0
    for name in ("clamp_mm", "tcp_mm"):
        rows = instants(motion(5000, **{name: places}))
        assert (rows[0], rows[-1]) == (0, 4999)
        assert len(rows) <= INSTANTS
        assert set(range(2000, 2010)) <= set(rows.tolist())
    still = instants(motion(5000))
    assert len(still) == INSTANTS // 2
    assert set(np.diff(still)) <= {4999 // (INSTANTS // 2 - 1), 4999 // (INSTANTS // 2 - 1) + 1}


def test_the_picture_is_about_the_control_or_what_is_usually_near() -> None:
    on = np.arange(100) >= 40
    depth = np.full(100, 1.0)
    assert (at_work(motion(is_on=on, depth_mm=depth)) == on).all()
    assert at_work(motion()).all()  # no surface
    depth[:10], depth[10:20] = np.nan, -50.0
    near = at_work(motion(depth_mm=depth))
    assert list(np.flatnonzero(~near)) == list(range(20))
    depth[:20] = 1.0
    far = np.full(100, 2 * NEAR_MM)
    assert not at_work(motion(depth_mm=far)).any()
    assert at_work(motion(depth_mm=-depth)).all()


# Surfaces


def over(*heights_mm: float, rows: int = 100, slope: float = 0.0) -> Any:
    """Readings of a plane z = height + slope x that steps from height to height on the way.

    The beam goes straight down from 50 mm above the origin along X; the distance is along the
    normal.
    """
    x = np.linspace(0.0, 40.0, rows)
    height = np.repeat(heights_mm, -(-rows // len(heights_mm)))[:rows]
    hit = np.stack([x, np.zeros(rows), height + slope * x], axis=-1)
    clamp = hit + np.array([0.0, 0.0, 50.0])
    distance = np.full(rows, 50.0 / np.hypot(1.0, slope))
    return motion(rows, hit_mm=hit, clamp_mm=clamp, distance_mm=distance)


def test_a_workpiece_that_steps_is_a_plane_for_each_height() -> None:
    found = planes(over(3.0, 5.0, 4.0, rows=99))
    assert [(each["begin_ms"], each["at_mm"]) for each in found] == [
        (0.0, 3.0), (33.0, 5.0), (66.0, 4.0),
    ]  # fmt: skip
    assert all(each["normal"] == [0.0, 0.0, 1.0] for each in found)


def test_readings_that_are_missing_are_left_out() -> None:
    made = over(3.0, 5.0)
    made.distance_mm[:10] = np.nan
    made.hit_mm[60:] = np.nan
    assert [each["begin_ms"] for each in planes(made)] == [10.0, 50.0]
    assert planes(motion()) == []


def test_more_heights_than_planes_are_none() -> None:
    assert len(planes(over(*range(PLANES), rows=10 * PLANES))) == PLANES
    assert planes(over(*range(PLANES + 1), rows=10 * (PLANES + 1))) == []


def guide(
    mode: str, at_ms: int, normal: Any = (0, 0, 1), origin: Any = (0, 0, 0), used: bool = True
) -> Any:
    change = SimpleNamespace(mode=mode, time_ns=at_ms * MS, normal=normal, origin_mm=origin)
    return SimpleNamespace(change=change, is_used=used)


def test_ideal_surfaces_are_what_the_program_has_given_in_each_stretch() -> None:
    """SET_POS 2 from row 10 to 49 along Z over an origin of 5 mm, then 3 along X; ACS is none."""
    is_on = (np.arange(100) >= 10) & (np.arange(100) < 90)
    set_pos = np.where(np.arange(100) < 50, 2.0, 3.0)
    made = motion(is_on=is_on, set_pos_mm=set_pos)
    tool: Any = SimpleNamespace(
        guides=[guide("NORMAL", 0, (0, 0, 1), (9, 9, 5)), guide("NORMAL", 50, (1, 0, 0), (1, 0, 7))]
    )
    assert ideal(made, tool) == [
        {"normal": [0.0, 0.0, 1.0], "at_mm": 7.0}, {"normal": [1.0, 0.0, 0.0], "at_mm": 4.0},
    ]  # fmt: skip
    for mode, used in (("ACS", True), ("", True), ("NORMAL", False)):
        nothing: Any = SimpleNamespace(guides=[guide(mode, 0, used=used)])
        assert ideal(made, nothing) == []
    twice: Any = SimpleNamespace(guides=[guide("NORMAL", 0), guide("NORMAL", 30)])
    assert [each["at_mm"] for each in ideal(made, twice)] == [2.0, 3.0]
    off: Any = motion(set_pos_mm=set_pos)
    assert ideal(off, twice) == []


def test_readings_that_leave_the_normal_open_take_the_one_before_or_z() -> None:
    """A slope of 0.75 is measured on the way along X at Y 7; then the axes stand still. The
    workpiece is lifted, or the beam is oblique above something level. One reading alone says
    nothing of a normal, as its beam is longer than the distance."""
    slope, h = np.array([-0.6, 0.0, 0.8]), 50.0

    def still(normal: Any, at_mm: float, beam: tuple[float, float, float]) -> Any:
        """20 rows at the place of the plane above X = 40, Y = 7; the beam towards the clamp."""
        hit = np.array([40.0, 7.0, 0.0])
        hit[2] = (at_mm - normal @ hit) / normal[2]
        clamp = hit + h * np.array(beam)
        return [np.tile(part, (20, 1)) for part in (hit, clamp)] + [
            np.full(20, h * normal @ np.array(beam))
        ]

    x = np.linspace(0.0, 40.0, 60)
    hit = np.stack([x, np.full(60, 7.0), 3.0 + 0.75 * x], axis=-1)
    moving = [hit, hit + np.array([0.0, 0.0, h]), np.full(60, 0.8 * h)]
    level = np.array([0.0, 0.0, 1.0])
    half = tuple(((slope + level) / np.linalg.norm(slope + level)).tolist())
    lifted, oblique = still(slope, 4.4, (0.0, 0.0, 1.0)), still(level, 30.0, (0.0, 0.6, 0.8))
    either = still(slope, 6.0, half)  # both normals fit

    def found(*parts: Any) -> list[tuple[list[float], float]]:
        joined = [np.concatenate(column) for column in zip(*parts, strict=True)]
        made = motion(len(joined[0]), **dict(zip(("hit_mm", "clamp_mm", "distance_mm"), joined,
                                                 strict=True)))  # fmt: skip
        return [(each["normal"], each["at_mm"]) for each in planes(made)]

    sloped, flat = slope.tolist(), level.tolist()
    assert found(moving, lifted) == [(sloped, 2.4), (sloped, 4.4)]
    assert found(moving, lifted, oblique) == [(sloped, 2.4), (sloped, 4.4), (flat, 30.0)]
    assert found(moving, either) == [(sloped, 2.4), (sloped, 6.0)]
    assert [normal for normal, _ in found(either)] == [flat]
    assert [normal for normal, _ in found(moving, oblique, either)] == [sloped, flat, flat]
    assert found(lifted) == []  # an inclined one that nothing shows
