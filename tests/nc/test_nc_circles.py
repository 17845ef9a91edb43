"""Arcs: centre, radius and angle against closed forms, in every plane and every frame."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from axisrig.kernel.nc.canon import Message
from axisrig.kernel.nc.coordinates import CircleWords, Coordinates, Frame, GeometryError
from axisrig.kernel.nc.coordinates.circle import plane_arc
from axisrig.kernel.nc.coordinates.places import PLANES

XYZ = ("X", "Y", "Z")
LENGTHS = st.floats(-1000, 1000)
RADII = st.floats(0.01, 2000)
ANGLES = st.floats(-360, 360)
COMPONENTS = st.tuples(LENGTHS, LENGTHS, LENGTHS, ANGLES, ANGLES, ANGLES)
POINTS = st.tuples(LENGTHS, LENGTHS)
# An axis does not move by less than 1e-9 mm: on these grids it moves by nothing or by far more
GRID = st.integers(-100_000, 100_000).map(lambda hundredths: hundredths / 100)
WHOLE_DEGREES = st.integers(-360, 360).map(float)
GRID_COMPONENTS = st.tuples(GRID, GRID, GRID, WHOLE_DEGREES, WHOLE_DEGREES, WHOLE_DEGREES)


def at(x=0.0, y=0.0, z=0.0, **further):
    return Coordinates((*XYZ, *further), {"X": x, "Y": y, "Z": z, **further})


def points_on(coordinates, before, arc, shares=(0.0, 0.25, 0.5, 0.75, 1.0)):
    """Positions of the axes of the circle, by the parametric form of the circle alone."""
    axes = list(arc.centre_mm)
    centre = np.array([arc.centre_mm[a] for a in axes])
    radius_vector = np.array([before[a] for a in axes]) - centre
    tangent = np.linalg.norm(radius_vector) * np.array([arc.tangent[a] for a in axes])
    return [
        centre + math.cos(s * arc.angle_rad) * radius_vector + math.sin(s * arc.angle_rad) * tangent
        for s in shares
    ]


@pytest.mark.long
@given(POINTS, RADII, st.floats(0, math.tau), st.floats(0.001, math.tau - 0.001), st.booleans())
def test_an_arc_about_a_centre_has_the_angle_it_was_made_with(centre, r, begin, angle, clockwise):
    def on_circle(phi):
        return (centre[0] + r * math.cos(phi), centre[1] + r * math.sin(phi))

    end = begin - angle if clockwise else begin + angle
    arc = plane_arc(on_circle(begin), on_circle(end), CircleWords(clockwise, centre))
    assert abs(arc.angle_rad) == pytest.approx(angle, abs=1e-8 + 1e-10 / r)
    assert (arc.angle_rad < 0) == clockwise
    assert arc.radius_mm == pytest.approx(r, abs=1e-9)
    assert arc.tangent == pytest.approx(
        (-math.sin(begin), math.cos(begin))
        if not clockwise
        else (math.sin(begin), -math.cos(begin)),
        abs=1e-9 + 1e-9 / r,
    )


@pytest.mark.long
@given(POINTS, POINTS, st.floats(1.0001, 100), st.booleans(), st.booleans())
def test_an_arc_by_radius_has_the_chord_of_its_angle(start, end, factor, clockwise, long_way):
    chord = math.dist(start, end)
    assume(chord > 0.01)
    radius = chord / 2 * factor
    words = CircleWords(clockwise, radius_mm=-radius if long_way else radius)
    arc = plane_arc(start, end, words)
    assert arc.radius_mm == pytest.approx(radius, rel=1e-12)
    assert math.dist(end, arc.centre) == pytest.approx(radius, rel=1e-12)
    short = 2 * math.asin(chord / (2 * radius))
    assert abs(arc.angle_rad) == pytest.approx(math.tau - short if long_way else short, rel=1e-6)
    assert (arc.angle_rad < 0) == clockwise


@pytest.mark.parametrize(
    ("clockwise", "radius", "centre", "degrees"),
    [
        (True, 50.0, (50, 0), -180),
        (False, 50.0, (50, 0), 180),
        (True, 100 / math.sqrt(2), (50, -50), -90),
        (False, 100 / math.sqrt(2), (50, 50), 90),
        (True, -100 / math.sqrt(2), (50, 50), -270),
        (False, -100 / math.sqrt(2), (50, -50), 270),
    ],
)
def test_which_of_the_four_arcs_a_radius_means(clockwise, radius, centre, degrees):
    arc = plane_arc((0, 0), (100, 0), CircleWords(clockwise, radius_mm=radius))
    assert arc.centre == pytest.approx(centre, abs=1e-9)
    assert math.degrees(arc.angle_rad) == pytest.approx(degrees)


def test_the_end_that_is_the_start_is_a_full_circle():
    assert plane_arc((0, 0), (0, 0), CircleWords(True, (10, 0))).angle_rad == -math.tau
    assert plane_arc((0, 0), (0, 0), CircleWords(False, (10, 0))).angle_rad == math.tau


def test_a_rounded_centre_is_moved_onto_the_line_between_both_ends():
    """G165: quarter of R 10 about (10, 0), centre programmed 0.01 mm off along the chord."""
    off = 0.01 / math.sqrt(2)
    arc = plane_arc((0, 0), (10, 10), CircleWords(True, (10 + off, 0 + off)))
    assert arc.centre == pytest.approx((10, 0), abs=1e-12)
    assert math.degrees(arc.angle_rad) == pytest.approx(-90)


@pytest.mark.parametrize(
    ("start", "end", "words", "alarm_id"),
    [
        ((0, 0), (10, 0), CircleWords(True, (0, 0)), 20036),
        ((0, 0), (10, 0), CircleWords(True, radius_mm=0), 20036),
        ((0, 0), (10, 0), CircleWords(True), 20036),
        ((0, 0), (0, 0), CircleWords(True, radius_mm=10), 20034),
        ((0, 0), (10, 0), CircleWords(True, radius_mm=4.99), 900151),
        ((0, 0), (10, 0), CircleWords(True, (5.6, 0)), 900150),
        ((0, 0), (1000, 0), CircleWords(True, (502.1, 0)), 900150),
        ((0, 0), (20, 0.02), CircleWords(True, (10, 0), corrected=False), None),
        ((0, 0), (2.0011, 0), CircleWords(True, (1, 0), corrected=False), 21758),
        ((0, 0), (2.0009, 0), CircleWords(True, (1, 0), corrected=False), None),
        ((0, 0), (2000.006, 0), CircleWords(True, (1000, 0), corrected=False), 21758),
        ((0, 0), (2000.004, 0), CircleWords(True, (1000, 0), corrected=False), None),
    ],
)
def test_words_that_make_no_arc(start, end, words, alarm_id):
    if alarm_id is None:
        plane_arc(start, end, words)
        return
    with pytest.raises(GeometryError) as fault:
        plane_arc(start, end, words)
    assert fault.value.alarm_id == alarm_id


def test_a_radius_that_is_too_short_by_rounding_gives_half_a_circle():
    arc = plane_arc((0, 0), (33.333, 0), CircleWords(False, radius_mm=16.666))
    assert arc.centre == pytest.approx((16.6665, 0))
    assert math.degrees(arc.angle_rad) == pytest.approx(180)


@given(COMPONENTS, st.sampled_from(list(PLANES)), POINTS, POINTS, st.booleans())
@pytest.mark.long
def test_under_a_coordinate_system_an_arc_keeps_radius_and_angle(
    components, plane, start, centre, clockwise
):
    """The same arc with and without #CS; the points of it are the same points, turned."""
    assume(math.dist(start, centre) > 0.01)
    pairs = []
    for frame in (None, Frame.of(components)):
        coordinates = at()
        if frame is not None:
            coordinates.switch_on(frame)
        coordinates.plane = PLANES[plane]
        axes = coordinates.plane_axes()
        first = dict.fromkeys(XYZ, 0.0) | dict(zip(axes, start, strict=True))
        coordinates.aim(first, absolute=True)
        before = dict(coordinates.acs_mm)
        relative = (centre[0] - start[0], centre[1] - start[1])
        end = (centre[0] + relative[1], centre[1] - relative[0])  # a quarter turn
        arc = coordinates.aim_arc(
            dict(zip(axes, end, strict=True)), CircleWords(clockwise, relative), absolute=True
        )
        missing = {axis: before[axis] for axis in XYZ}
        points = []
        for point in points_on(coordinates, before, arc):
            whole = missing | dict(zip(arc.centre_mm, point, strict=True))
            points.append(np.array([whole[axis] for axis in XYZ]))
        ends = np.array([coordinates.acs_mm[axis] for axis in XYZ])
        assert points[-1] == pytest.approx(ends, abs=1e-8)
        pairs.append((arc, points))
    (plain, plain_points), (turned, turned_points) = pairs
    assert turned.angle_rad == pytest.approx(plain.angle_rad)
    assert math.degrees(plain.angle_rad) == pytest.approx(270 if clockwise else 90, abs=1e-4)
    frame = Frame.of(components)
    for low, high in zip(turned_points, plain_points, strict=True):
        assert low == pytest.approx(frame.down(high), abs=1e-8)


