"""References of the mechanical components, from their equations."""

from collections.abc import Mapping

import numpy as np
from integration import Mode, Vector, integrate


def fixed_stop(time_s: Vector) -> Mapping[str, Vector]:
    """A mass runs into a stop with exponent 1.5 and leaves it again.

    m dv/dt = -F_g - k p (p/p_r)^(n-1) (1 + a v) while p = x - x_s > 0 and the stop pushes.
    Source: Hunt, Crossley (1975).
    """
    mass, weight, stop, k, n, reference, a = 100.0, 50.0, 2e-3, 20e6, 1.5, 1e-4, 4.0

    def force(x: Vector, mode: Mode) -> float:
        touching, pushing = mode
        depth = max(x[0] - stop, 0.0)
        spring = k * depth * (depth / reference) ** (n - 1.0)
        return float(spring * (1.0 + a * x[1])) if touching and pushing else 0.0

    rows = integrate(
        lambda t, x, mode: (x[1], -(weight + force(x, mode)) / mass),
        [0.0, 0.1],
        time_s,
        guards=[lambda t, x: x[0] - stop, lambda t, x: 1.0 + a * x[1]],
    )
    forces = [force(x, (x[0] > stop, 1.0 + a * x[1] > 0.0)) for x in rows]
    return {"position": rows[:, 0], "velocity": rows[:, 1], "force": np.array(forces)}
