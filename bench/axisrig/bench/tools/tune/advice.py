"""What to set: limits of an identified loop, and kp, Tn, Tv that follow from it, with reasons."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from axisrig.bench.tools.tune.loop import Law, Loop

KP_MAX = 2.0
"""P-AXIS-00759 allows no more."""
TV_MAX_S = 2.0
"""P-AXIS-00765 allows no more."""
OVERSHOOT = 0.02
"""Share of a step by which the tool may pass it: towards the workpiece there is no room."""
SENSITIVITY_MAX = 2.0
"""Largest Ms; K. J. Astrom and T. Hagglund, PID Controllers, 1995, 4.7: 1.2 to 2 is sound."""
_DERIVATIVE_CYCLES = (0.5, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32)
_DERIVATIVE_GAIN, _NOISE_MAX = 0.75, 1.5
_INTEGRAL_CYCLES = tuple(int(value) for value in np.geomspace(20, 20_000, 31))
_INTEGRAL_OVERSHOOT = 0.1
_HALVINGS = 14
_CYCLES_MAX = 20_000


@dataclass(frozen=True)
class Quality:
    """What a law makes of a loop.

    overshoot: share of a step. rise_cycles: until 90 % of a step. area_cycles: sum of the error
    after a step of 1. noise_gain: offset over sensor. sensitivity: Ms. gain_margin: limit / kp.
    """

    overshoot: float
    rise_cycles: int
    area_cycles: float
    noise_gain: float
    sensitivity: float
    gain_margin: float


@dataclass(frozen=True)
class Advice:
    """law: suggested. limits: least and largest stable kp without I and D. reasons: sentences.

    slope_law: the same with an I part, for slopes that are to be followed without an error; None
    where none of the tried ones is calm enough.
    """

    law: Law
    quality: Quality
    limits: tuple[float, float]
    slope_law: Law | None
    reasons: tuple[str, ...]


def quality(loop: Loop, law: Law) -> Quality:
    """Judge a stable law by the answers of the loop."""
    answer = loop.step_answer(law, _length(loop, law))
    return Quality(
        overshoot=max(float(answer.max()) - 1, 0.0),
        rise_cycles=int(np.argmax(answer >= 0.9)),
        area_cycles=float(np.abs(1 - answer).sum()),
        noise_gain=loop.noise_gain(law),
        sensitivity=loop.sensitivity_peak(law),
        gain_margin=loop.stable_kp(law.tn_s, law.tv_s)[1] / law.kp,
    )


def advise(loop: Loop) -> Advice | None:
    """Suggest kp, Tn and Tv; None for a loop that no kp keeps stable."""
    limits = loop.stable_kp()
    plain = _calmest(loop, 0.0)
    if plain is None:
        return None
    chosen, reasons = plain, [_why_kp(loop, plain, limits)]
    better = min(_with_derivative(loop, plain), key=lambda law: 1 / law.kp, default=None)
    if better is None:
        reasons.append("d_tv 0: no derivative time makes it faster without much more noise")
    else:
        noise = loop.noise_gain(better) / loop.noise_gain(plain)
        reasons.append(
            f"d_tv {better.tv_s:g} s lets kp grow from {plain.kp:g} to {better.kp:g} at the same"
            f" calmness; the offset then has {noise:.1f} times the noise"
        )
        chosen = better
    slope_law = _with_integral(loop, chosen)
    reasons.append(_why_tn(slope_law))
    return Advice(chosen, quality(loop, chosen), limits, slope_law, tuple(reasons))


def cycles_in_words(count: int) -> str:
    """Say a number of cycles."""
    return f"{count} cycle{'' if count == 1 else 's'}"


def _why_kp(loop: Loop, law: Law, limits: tuple[float, float]) -> str:
    measured = quality(loop, law)
    return (
        f"kp {law.kp:g} is the largest that passes a step by {OVERSHOOT:.0%} at most and keeps"
        f" Ms <= {SENSITIVITY_MAX:g}; it is {limits[1] / law.kp:.1f} times below the limit and"
        f" reaches 90 % of a step in {cycles_in_words(measured.rise_cycles)}"
    )


def _why_tn(slope_law: Law | None) -> str:
    text = "i_tn 0: the offset adds up what kp finds, so a steady-state error goes away without it"
    if slope_law is None:
        return text
    return (
        f"{text}; i_tn {slope_law.tn_s:g} s with kp {slope_law.kp:g} would take the error on a"
        f" slope away too and pass a step by {_INTEGRAL_OVERSHOOT:.0%} at most"
    )


def _calmest(loop: Loop, tv_s: float) -> Law | None:
    """Find the largest kp that is calm, to two digits."""
    _, high = loop.stable_kp(tv_s=tv_s)
    low, high = 0.0, min(high, KP_MAX)
    if high == 0:
        return None
    if not _is_calm(loop, Law(high, 0.0, tv_s)):
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            if _is_calm(loop, Law(middle, 0.0, tv_s)):
                low = middle
            else:
                high = middle
    else:
        low = high
    return Law(_rounded_down(low), 0.0, tv_s) if low else None


def _is_calm(loop: Loop, law: Law) -> bool:
    if loop.sensitivity_peak(law) > SENSITIVITY_MAX or not loop.is_stable(law):
        return False
    return float(loop.step_answer(law, _length(loop, law)).max()) <= 1 + OVERSHOOT


def _with_derivative(loop: Loop, plain: Law) -> Iterator[Law]:
    """Give laws that are clearly faster than P control and not much noisier."""
    area, noise = quality(loop, plain).area_cycles, loop.noise_gain(plain)
    for cycles in _DERIVATIVE_CYCLES:
        tv_s = cycles * loop.unit_s
        if tv_s > TV_MAX_S:
            break
        law = _calmest(loop, tv_s)
        if law is None or loop.noise_gain(law) > _NOISE_MAX * noise:
            continue
        if quality(loop, law).area_cycles <= _DERIVATIVE_GAIN * area:
            yield law


def _with_integral(loop: Loop, law: Law) -> Law | None:
    """Find the shortest Tn with which a step is not passed by too much."""
    for cycles in _INTEGRAL_CYCLES:
        tried = replace(law, tn_s=_two_digits(cycles * loop.period_s))
        if not loop.is_stable(tried) or loop.sensitivity_peak(tried) > SENSITIVITY_MAX:
            continue
        if float(loop.step_answer(tried, _CYCLES_MAX).max()) <= 1 + _INTEGRAL_OVERSHOOT:
            return tried
    return None


def _length(loop: Loop, law: Law) -> int:
    """Cycles in which a step is over."""
    return min(_CYCLES_MAX, 4 * len(loop.feedback) + int(40 / law.kp) + 200)


def _two_digits(value: float) -> float:
    return float(f"{value:.2g}")


def _rounded_down(value: float) -> float:
    """Two significant digits, never more than the value."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.floor(value / unit + 1e-9) * unit:.2g}")