@pytest.mark.long
@given(GRID_COMPONENTS, st.tuples(GRID, GRID), RADII)
def test_tangent_is_a_unit_vector_at_right_angles_to_the_radius(components, start, r):
    coordinates = at()
    coordinates.switch_on(Frame.of(components))
    coordinates.aim(dict(zip(("X", "Y"), start, strict=True)), absolute=True)
    before = dict(coordinates.acs_mm)
    arc = coordinates.aim_arc({}, CircleWords(True, (r, 0.0)), absolute=True)
    tangent = np.array([arc.tangent[a] for a in XYZ])
    radius = np.array([before[a] - arc.centre_mm[a] for a in XYZ])
    assert np.linalg.norm(tangent) == pytest.approx(1, abs=1e-12)
    assert np.linalg.norm(radius) == pytest.approx(r, abs=1e-9)
    assert tangent @ radius == pytest.approx(0, abs=1e-9 * max(r, 1))


@pytest.mark.parametrize(
    ("plane", "start", "end", "middle"),
    [
        ("G17", {"X": 10, "Y": 0}, {"X": 0, "Y": 10}, {"X": math.sqrt(50), "Y": math.sqrt(50)}),
        ("G18", {"Z": 10, "X": 0}, {"Z": 0, "X": 10}, {"Z": math.sqrt(50), "X": math.sqrt(50)}),
        ("G19", {"Y": 10, "Z": 0}, {"Y": 0, "Z": 10}, {"Y": math.sqrt(50), "Z": math.sqrt(50)}),
    ],
)
def test_g3_turns_from_the_first_axis_of_the_plane_to_the_second(plane, start, end, middle):
    coordinates = at()
    coordinates.plane = PLANES[plane]
    coordinates.aim(start, absolute=True)
    before = dict(coordinates.acs_mm)
    arc = coordinates.aim_arc(end, CircleWords(False, (-10.0, 0.0)), absolute=True)
    assert math.degrees(arc.angle_rad) == pytest.approx(90)
    (point,) = points_on(coordinates, before, arc, (0.5,))
    assert dict(zip(arc.centre_mm, point, strict=True)) == pytest.approx(middle)


