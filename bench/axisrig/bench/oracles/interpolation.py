"""A signal between two instants at which its value and its rate are given."""

from typing import TypeVar

import numpy as np
import numpy.typing as npt

Part = TypeVar("Part", float, npt.NDArray[np.float64])


def coefficients(step_s: Part, ends: tuple[Part, Part, Part, Part]) -> tuple[Part, ...]:
    """Return x0, v0, b, c of the cubic x0 + v0 t + b t^2 + c t^3 over a step, t from its begin.

    ends: value and rate at the begin, value and rate at the end (unit, unit/s).
    Source: x(h) = x1 and x'(h) = v1. With the mean rate m = (x1 - x0)/h these two say
    b h + c h^2 = m - v0 and 2 b h + 3 c h^2 = v1 - v0, so that b = (3 m - 2 v0 - v1)/h and
    c = (v0 + v1 - 2 m)/h^2.
    """
    begin, begin_rate, end, end_rate = ends
    mean = (end - begin) / step_s
    square = (3.0 * mean - 2.0 * begin_rate - end_rate) / step_s
    cube = (begin_rate + end_rate - 2.0 * mean) / step_s**2
    return begin, begin_rate, square, cube


def cubic(since_s: float, step_s: float, ends: tuple[float, float, float, float]) -> float:
    """Return the value of the cubic of `coefficients`, since_s from the begin of its step."""
    begin, rate, square, cube = coefficients(step_s, ends)
    return begin + since_s * (rate + since_s * (square + since_s * cube))
