"""A linear loop of distance control, as identified: limits of stability, margins, answers.

Unit of time is the NC cycle; q^-1 is a delay by one cycle. The offset o follows the law

    (1 - q^-1) o = kp C (w - P o),   C = 1 + (T/Tn)/(1 - q^-1) + (Tv/T)(1 - q^-1)

with the set value w and the loop's feedback P as an impulse response p (FIR): what the controller
gets to see of an offset, after path and filter. So the loop is stable when all zeros of
(1 - q^-1) + kp C P are within the unit circle, and it is at its limit where L = kp C P/(1 - q^-1)
passes -1 (Nyquist). A derivative of the feedback (`[distance]` of a rig) takes another P_D in the
place of P, without the offset that SET_POS takes off, and no w in CONST_DIST; where Tv counts per
cycle, it is Tv in the place of Tv/T.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq
from scipy.signal import lfilter

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]

# Radians per cycle; the crossings of the phase are looked for between two of them
_GRID = np.concatenate([np.geomspace(1e-5, 0.05, 800), np.linspace(0.05, np.pi, 4000)[1:]])
_CIRCLE = 1 << 16
_NEGLIGIBLE = 1e-12


@dataclass(frozen=True)
class Law:
    """kp without unit; tn_s, tv_s: s, 0 = the part is off."""

    kp: float
    tn_s: float = 0.0
    tv_s: float = 0.0


@dataclass(frozen=True)
class Loop:
    """period_s: NC cycle. feedback: impulse response p of the feedback P, from cycle 0 on.

    noise: impulse response of the filter, by which the noise of the sensor reaches the controller.
    looked_at: as feedback, of what the D part takes the change of; None for the same.
    steps_with_set_value: whether the D part sees a change of the set value. unit_s: the Tv that
    counts as one cycle, T, or 1 where it counts per cycle.
    """

    period_s: float
    feedback: Floats
    noise: Floats
    looked_at: Floats | None = None
    steps_with_set_value: bool = True
    is_per_cycle: bool = False

    @property
    def unit_s(self) -> float:
        """Return the Tv whose D part is as large as the P part where the error changes by itself in
        one cycle.
        """
        return 1.0 if self.is_per_cycle else self.period_s

    def open_loop(self, law: Law, angles: Floats) -> Complexes:
        """L at angular frequencies in radians per cycle."""
        return self._opened(law, angles, _response(self.feedback, angles))

    def _opened(self, law: Law, angles: Floats, feedback: Complexes) -> Complexes:
        step = 1 - np.exp(-1j * angles)
        rate = law.tv_s / self.unit_s * step
        integral = self.period_s / law.tn_s / step if law.tn_s else 0.0
        looked_at = feedback
        if rate.any() and self.looked_at is not None:
            looked_at = _response(self.looked_at, angles)
        loop: Complexes = law.kp * ((1 + integral) * feedback + rate * looked_at) / step
        return loop

    @cached_property
    def _on_grid(self) -> Complexes:
        """P at the frequencies of the grid, the costly part of L."""
        return _response(self.feedback, _GRID)

    def stable_kp(self, tn_s: float = 0.0, tv_s: float = 0.0) -> tuple[float, float]:
        """Return the range of kp in which the loop is stable; (0, 0) when there is none.

        Each kp at which L passes -1 is a crossing; between two of them the number of unstable zeros
        stays, so one kp of each interval is tried.
        """
        law = Law(1.0, tn_s, tv_s)
        ends = [0.0, *self._crossings(law)]
        for low, high in zip(ends, [*ends[1:], 2 * ends[-1] + 1], strict=True):
            if self.is_stable(replace(law, kp=(low + high) / 2)):
                return low, high if high in ends else float("inf")
        return 0.0, 0.0

    def _crossings(self, law: Law) -> list[float]:
        """All kp > 0 for which L = -1 at some frequency, in rising order."""
        values = self._opened(law, _GRID, self._on_grid)
        signs = np.signbit(values.imag)
        angles = []
        for at in np.flatnonzero(signs[1:] != signs[:-1]):
            low, high = float(_GRID[at]), float(_GRID[at + 1])
            angles.append(float(brentq(lambda angle: self._imag(law, angle), low, high)))
        found = self.open_loop(law, np.array([*angles, np.pi])).real
        return sorted({float(-1 / value) for value in found if value < 0})

    def _imag(self, law: Law, angle: float) -> float:
        return float(self.open_loop(law, np.array([angle])).imag[0])

    def is_stable(self, law: Law) -> bool:
        """Whether no zero of the characteristic polynomial is on or outside the unit circle.

        In q^-1 these are the zeros within it: the polynomial turns once around 0 for each while
        q^-1 runs around the circle (argument principle).
        """
        polynomial, _ = self._polynomials(law)
        if polynomial[0] <= 0:
            return False
        values = np.fft.fft(polynomial, max(_CIRCLE, 1 << (4 * len(polynomial)).bit_length()))
        if not values.all():  # a zero on the circle itself
            return False
        turns = np.angle(np.roll(values, -1) / values).sum() / (2 * np.pi)
        return round(float(turns)) == 0

    def _polynomials(self, law: Law) -> tuple[Floats, Floats]:
        """Characteristic polynomial and kp C in q^-1, both times (1 - q^-1) with an I part.

        kp C is what a set value meets.
        """
        steady, rate, rest = self._parts(law)
        looked_at = self.feedback if self.looked_at is None else self.looked_at
        both = _sum(np.convolve(steady, self.feedback), np.convolve(rate, looked_at))
        both[: len(rest)] += rest[: len(both)]
        return both, _sum(steady, rate) if self.steps_with_set_value else steady

    def _parts(self, law: Law) -> tuple[Floats, Floats, Floats]:
        """Return kp times P and I part, kp times D part, and what is left without them."""
        rate = law.tv_s / self.unit_s * np.array([1.0, -1.0])
        steady, rest = np.array([1.0]), np.array([1.0, -1.0])
        if law.tn_s:
            back = np.array([1.0, -1.0])
            steady = back + np.array([self.period_s / law.tn_s, 0.0])
            rate, rest = np.convolve(rate, back), np.convolve(rest, back)
        return law.kp * steady, law.kp * rate, rest

    def step_answer(self, law: Law, cycles: int) -> Floats:
        """What the controller sees of its own offset after a step of the feedback by 1, which is
        the surface, as the filter gives it; every part of the controller sees it.
        """
        polynomial, _ = self._polynomials(law)
        control = _sum(*self._parts(law)[:2])
        return np.asarray(lfilter(np.convolve(control, self.feedback), polynomial, np.ones(cycles)))

    def offset_answer(self, law: Law, cycles: int) -> Floats:
        """The offset after a step of the set value by 1."""
        polynomial, control = self._polynomials(law)
        return np.asarray(lfilter(control, polynomial, np.ones(cycles)))

    def noise_gain(self, law: Law, cycles: int = 4000) -> float:
        """Standard deviation of the offset over that of white noise of the sensor."""
        polynomial, _ = self._polynomials(law)
        control = _sum(*self._parts(law)[:2])
        pulse = np.zeros(cycles)
        pulse[0] = 1.0
        answer = lfilter(np.convolve(control, self.noise), polynomial, pulse)
        return float(np.sqrt(np.sum(answer**2)))

    def sensitivity_peak(self, law: Law) -> float:
        """Return Ms = max |1/(1 + L)|; 1/Ms is the distance of L from -1."""
        return float(np.abs(1 / (1 + self._opened(law, _GRID, self._on_grid))).max())


def _response(impulses: Floats, angles: Floats) -> Complexes:
    """Frequency response of an impulse response (Horner in q^-1)."""
    delay = np.exp(-1j * angles)
    total = np.zeros(len(angles), dtype=np.complex128)
    for value in impulses[::-1]:
        total = total * delay + value
    return total


def trimmed(impulses: Floats) -> Floats:
    """Leave out the end of an impulse response that nobody can see."""
    large = np.flatnonzero(np.abs(impulses) > _NEGLIGIBLE)
    return impulses[: large[-1] + 1] if large.size else impulses[:1]


def const_dist(filtering: Floats, distance: Floats) -> Floats:
    """Feedback of CONST_DIST: the filtered distance. distance: its answer to an offset pulse."""
    return trimmed(np.convolve(filtering, distance))


def both_encoders(
    filtering: Floats, distance: Floats, actual: Floats, reaction_cycles: int = 0
) -> Floats:
    """Feedback of CONST_DIST with both encoders: filter(d - (Z_act - Z_com)).

    actual: answer of the motor encoder. Z_com is the total set position of the cycle before.
    reaction_cycles: from the cycle that computes an offset to the one that sends it.
    """
    sent = np.zeros(2 + reaction_cycles)
    sent[-1] = 1.0
    return trimmed(np.convolve(filtering, _sum(distance, -actual, sent)))


def set_pos(filtering: Floats, distance: Floats, actual: Floats) -> Floats:
    """Feedback of SET_POS: the offset of the cycle before, less what the surface seems to move.

    e = filter(actual + sensor - SET_POS) - o and sensor = -distance.
    """
    seen = np.convolve(filtering, _sum(actual, -distance))
    return trimmed(_sum(np.array([0.0, 1.0]), -seen))


def without_offset(feedback: Floats) -> Floats:
    """Return the feedback of SET_POS without the offset of the cycle before: what is filtered."""
    return trimmed(_sum(feedback, -np.array([0.0, 1.0])))


def _sum(*parts: Floats) -> Floats:
    total = np.zeros(max(len(part) for part in parts))
    for part in parts:
        total[: len(part)] += part
    return total
