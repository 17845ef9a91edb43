"""Up to which kp a loop is stable: closed forms, and the poles for what has none.

n dead cycles, N values of a mean, r = Tv/T, g = T/Tn. The closed forms are the crossings of the
unit circle by the characteristic polynomial (`loop`); for z^(n+1) - z^n + kp they are the theorem
of Kuruklis (J. Math. Anal. Appl. 188, 1994) and of Levin and May.
"""

import math
from functools import lru_cache

import numpy as np

from axisrig.bench.oracles.distance.loop import (
    BOTH,
    CONST_DIST,
    SET_POS,
    Loop,
    growth,
    largest,
    polynomials,
    roots_at,
)

KP_MAX = 2.0
"""P-AXIS-00759 allows no more."""
_SEARCH_MAX, _STEPS, _CLOSE = 20.0, 1000, 1e-12
_EDGE = 1.0 + 1e-10


def mean_limit(count: int, dead_cycles: int) -> float:
    """Return 2 N sin^2(w/2)/sin(N w/2), w = pi/(N + 2n): a mean of N values in the loop.

    One value is no filter; its crossing is at w = pi/(2n + 1).
    """
    omega = math.pi / (count + 2 * dead_cycles)
    return 2.0 * count * math.sin(omega / 2) ** 2 / math.sin(count * omega / 2)


def surface_limit(dead_cycles: int, skew_cycles: int) -> float | None:
    """Return the limit of SET_POS with P control: 2 without skew, whatever the filter.

    With a skew of one and one dead cycle 2/3 (pole at -1); None: only the poles show it.
    """
    if skew_cycles == 0:
        return 2.0
    return 2.0 / 3.0 if (dead_cycles, skew_cycles) == (1, 1) else None


def kp_limit(loop: Loop) -> float:
    """Return the smallest kp at which a pole reaches the unit circle, by the poles themselves.

    0.0 for a loop that no kp keeps stable. Searched up to 20; inf where none is found.
    """
    start, gain = polynomials(loop)
    return _limit_of(start.tobytes(), gain.tobytes())


@lru_cache(maxsize=1024)
def _limit_of(start_bytes: bytes, gain_bytes: bytes) -> float:
    """Search once for equal loops: runs with the same law ask again and again."""
    start, gain = np.frombuffer(start_bytes), np.frombuffer(gain_bytes)

    def is_reached(kp: float) -> bool:
        return largest(roots_at(start, gain, kp)) >= _EDGE

    grid = np.linspace(0.0, _SEARCH_MAX, _STEPS + 1)[1:]
    if is_reached(1e-3):
        return 0.0
    low = 1e-3
    for kp in grid:
        if is_reached(float(kp)):
            high = float(kp)
            break
        low = float(kp)
    else:
        return math.inf
    while high - low > _CLOSE * high:
        middle = 0.5 * (low + high)
        if is_reached(middle):
            high = middle
        else:
            low = middle
        if middle in (low, high) and high - low <= 1e-13:
            break
    return 0.5 * (low + high)


def closed_limit(loop: Loop, count: int = 1) -> float | None:
    """Return the closed form of a loop with a mean of `count` values; None where there is none."""
    if loop.integral or loop.derivative or loop.drive.delay_cycles or loop.sign != 1:
        return None
    if loop.mode == CONST_DIST:
        return mean_limit(count, loop.dead_cycles + loop.skew_cycles) / loop.gain
    if loop.gain != 1.0:
        return None
    if loop.mode == BOTH and loop.skew_cycles == 0:
        return mean_limit(count, loop.sent_cycles)
    if loop.mode == SET_POS and (count == 1 or loop.skew_cycles == 0):
        return surface_limit(loop.dead_cycles, loop.skew_cycles)
    return None


def is_stable(loop: Loop, kp: float) -> bool:
    """Whether every error dies away."""
    return growth(loop, kp) < 1.0 - 1e-12
