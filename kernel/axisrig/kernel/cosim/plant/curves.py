"""Curves through a few points of a motion."""

from collections.abc import Sequence


def hermite(time_s: float, step_s: float, ends: tuple[float, float, float, float]) -> float:
    """Evaluate the cubic Hermite polynomial at `time_s` of a step of `step_s`.

    ends: value and slope at the begin, value and slope at the end (unit, unit/s).
    Source: any text on interpolation; error |x''''| h^4 / 384 for a smooth motion.
    """
    x0, v0, x1, v1 = ends
    u = time_s / step_s
    w = 1.0 - u
    return (
        w * w * (1.0 + 2.0 * u) * x0
        + u * u * (3.0 - 2.0 * u) * x1
        + step_s * u * w * (w * v0 - u * v1)
    )


def vertex(places: Sequence[float], values: Sequence[float]) -> tuple[float, float]:
    """Return place and value of the vertex of the parabola through three points (Newton's form).

    The middle point where they are on a straight line or in a valley.
    """
    (x0, x1, x2), (y0, y1, y2) = places, values
    first = (y1 - y0) / (x1 - x0)
    bend = ((y2 - y1) / (x2 - x1) - first) / (x2 - x0)
    if bend >= 0.0:
        return x1, y1
    x = (x0 + x1) / 2 - first / (2 * bend)
    return x, y0 + (x - x0) * (first + bend * (x - x1))