def test_the_third_axis_comes_along_and_an_axis_that_stands_is_not_named():
    coordinates = at(x=-10.0, A=5.0)
    helix = coordinates.aim_arc({"Z": 20.0}, CircleWords(False, (10.0, 0.0)), absolute=True)
    assert helix.target_mm == {"X": -10.0, "Y": 0.0, "Z": 20.0}
    assert helix.centre_mm == {"X": 0.0, "Y": 0.0}
    assert helix.angle_rad == math.tau


def test_relative_end_and_shifts():
    """Centre and radius do not feel shifts; an absolute centre does."""
    coordinates = at()
    coordinates.shift_reference("X", 100.0, added=False)
    coordinates.aim({"X": 0.0, "Y": 0.0}, absolute=True)
    arc = coordinates.aim_arc({"X": 20.0}, CircleWords(True, (10.0, 0.0)), absolute=False)
    assert arc.target_mm["X"] == 120.0
    assert arc.centre_mm == {"X": 110.0, "Y": 0.0}
    words = CircleWords(True, (10.0, 0.0), centre_absolute=True)
    back = coordinates.aim_arc({"X": 0.0}, words, absolute=True)
    assert back.target_mm["X"] == 100.0
    assert back.centre_mm == pytest.approx({"X": 110.0, "Y": 0.0})


def test_a_rig_without_the_second_axis_of_the_plane_has_no_circle():
    coordinates = Coordinates(("X", "Z"), {"X": 0.0, "Z": 0.0})
    with pytest.raises(GeometryError) as fault:
        coordinates.aim_arc({"X": 1.0}, CircleWords(True, (1.0, 0.0)), absolute=True)
    assert fault.value.alarm_id == 900152
    coordinates.plane = PLANES["G18"]
    assert coordinates.aim_arc({}, CircleWords(True, (1.0, 0.0)), absolute=True).angle_rad > 6


@pytest.mark.parametrize(("plane", "places"), [("G17", (0, 1)), ("G18", (2, 0)), ("G19", (1, 2))])
@pytest.mark.parametrize("unit", ["G71", "G70"])
@pytest.mark.parametrize("written", ["relative", "absolute", "radius"])
def test_a_program_reads_centre_and_radius_of_its_last_arc_from_the_start_of_it(
    run, plane, places, unit, written
):
    """Half a circle of 5 about (3, 4) from its start, which is nowhere near zero."""
    start, letters = (10.0, 20.0, 30.0), "IJK"
    centre = {letters[places[0]]: 3.0, letters[places[1]]: 4.0}
    first, second = places
    end = f"{XYZ[first]}{start[first] + 6.0} {XYZ[second]}{start[second] + 8.0}"
    words = {
        "relative": " ".join(f"{letter}{value}" for letter, value in centre.items()),
        "absolute": " ".join(f"{a}{centre[a] + start[letters.index(a)]}" for a in centre),
        "radius": "R5",
    }[written]
    absolute = "G161" if written == "absolute" else "G162"
    commands = run(
        f"{unit} {plane} {absolute} G0 X10 Y20 Z30\nG3 {end} {words} F100\n"
        '#MSG ["%.6f %.6f %.6f %.6f", V.G.I, V.G.J, V.G.K, V.G.R]'
    )
    (message,) = [c for c in commands if isinstance(c, Message)]
    assert message.text.split() == [f"{centre.get(a, 0.0):.6f}" for a in letters] + ["5.000000"]
