"""Arcs of programs, from the text to the path: whatever the frame, they begin where the axes stand.

The interpreter's arc is made a path by the same steps as in the channel, and followed point by
point; the circle is reckoned from the program's own numbers.
"""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axisrig.kernel.motion.curves import Arc
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.parser import parse_program

AXES = ("X", "Y", "Z")
NM = 1e-6


class Standing:
    """Stands where the last move has ended."""

    def __init__(self) -> None:
        self.acs_mm = dict.fromkeys(AXES, 0.0)

    def position_acs_mm(self, axis: str) -> float:
        return self.acs_mm[axis]

    def channel_distance(self) -> None:
        """There is no 3D distance control."""


def arcs(text: str) -> list[Arc]:
    """Every arc of a program as the path sees it."""
    machine, found = Standing(), []
    program = parse_program(text, axes=AXES)
    interpreter = Interpreter(program, AXES, machine, external={})  # type: ignore[arg-type]
    for command in interpreter.commands():
        if isinstance(command, canon.ArcMove):
            here, target = machine.acs_mm, {**machine.acs_mm, **command.target_mm}
            found.append(
                Arc(
                    start_mm=tuple(here[axis] for axis in AXES),
                    end_mm=tuple(target[axis] for axis in AXES),
                    centre_mm=tuple(command.centre_mm.get(a, here[a]) for a in AXES),
                    tangent=tuple(command.tangent.get(axis, 0.0) for axis in AXES),
                    angle_rad=command.angle_rad,
                )
            )
        if isinstance(command, canon.LinearMove | canon.ArcMove):
            machine.acs_mm.update(command.target_mm)
    return found


def points(arc: Arc, count: int = 50) -> list[tuple[float, ...]]:
    return [arc.at(arc.length_mm * k / count) for k in range(count + 1)]


places = st.floats(-2000.0, 2000.0).map(lambda value: round(value, 4))
radii = st.floats(0.01, 3000.0).map(lambda value: round(value, 4))
angles = st.floats(0.01, math.tau - 0.01)
begins = st.floats(-math.pi, math.pi)
turns = st.sampled_from(["G2", "G3"])
frames = st.tuples(places, places, places, *[st.floats(-180.0, 180.0)] * 3)


def _program(
    plane: str, turn: str, centre: tuple[float, float], radius: float, begin: float, angle: float,
    before: str = "",
) -> str:  # fmt: skip
    """An arc in a plane, its end rounded to the digits that a program has."""
    first, second = {"G17": "XY", "G18": "ZX", "G19": "YZ"}[plane]
    i, j = {"G17": "IJ", "G18": "KI", "G19": "JK"}[plane]
    end = begin + angle * (1 if turn == "G3" else -1)
    start = [c + radius * f(begin) for c, f in zip(centre, (math.cos, math.sin), strict=True)]
    stop = [c + radius * f(end) for c, f in zip(centre, (math.cos, math.sin), strict=True)]
    words = f"{first}{stop[0]:.9f} {second}{stop[1]:.9f}"
    from_start = f"{i}{centre[0] - start[0]:.9f} {j}{centre[1] - start[1]:.9f}"
    return (
        f"{before}\nG0 G90 {plane} {first}{start[0]:.9f} {second}{start[1]:.9f}\n"
        f"{turn} {words} {from_start} F1000\n"
    )


@settings(deadline=None)  # the first one builds the grammar
@given(st.sampled_from(["G17", "G18", "G19"]), turns, places, places, radii, begins, angles)
@pytest.mark.long
def test_arcs_in_the_main_planes(
    plane: str, turn: str, x: float, y: float, radius: float, begin: float, angle: float
) -> None:
    (arc,) = arcs(_program(plane, turn, (x, y), radius, begin, angle))
    first, second = ("XYZ".index(a) for a in {"G17": "XY", "G18": "ZX", "G19": "YZ"}[plane])
    seen = points(arc)
    for point in seen:
        assert math.hypot(point[first] - x, point[second] - y) == pytest.approx(radius, abs=NM)
    assert arc.angle_rad == pytest.approx(angle, abs=1e-6 + 2e-9 / radius)
    # Half way on the side that the turn says: at the angle begin + angle / 2
    half = begin + angle / 2 * (1 if turn == "G3" else -1)
    assert seen[25][first] == pytest.approx(x + radius * math.cos(half), abs=NM)
    assert seen[25][second] == pytest.approx(y + radius * math.sin(half), abs=NM)


@settings(deadline=None)
@given(frames, turns, places, places, radii, begins, angles)
@pytest.mark.long
def test_arcs_in_a_rotated_system_stay_in_their_plane_and_on_their_circle(
    frame: tuple[float, ...], turn: str, x: float, y: float, radius: float, begin: float,
    angle: float,
) -> None:  # fmt: skip
    """Distances do not depend on the frame: all points as far from the centre, in one plane."""
    components = ",".join(f"{component:.6f}" for component in frame)
    (arc,) = arcs(_program("G17", turn, (x, y), radius, begin, angle, f"#CS ON [{components}]"))
    seen = points(arc)
    a, b = arc.cosines_mm, arc.tangent
    normal = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    for point in seen:
        out = [p - c for p, c in zip(point, arc.centre_mm, strict=True)]
        assert math.hypot(*out) == pytest.approx(radius, abs=NM)
        height = sum(o * n for o, n in zip(out, normal, strict=True)) / math.hypot(*normal)
        assert height == pytest.approx(0.0, abs=NM)
    assert seen[-1] == pytest.approx(arc.end_mm, abs=NM)


@pytest.mark.parametrize(
    ("before", "scale", "shift"),
    [
        ("G71", 1.0, (0.0, 0.0)),
        ("G70", 25.4, (0.0, 0.0)),
        ("G92 X-3 Y5", 1.0, (-3.0, 5.0)),
    ],
)
def test_a_half_circle_in_inches_and_behind_a_shift(
    before: str, scale: float, shift: tuple[float, float]
) -> None:
    (arc,) = arcs(f"{before}\nG0 X10 Y0\nG3 X-10 Y0 I-10 J0 F100")
    assert arc.radius_mm == pytest.approx(10.0 * scale)
    top = arc.at(arc.length_mm / 2)
    assert top[:2] == pytest.approx((shift[0], 10.0 * scale + shift[1]))


def test_chain_of_arcs_in_relative_dimensions_comes_back() -> None:
    quarters = "G2 X5 Y5 I5 J0\nG2 X5 Y-5 I0 J-5\nG2 X-5 Y-5 I-5 J0\nG2 X-5 Y5 I0 J5"
    found = arcs(f"G0 X100 Y20\nG91 F500\n{quarters}")
    assert [arc.angle_rad for arc in found] == pytest.approx([math.pi / 2] * 4)
    assert found[-1].end_mm == pytest.approx((100.0, 20.0, 0.0))
    assert {tuple(round(c, 9) for c in arc.centre_mm) for arc in found} == {(105.0, 20.0, 0.0)}
