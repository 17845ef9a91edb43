"""Motion over a long step, and the instants at which something on the way is zero."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.optimize import brentq

Vector = NDArray[Any]


def cubic(
    start: float, start_rate: float, finish: float, finish_rate: float, span: float
) -> Polynomial:
    """The cubic through both ends with given rates, by its four linear conditions."""
    conditions = np.array(
        [
            [1, 0, 0, 0],
            [0, 1, 0, 0],
            [1, span, span**2, span**3],
            [0, 1, 2 * span, 3 * span**2],
        ]
    )
    return Polynomial(np.linalg.solve(conditions, [start, start_rate, finish, finish_rate]))


def crossings(f: Callable[[float], float], grid: Vector) -> list[float]:
    """The instants at which f changes its sign, bracketed on a grid."""
    values = np.array([f(t) for t in grid])
    places = np.nonzero(np.sign(values[:-1]) != np.sign(values[1:]))[0]
    return [brentq(f, grid[k], grid[k + 1], xtol=1e-15, rtol=1e-15) for k in places]
