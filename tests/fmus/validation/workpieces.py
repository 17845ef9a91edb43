"""References of the surfaces, from their definitions; slopes by complex steps.

Heights are written so that they take complex numbers: the derivative of h at x is Im h(x + i e)/e
to the last digit for e = 1e-30 (Squire, Trapp, SIAM Review 40 (1998)); nothing is
differentiated by hand.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Complex = NDArray[Any]  # complex128; comparisons and choices lose the type
Height = Callable[[Complex, Complex], Complex]

TINY = 1e-30
FAR = 1e3


def path(time_s: Vector) -> tuple[Vector, Vector]:
    """x and y in m on the path that all surfaces are crossed on."""
    return -0.05 + 0.1 * time_s, 0.02 - 0.03 * time_s


def clipped(u: Complex) -> Complex:
    """u within 0..1; outside both limits without a derivative."""
    return np.where(u.real < 0, 0, np.where(u.real > 1, 1, u))


def turned(height: Callable[[Complex], Complex], azimuth: float) -> Height:
    """A profile over x cos a + y sin a."""
    return lambda x, y: height(x * np.cos(azimuth) + y * np.sin(azimuth))


def level(height: float) -> Height:
    """The same height everywhere."""
    return lambda x, y: height + 0 * x


def inclined(angle: float, origin: float, azimuth: float) -> Height:
    """A plane that rises by `angle`, rad."""
    return turned(lambda s: np.sin(angle) / np.cos(angle) * (s - origin), azimuth)


def ramp_between(rise: float, start: float, length: float, azimuth: float) -> Height:
    """A straight rise within `length`."""
    return turned(lambda s: rise * clipped((s - start) / length), azimuth)


def smooth_rise(u: Complex) -> Complex:
    """The cubic from 0 to 1 with level ends, as a Bernstein polynomial."""
    v = clipped(u)
    rise: Complex = 3 * v**2 * (1 - v) + v**3
    return rise


def obstacle(rise: float, start: float, flank: float, width: float, azimuth: float) -> Height:
    """Two flanks of opposite direction."""
    return turned(
        lambda s: (
            rise * (smooth_rise((s - start) / flank) - smooth_rise((s - start - width) / flank))
        ),
        azimuth,
    )


def waves(
    amplitudes: list[float], lengths: list[float], phases: list[float], azimuth: float
) -> Height:
    """A sum of sines."""

    def height(s: Complex) -> Complex:
        total = 0 * s
        for amplitude, length, phase in zip(amplitudes, lengths, phases, strict=True):
            total = total + amplitude * np.sin(2 * np.pi * (s / length) + phase)
        return total

    return turned(height, azimuth)


def bar(radius: float, axis: float, share: float, azimuth: float) -> Height:
    """A circle up to `share` of its radius, its tangent there beyond."""
    reach = share * radius
    angle = np.arcsin(share)

    def height(s: Complex) -> Complex:
        u = np.where(s.real < axis, axis - s, s - axis)
        circle = np.sqrt(np.where(np.abs(u) < reach, radius**2 - u**2, 1)) - radius
        tangent = radius * np.cos(angle) - radius - np.tan(angle) * (u - reach)
        return np.where(u.real < reach, circle, tangent)

    return turned(height, azimuth)


def sampled(height: Height, x: Vector, y: Vector) -> tuple[Vector, Vector, Vector]:
    """Height and both slopes at the points (x, y)."""
    along_x = height(x + 1j * TINY, y + 0j)
    along_y = height(x + 0j, y + 1j * TINY)
    return along_x.real, along_x.imag / TINY, along_y.imag / TINY


def surface(height: Height, steepest: float, time_s: Vector) -> dict[str, Vector]:
    """The signals of a surface on the path."""
    h, slope_x, slope_y = sampled(height, *path(time_s))
    return {
        "height": h,
        "slope_x": slope_x,
        "slope_y": slope_y,
        "steepest": np.full_like(time_s, steepest),
    }


def border(distance: Height, time_s: Vector) -> dict[str, Vector]:
    """The signals of a border on the path."""
    beyond, beyond_x, beyond_y = sampled(distance, *path(time_s))
    return {"beyond": beyond, "beyond_x": beyond_x, "beyond_y": beyond_y}


def edge_at(position: float, azimuth: float) -> Height:
    """Distance from the half plane that ends at `position`."""
    return turned(lambda s: s - position, azimuth)


def hole_at(center_x: float, center_y: float, radius: float) -> Height:
    """Distance from the outside of a circle."""
    return lambda x, y: radius - np.sqrt((x - center_x) ** 2 + (y - center_y) ** 2)


def side_of(radius: float, axis: float, azimuth: float) -> Height:
    """Distance from a strip of the width of a bar."""
    return turned(lambda s: np.where(s.real < axis, axis - s, s - axis) - radius, azimuth)


PLANE = level(0.0123)
THICKNESS = level(0.26e-3)
CYLINDER = bar(0.0302, 4e-3, 0.9, 0.2)
SINE_STEEPEST = 0.2e-3 / (0.03 / (2 * np.pi))
WAVINESS_STEEPEST = 2 * np.pi * (0.1 / 17 + 0.3 / 31 + 0.5 / 53 + 0.8 / 110)
RAMP_STEEPEST = 2.0 / 30.5
STEP_STEEPEST = 2.8 * 1.5 / 6.03
CYLINDER_STEEPEST = float(np.tan(np.arcsin(0.9)))


def rise_and_fall(up: float) -> list[Height]:
    """Ramp, obstacle, sine and waves; up is 1 or -1."""
    heights = [0.1e-3, up * 0.3e-3, 0.5e-3, up * 0.8e-3]
    return [
        ramp_between(up * 2e-3, -0.0201, 0.0305, -0.3),
        obstacle(up * 2.8e-3, -0.0201, 6.03e-3, 0.0307, 0.3),
        waves([up * 0.2e-3], [0.03], [0.5], 0.7),
        waves(heights, [0.017, 0.031, 0.053, 0.11], [0.3, 1, 2, 3], -0.5),
    ]


def plane(time_s: Vector) -> Mapping[str, Vector]:
    """A level plane."""
    return surface(PLANE, 0.0, time_s)


def thickness_offset(time_s: Vector) -> Mapping[str, Vector]:
    """A sheet that is too thick."""
    return surface(THICKNESS, 0.0, time_s)


def inclined_plane(time_s: Vector) -> Mapping[str, Vector]:
    """A plane that falls; its steepest direction is its azimuth."""
    return surface(inclined(-0.5, 3e-3, 0.4), float(np.tan(0.5)), time_s)


def ramp(time_s: Vector) -> Mapping[str, Vector]:
    """A ramp downwards."""
    return surface(rise_and_fall(-1)[0], RAMP_STEEPEST, time_s)


def step(time_s: Vector) -> Mapping[str, Vector]:
    """An obstacle; a cubic flank is steepest in its middle, 1.5 times its mean slope."""
    return surface(rise_and_fall(1)[1], STEP_STEEPEST, time_s)


def sine(time_s: Vector) -> Mapping[str, Vector]:
    """A sine."""
    return surface(rise_and_fall(-1)[2], SINE_STEEPEST, time_s)


def waviness(time_s: Vector) -> Mapping[str, Vector]:
    """Four waves; the bound adds their largest slopes."""
    return surface(rise_and_fall(-1)[3], WAVINESS_STEEPEST, time_s)


def cylinder(time_s: Vector) -> Mapping[str, Vector]:
    """A bar from side to side."""
    found = surface(CYLINDER, CYLINDER_STEEPEST, time_s)
    return found | border(side_of(0.0302, 4e-3, 0.2), time_s)


def edge(time_s: Vector) -> Mapping[str, Vector]:
    """A straight edge."""
    return border(edge_at(0.0111, 0.6), time_s)


def hole(time_s: Vector) -> Mapping[str, Vector]:
    """A round hole."""
    return border(hole_at(4e-3, 2e-3, 0.0203), time_s)


def workpiece(time_s: Vector) -> Mapping[str, Vector]:
    """All of them; the border is the nearest of the three, seen from outside the material."""
    below, above = rise_and_fall(-1), rise_and_fall(1)
    parts = [PLANE, THICKNESS, inclined(0.1, 3e-3, 0.4), CYLINDER]
    parts += [above[0], below[1], above[2], above[3]]
    steepest = np.tan(0.1) + RAMP_STEEPEST + STEP_STEEPEST + SINE_STEEPEST
    steepest += WAVINESS_STEEPEST + CYLINDER_STEEPEST
    found = surface(
        lambda x, y: np.sum([part(x, y) for part in parts], axis=0), float(steepest), time_s
    )
    ends = [edge_at(0.0251, 0.6), hole_at(4e-3, 2e-3, 6.3e-3), side_of(0.0302, 4e-3, 0.2)]
    borders = [border(end, time_s) for end in ends]
    largest = np.argmax([b["beyond"] for b in borders], axis=0)
    for name in ("beyond", "beyond_x", "beyond_y"):
        found[name] = np.choose(largest, [b[name] for b in borders])
    found["present"] = (found["beyond"] <= 0).astype(float)
    return found


def moved(time_s: Vector, ramps: Sequence[tuple[float, float, float]]) -> Vector:
    """Sum of ramps: height behind it, begin, end."""
    heights = [np.interp(time_s, [begin, end], [0.0, h]) for h, begin, end in ramps]
    return np.asarray(np.sum(heights, axis=0))


def swayed(time_s: Vector, amplitude: float, frequency: float, begin: float) -> Vector:
    """A sine from `begin` on, as the imaginary part of a pointer that turns."""
    pointer = amplitude * np.exp(2j * np.pi * frequency * np.maximum(0.0, time_s - begin))
    return np.asarray(pointer.imag)


def movement(time_s: Vector) -> Mapping[str, Vector]:
    """Two ramps that overlap and a sine; two steps."""
    ramps = [(1.1e-3, 0.0503, 0.1207), (-0.6e-3, 0.1011, 0.2203)]
    steps = 2.8e-3 * (time_s > 0.1303) - 2.7e-3 * (time_s > 0.2904)
    return {
        "gradual_height": moved(time_s, ramps) + swayed(time_s, 0.3e-3, 7.0, 0.2503),
        "sudden_height": steps,
    }
