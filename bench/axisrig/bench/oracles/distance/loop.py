"""The characteristic polynomial of distance control, for each mode.

Time counts in cycles k, q = z^-1 delays by one. o(k) is the offset that cycle k computes, a(k) the
position at the SYNC of cycle k. What is computed in cycle k is reached at the SYNC n + 1 cycles
later: a(k) = D o(k - 1 - n), D the drive, n the dead cycles: the error is n cycles late beside
what an ideal loop has (n = 0: e(k) sees o(k - 1)).

    mode                  loop error e                       what comes back of the offset, B
    CONST_DIST            SET_DIST - F d                     F D q^(1+n+s)
    with both encoders    SET_DIST - F (d - Z_act + Z_com)   F (q^(1+m) - (1 - q^s) D q^(1+n))
    SET_POS               F (act + sensor - SET_POS) - o     q - F D q^(1+n) (1 - q^s)

F: filter. s: skew, by how many cycles the sensor is older than the actual position (below 0 =
newer). m: dead
cycles of Z_com, the set position that was sent in the cycle before. The controller adds kp C e to
the offset, C = 1 + g/(1 - q) + r (1 - q) with g = T/Tn and r = Tv/T (Tv where it counts per
cycle), so that

    (1 - q) + kp C B = 0

That is with a derivative of the error. One of the feedback does not see the offset that SET_POS
takes off its filtered deviation: with B_f, B without that q,

    (1 - q) + kp ((1 + g/(1 - q)) B + r (1 - q) B_f) = 0

In the other modes B_f is B. Sources: FCT-M3 3, 5.1, 5.2, 7.1; docs/distance-control.md.
"""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from axisrig.bench.oracles.distance.smoothing import Polynomial, Smoothing, none

CONST_DIST, BOTH, SET_POS = "CONST_DIST", "CONST_DIST with both encoders", "SET_POS"


@dataclass(frozen=True)
class Loop:
    """What is in a loop beside kp.

    mode: CONST_DIST, BOTH or SET_POS. dead_cycles: n. sent_cycles: m, only for BOTH. skew_cycles:
    s. integral: g = T/Tn, 0 = off. derivative: r, Tv/T or Tv. of_error: it is that of the error,
    not of the feedback. drive: D, a transfer function of gain 1. sign: -1 when the sensor counts
    against what the mode needs. gain: by how much the distance grows for 1 mm of offset; 1 but for
    3D control over an inclined surface (`tool.surface_gain`).
    """

    mode: str
    dead_cycles: int
    smoothing: Smoothing = field(default_factory=none)
    sent_cycles: int = 0
    skew_cycles: int = 0
    integral: float = 0.0
    derivative: float = 0.0
    of_error: bool = False
    drive: Smoothing = field(default_factory=none)
    sign: int = 1
    gain: float = 1.0

    @property
    def is_surface(self) -> bool:
        """Whether the loop follows a surface position."""
        return self.mode == SET_POS


def polynomials(loop: Loop) -> tuple[Polynomial, Polynomial]:
    """Return A and B of A(q) + kp B(q) = 0, lowest power of q first."""
    above, below = _feedback(loop)
    looked_at = above if loop.of_error or not loop.is_surface else _add(above, -_shift(below, 1))
    integrator = np.array([1.0, -1.0])
    start = np.convolve(integrator, below)
    gain = _add(above, loop.derivative * np.convolve(integrator, looked_at))
    if loop.integral:
        start = np.convolve(start, integrator)
        gain = _add(np.convolve(gain, integrator), loop.integral * above)
    return start, gain


def _feedback(loop: Loop) -> tuple[Polynomial, Polynomial]:
    """Return how the offset comes back into -e: above, below."""
    smooth, drive = loop.smoothing, loop.drive
    below = np.convolve(smooth.denominator, drive.denominator)
    driven, dead = np.convolve(smooth.numerator, drive.numerator), 1 + loop.dead_cycles
    way = _shift(driven, dead)
    sensor = loop.sign * loop.gain * _shift(driven, dead + loop.skew_cycles)
    if loop.mode == CONST_DIST:
        return sensor, below
    if loop.mode == BOTH:
        sent = _shift(np.convolve(smooth.numerator, drive.denominator), 1 + loop.sent_cycles)
        return _add(_add(sensor, -way), sent), below
    return _add(_shift(below, 1), _add(sensor, -way)), below


def _add(first: Polynomial, second: Polynomial) -> Polynomial:
    whole: Polynomial = np.polynomial.polynomial.polyadd(first, second).astype(np.float64)
    return whole


def _shift(polynomial: Polynomial, cycles: int) -> Polynomial:
    return np.concatenate([np.zeros(cycles), polynomial])


def poles(loop: Loop, kp: float) -> npt.NDArray[np.complex128]:
    """Return the roots of the characteristic polynomial in z."""
    return roots_at(*polynomials(loop), kp)


def roots_at(start: Polynomial, gain: Polynomial, kp: float) -> npt.NDArray[np.complex128]:
    """Return the roots of A(q) + kp B(q) in z; start, gain: what `polynomials` gives."""
    whole = np.polynomial.polynomial.polyadd(start, kp * gain)
    roots: npt.NDArray[np.complex128] = np.roots(whole).astype(np.complex128)
    return roots


def growth(loop: Loop, kp: float) -> float:
    """Return the magnitude of the largest pole: what is left of an error after one cycle."""
    return largest(poles(loop, kp))


def largest(found: npt.NDArray[np.complex128]) -> float:
    """Return the largest magnitude among poles."""
    return float(np.max(np.abs(found))) if len(found) else 0.0  # none: all poles lie at 0


def transfer(loop: Loop, kp: float, omega_t: Polynomial) -> npt.NDArray[np.complex128]:
    """Return the open loop kp C F D .../(1 - q) at omega T (rad per cycle)."""
    q = np.exp(-1j * np.asarray(omega_t, dtype=np.float64))
    start, gain = polynomials(loop)
    evaluate = np.polynomial.polynomial.polyval
    open_loop: npt.NDArray[np.complex128] = kp * evaluate(q, gain) / evaluate(q, start)
    return open_loop
