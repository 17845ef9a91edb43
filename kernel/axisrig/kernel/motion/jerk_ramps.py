"""Ramps of a limited jerk: how they build a pulse that changes a speed, and how far they lead.

TRAPEZ has straight ramps, SIN2 ramps with the course of a squared sine. Both change the speed by
T (a0 + a1)/2 in the time T, so that speeds have the same formulas; the way differs by a share of
T². Source: TF5200 programming manual 207190411, the seven phases of ISG 117611531.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import NamedTuple, TypeVar

from axisrig.kernel.motion.course import AnySlope

Limits = TypeVar("Limits", bound="JerkLimits")

_HALVINGS = 100  # more than the digits of a double


class Shape(StrEnum):
    """The course of the acceleration in a ramp (`TYPE` of #SLOPE)."""

    TRAPEZ = "TRAPEZ"
    SIN2 = "SIN2"

    @property
    def way_share(self) -> float:
        """Share of (a1 - a0) T² by which a ramp lengthens the way: 1/6, or 1/4 - 1/pi²."""
        return 0.25 - 1.0 / (math.pi * math.pi) if self is Shape.SIN2 else 1.0 / 6.0


class Ramp(NamedTuple):
    """A change of the acceleration from one value to another, or none; its duration."""

    from_mm_s2: float
    to_mm_s2: float
    duration_s: float


@dataclass(frozen=True)
class JerkLimits(AnySlope):
    """An acceleration (or deceleration, also positive) that builds up and goes down in ramps.

    rise_s, fall_s: of a ramp to the whole acceleration and back; a smaller one takes its share of
    them (constant jerk), or all of it with `keeps_time` (P-CHAN-00349), where a whole pulse begins
    at constant speed.
    release_s: of a deceleration, the time in which as large an acceleration falls to 0 before it
    begins; None = `rise_s`.
    """

    a_mm_s2: float
    rise_s: float
    fall_s: float
    shape: Shape = Shape.TRAPEZ
    keeps_time: bool = False
    release_s: float | None = None

    def __post_init__(self) -> None:
        if self.a_mm_s2 <= 0.0 or min(self.rise_s, self.fall_s) < 0.0:
            raise ValueError(f"a slope needs an acceleration and no negative time: {self}")

    @property
    def least_mm_s2(self) -> float:
        """The acceleration."""
        return self.a_mm_s2

    @property
    def rising_s3_mm(self) -> float:
        """Ramp time per acceleration while it rises: one over the jerk."""
        return self.rise_s / self.a_mm_s2

    @property
    def falling_s3_mm(self) -> float:
        """Ramp time per acceleration while it falls."""
        return self.fall_s / self.a_mm_s2

    @property
    def releasing_s3_mm(self) -> float:
        """Ramp time per acceleration while an acceleration falls before this one brakes."""
        return (self.rise_s if self.release_s is None else self.release_s) / self.a_mm_s2


def with_jerk(
    limits: Limits, a_mm_s2: float, rising: float, falling: float, releasing: float
) -> Limits:
    """Return limits with another acceleration and these ramp times per acceleration, s³/mm."""
    rise_s, fall_s, release_s = rising * a_mm_s2, falling * a_mm_s2, releasing * a_mm_s2
    return replace(limits, a_mm_s2=a_mm_s2, rise_s=rise_s, fall_s=fall_s, release_s=release_s)


def way(speed_mm_s: float, ramps: list[Ramp], shape: Shape) -> tuple[float, float]:
    """Return how far ramps lead from a speed on, and the speed after them; mm, mm/s.

    One ramp: v T + a0 T²/2 + k (a1 - a0) T², k of the shape. Source: integral of its acceleration.
    """
    way_mm, share = 0.0, shape.way_share
    for a0, a1, t_s in ramps:
        way_mm += (speed_mm_s + (0.5 * a0 + share * (a1 - a0)) * t_s) * t_s
        speed_mm_s += 0.5 * (a0 + a1) * t_s
    return way_mm, speed_mm_s


def pulse(
    change_mm_s: float, limits: JerkLimits, start: float = 0.0, end: float = 0.0
) -> list[Ramp]:
    """Return the ramps that change a speed by so much, from one acceleration to another.

    All are magnitudes. Without a constant part the change is (p² - start²) r/2 + (p² - end²) f/2
    with the peak p and the ramp times per acceleration r and f.
    """
    rising, falling = limits.rising_s3_mm, limits.falling_s3_mm
    rise_s, fall_s = limits.rise_s, limits.fall_s
    if change_mm_s <= 0.0 and start == 0.0:
        return []
    if limits.keeps_time and start == 0.0 and end == 0.0 and rise_s + fall_s > 0.0:
        peak = min(limits.a_mm_s2, 2.0 * change_mm_s / (rise_s + fall_s))
    else:
        peak = max(limits.a_mm_s2, start, end)
        if rising + falling > 0.0:
            square = 2.0 * change_mm_s + start * start * rising + end * end * falling
            peak = min(peak, math.sqrt(max(square, 0.0) / (rising + falling)))
        peak = max(peak, start, end)
        rise_s, fall_s = (peak - start) * rising, (peak - end) * falling
    gained_mm_s = 0.5 * ((peak + start) * rise_s + (peak + end) * fall_s)
    hold_s = max(change_mm_s - gained_mm_s, 0.0) / peak
    ramps = (Ramp(start, peak, rise_s), Ramp(peak, peak, hold_s), Ramp(peak, end, fall_s))
    return [ramp for ramp in ramps if ramp.duration_s > 0.0]


def downwards(ramps: list[Ramp]) -> list[Ramp]:
    """Return the same ramps as a deceleration."""
    return [Ramp(-a0, -a1, t_s) for a0, a1, t_s in ramps]


def braking(speed_mm_s: float, a_mm_s2: float, limits: JerkLimits) -> list[Ramp]:
    """Return the ramps that stop from a state as soon as possible.

    An acceleration falls first: meanwhile the speed grows by a t/2. A deceleration that is larger
    than the one of the limits stays, and one that must end sooner than they let it ends with the
    speed.
    """
    if a_mm_s2 > 0.0:
        t_s = a_mm_s2 * limits.releasing_s3_mm
        first = [Ramp(a_mm_s2, 0.0, t_s)] if t_s > 0.0 else []
        return first + downwards(pulse(speed_mm_s + 0.5 * a_mm_s2 * t_s, limits))
    now = -a_mm_s2
    if now > 0.0 and 0.5 * now * now * limits.falling_s3_mm >= speed_mm_s:
        t_s = 2.0 * speed_mm_s / now
        return [Ramp(a_mm_s2, 0.0, t_s)] if t_s > 0.0 else []
    return downwards(pulse(speed_mm_s, limits, now))


def part(shape: Shape, dt: float, duration_s: float, change: float) -> tuple[float, float, float]:
    """Return a change of the acceleration after `dt` of its ramp, and its two integrals.

    With x = dt/T: TRAPEZ x, x dt/2, x dt²/6; SIN2 sin²(pi x/2), dt/2 - T sin(pi x)/2pi,
    dt²/4 - (T/pi)² sin²(pi x/2); all times the change.
    """
    if change == 0.0:
        return 0.0, 0.0, 0.0
    share = dt / duration_s
    if shape is Shape.SIN2:
        risen = math.sin(0.5 * math.pi * share) ** 2
        once = 0.5 * dt - duration_s * math.sin(math.pi * share) / (2.0 * math.pi)
        twice = 0.25 * dt * dt - (duration_s / math.pi) ** 2 * risen
        return change * risen, change * once, change * twice
    risen = change * share
    return risen, 0.5 * risen * dt, risen * dt * dt / 6.0


def halved(function: Callable[[float], float], wanted: float, below: float, above: float) -> float:
    """Return the last double on the side of `below` before a monotone function passes a value.

    below: where the function is at most `wanted`; above: where it is more.
    """
    for _ in range(_HALVINGS):
        middle = 0.5 * (below + above)
        if middle in (below, above):
            break
        if function(middle) <= wanted:
            below = middle
        else:
            above = middle
    return below
