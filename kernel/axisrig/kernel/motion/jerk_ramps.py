"""Ramps of a limited jerk: how they build a pulse that changes a speed, and how far they lead.

TRAPEZ has straight ramps, SIN2 ramps with the course of a squared sine. Both change the speed by
T (a0 + a1)/2 in the time T, so that speeds have the same formulas; the way differs by a share of
T². Source: TF5200 programming manual 207190411, the seven phases of ISG 117611531.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final, TypeVar

from axisrig.kernel.motion.course import AnySlope, Ramp

Limits = TypeVar("Limits", bound="JerkLimits")

_HALVINGS: Final = 100  # more than the digits of a double


class Shape(StrEnum):
    """The course of the acceleration in a ramp (`TYPE` of #SLOPE)."""

    TRAPEZ = "TRAPEZ"
    SIN2 = "SIN2"

    @property
    def way_share(self) -> float:
        """Share of (a1 - a0) T² by which a ramp lengthens the way: 1/6, or 1/4 - 1/pi²."""
        return 0.25 - 1.0 / (math.pi * math.pi) if self is Shape.SIN2 else 1.0 / 6.0


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
    for ramp in ramps:
        a0, a1, t_s, begun_s = ramp
        if begun_s > 0.0:
            left_mm, speed_mm_s = gone(speed_mm_s, ramp, t_s - begun_s, shape)
            way_mm += left_mm
            continue
        way_mm += (speed_mm_s + (0.5 * a0 + share * (a1 - a0)) * t_s) * t_s
        speed_mm_s += 0.5 * (a0 + a1) * t_s
    return way_mm, speed_mm_s


def gone(speed_mm_s: float, ramp: Ramp, dt: float, shape: Shape) -> tuple[float, float]:
    """Return how far a ramp that has begun leads on from a speed in `dt`, and the speed then.

    With b begun and the integrals I, J of the change from the begin of the ramp: v + a0 dt +
    I(b + dt) - I(b), and v dt + a0 dt²/2 + J(b + dt) - J(b) - I(b) dt.
    """
    a0, a1, t_s, begun_s = ramp
    _, once, twice = part(shape, begun_s, t_s, a1 - a0)
    _, then_once, then_twice = part(shape, begun_s + dt, t_s, a1 - a0)
    way_mm = (speed_mm_s + 0.5 * a0 * dt - once) * dt + (then_twice - twice)
    return way_mm, speed_mm_s + a0 * dt + (then_once - once)


def acceleration(ramp: Ramp, shape: Shape) -> float:
    """Return the acceleration with which a ramp goes on."""
    a0, a1, t_s, begun_s = ramp
    return a0 + part(shape, begun_s, t_s, a1 - a0)[0] if begun_s > 0.0 else a0


def going_on(start: float, now: float, end: float, duration_s: float) -> Ramp:
    """Return the ramp of SIN2 from `start` to `end` from where its acceleration is `now` on.

    Inverse of its course: sin²(pi x/2) = (now - start)/(end - start) at the share x of its time.
    """
    share = (now - start) / (end - start) if end != start else 1.0
    begun = 2.0 / math.pi * math.asin(math.sqrt(min(max(share, 0.0), 1.0)))
    return Ramp(start, end, duration_s, begun * duration_s)


def turned(rising: Ramp, s3_mm: float) -> list[Ramp]:
    """Return how an acceleration that is rising falls to 0 at once: the mirrored course.

    s3_mm: ramp time per acceleration of the fall. All are magnitudes.
    """
    base, top, now = rising.from_mm_s2, rising.to_mm_s2, acceleration(rising, Shape.SIN2)
    ramps = [going_on(top, now, base, (top - base) * s3_mm), Ramp(base, 0.0, base * s3_mm)]
    return [ramp for ramp in ramps if ramp.duration_s > ramp.begun_s]


def _peak(
    change_mm_s: float, limits: JerkLimits, rising: Ramp, start: float, end: float
) -> list[Ramp]:
    """Return the pulse of a ramp of SIN2 that is under way: it goes on, to another peak."""
    base, r, f = rising.from_mm_s2, limits.rising_s3_mm, limits.falling_s3_mm

    def ramps(peak: float) -> list[Ramp]:
        rise = going_on(base, start, peak, (peak - base) * r)
        return [rise, Ramp(peak, end, (peak - end) * f)]

    def gained_mm_s(peak: float) -> float:
        return way(0.0, ramps(peak), Shape.SIN2)[1]

    least, most = max(start, end), max(limits.a_mm_s2, start, end)
    if gained_mm_s(most) <= change_mm_s:
        peak, missing_mm_s = most, change_mm_s - gained_mm_s(most)
    elif gained_mm_s(least) >= change_mm_s:
        peak, missing_mm_s = least, 0.0
    else:
        peak, missing_mm_s = halved(gained_mm_s, change_mm_s, least, most), 0.0
    rise, fall = ramps(peak)
    held = Ramp(peak, peak, missing_mm_s / peak)
    return [ramp for ramp in (rise, held, fall) if ramp.duration_s > ramp.begun_s]


def pulse(
    change_mm_s: float,
    limits: JerkLimits,
    start: float = 0.0,
    end: float = 0.0,
    rising: Ramp | None = None,
) -> list[Ramp]:
    """Return the ramps that change a speed by so much, from one acceleration to another.

    All are magnitudes. Without a constant part the change is (p² - start²) r/2 + (p² - end²) f/2
    with the peak p and the ramp times per acceleration r and f. rising: the ramp of SIN2 that is
    under way at `start`; it goes on.
    """
    if rising is not None:
        return _peak(change_mm_s, limits, rising, start, end)
    per_rise, per_fall = limits.rising_s3_mm, limits.falling_s3_mm
    rise_s, fall_s = limits.rise_s, limits.fall_s
    if change_mm_s <= 0.0 and start == 0.0:
        return []
    if limits.keeps_time and start == 0.0 and end == 0.0 and rise_s + fall_s > 0.0:
        peak = min(limits.a_mm_s2, 2.0 * change_mm_s / (rise_s + fall_s))
    else:
        peak = max(limits.a_mm_s2, start, end)
        if per_rise + per_fall > 0.0:
            square = 2.0 * change_mm_s + start * start * per_rise + end * end * per_fall
            peak = min(peak, math.sqrt(max(square, 0.0) / (per_rise + per_fall)))
        peak = max(peak, start, end)
        rise_s, fall_s = (peak - start) * per_rise, (peak - end) * per_fall
    gained_mm_s = 0.5 * ((peak + start) * rise_s + (peak + end) * fall_s)
    hold_s = max(change_mm_s - gained_mm_s, 0.0) / peak
    ramps = (Ramp(start, peak, rise_s), Ramp(peak, peak, hold_s), Ramp(peak, end, fall_s))
    return [ramp for ramp in ramps if ramp.duration_s > 0.0]


def downwards(ramps: list[Ramp]) -> list[Ramp]:
    """Return the same ramps as a deceleration, or those of a deceleration as magnitudes."""
    return [Ramp(-a0, -a1, t_s, begun_s) for a0, a1, t_s, begun_s in ramps]


def braking(
    speed_mm_s: float, a_mm_s2: float, limits: JerkLimits, rising: Ramp | None = None
) -> list[Ramp]:
    """Return the ramps that stop from a state as soon as possible.

    An acceleration falls first: meanwhile the speed grows by a t/2. A deceleration that is larger
    than the one of the limits stays, and one that must end sooner than they let it ends with the
    speed. rising: magnitudes of the ramp of SIN2 that is under way, which a stop by a signal does
    not look at.
    """
    if a_mm_s2 > 0.0 and rising is not None:
        first = turned(rising, limits.releasing_s3_mm)
        _, speed_mm_s = way(speed_mm_s, first, limits.shape)
        return first + downwards(pulse(speed_mm_s, limits))
    if a_mm_s2 > 0.0:
        t_s = a_mm_s2 * limits.releasing_s3_mm
        first = [Ramp(a_mm_s2, 0.0, t_s)] if t_s > 0.0 else []
        return first + downwards(pulse(speed_mm_s + 0.5 * a_mm_s2 * t_s, limits))
    now = -a_mm_s2
    if now > 0.0 and 0.5 * now * now * limits.falling_s3_mm >= speed_mm_s:
        t_s = 2.0 * speed_mm_s / now
        return [Ramp(a_mm_s2, 0.0, t_s)] if t_s > 0.0 else []
    return downwards(pulse(speed_mm_s, limits, now, 0.0, rising))


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
