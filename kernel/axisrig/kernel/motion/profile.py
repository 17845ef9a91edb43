"""Velocity profile of one straight path with the linear slope: piecewise constant acceleration.

The linear slope has two steps: up to a change-over speed one acceleration, above it another;
the same for the deceleration. Source: P-AXIS-00011, 00012, 00221, 00282, 00283.
All formulas are those of uniformly accelerated motion, s = (v1² - v0²) / 2a and t = (v1 - v0) / a.
"""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

from axisrig.kernel.motion.course import AnySlope, Course, State, Weights

_SAME_MM: Final = 1e-9  # more than rounding leaves of a path, less than anything shows


@dataclass(frozen=True)
class Slope(AnySlope):
    """Acceleration (or deceleration, also positive) below and above the change-over speed."""

    a_low_mm_s2: float
    a_high_mm_s2: float
    change_over_mm_s: float

    def __post_init__(self) -> None:
        if min(self.a_low_mm_s2, self.a_high_mm_s2, self.change_over_mm_s) <= 0.0:
            raise ValueError(f"a slope needs positive values: {self}")

    def scaled(self, share: float, highest_mm_s2: float = math.inf) -> "Slope":
        """Return the slope with both steps times `share`, none of them raised above a value."""
        low, high = (
            min(a * share, max(a, highest_mm_s2)) for a in (self.a_low_mm_s2, self.a_high_mm_s2)
        )
        return Slope(low, high, self.change_over_mm_s)

    def weighted(
        self, deceleration: AnySlope, weights: Weights, highest_mm_s2: float
    ) -> tuple[AnySlope, AnySlope]:
        """Return both slopes with their accelerations weighted; there are no ramp times."""
        assert isinstance(deceleration, Slope)
        return (
            self.scaled(weights.acceleration, highest_mm_s2),
            deceleration.scaled(weights.deceleration, highest_mm_s2),
        )

    @property
    def least_mm_s2(self) -> float:
        """The smaller one of both steps."""
        return min(self.a_low_mm_s2, self.a_high_mm_s2)

    @property
    def most_mm_s2(self) -> float:
        """The larger one of both steps."""
        return max(self.a_low_mm_s2, self.a_high_mm_s2)

    def along(self, share: float) -> "Slope":
        """Return what a path may do of which the axis moves by `share`."""
        return Slope(
            self.a_low_mm_s2 / share, self.a_high_mm_s2 / share, self.change_over_mm_s / share
        )

    def flat(self, a_mm_s2: float, speed_mm_s: float) -> "Slope":
        """Return a slope with one acceleration up to a speed."""
        return Slope(a_mm_s2, a_mm_s2, speed_mm_s)

    def weaker(self, other: AnySlope) -> "Slope":
        """Return the slope that both allow at every speed.

        Above the smaller change-over speed the other slope may still be below its own; there both
        of its steps limit.
        """
        assert isinstance(other, Slope)
        change_mm_s = min(self.change_over_mm_s, other.change_over_mm_s)
        high = [
            s.a_high_mm_s2
            if s.change_over_mm_s <= change_mm_s
            else min(s.a_low_mm_s2, s.a_high_mm_s2)
            for s in (self, other)
        ]
        return Slope(min(self.a_low_mm_s2, other.a_low_mm_s2), min(high), change_mm_s)

    def distance_mm(self, speed_mm_s: float) -> float:
        """Return the path between standstill and `speed_mm_s`.

        Source: s_b = (v² - v_s²) / 2 a_high + v_s² / 2 a_low for v above the change-over v_s.
        """
        low = min(speed_mm_s, self.change_over_mm_s)
        above = (speed_mm_s - low) * (speed_mm_s + low)
        return low * low / (2.0 * self.a_low_mm_s2) + above / (2.0 * self.a_high_mm_s2)

    def duration_s(self, speed_mm_s: float) -> float:
        """Return the time between standstill and `speed_mm_s`."""
        low = min(speed_mm_s, self.change_over_mm_s)
        return low / self.a_low_mm_s2 + (speed_mm_s - low) / self.a_high_mm_s2

    def steps(self, speed_mm_s: float, from_mm_s: float = 0.0) -> list[tuple[float, float, float]]:
        """Cut the ramp between two speeds at the change-over: (lower speed, upper speed, a)."""
        change = self.change_over_mm_s
        low_top, high_bottom = min(speed_mm_s, change), max(from_mm_s, change)
        steps = []
        if low_top > from_mm_s:
            steps.append((from_mm_s, low_top, self.a_low_mm_s2))
        if speed_mm_s > high_bottom:
            steps.append((high_bottom, speed_mm_s, self.a_high_mm_s2))
        return steps

    def speed_within(self, stroke_mm: float) -> float:
        """Return the highest speed, mm/s, from which a path can stop on `stroke_mm`.

        The inverse of `distance_mm`: v² = 2 a_low s up to the change-over speed v_s, above it
        v² = v_s² + 2 a_high (s - v_s² / 2 a_low).
        """
        change_mm_s = self.change_over_mm_s
        below_mm = change_mm_s * change_mm_s / (2.0 * self.a_low_mm_s2)
        if stroke_mm <= below_mm:
            return math.sqrt(2.0 * self.a_low_mm_s2 * stroke_mm)
        return math.sqrt(change_mm_s**2 + 2.0 * self.a_high_mm_s2 * (stroke_mm - below_mm))

    def plan(self, distance_mm: float, feed_mm_s: float, deceleration: AnySlope) -> "Profile":
        """Plan a path from standstill to standstill, see `plan`."""
        assert isinstance(deceleration, Slope)
        return plan(distance_mm, feed_mm_s, self, deceleration)

    def rest(
        self, state: State, end_mm: float, feed_mm_s: float, deceleration: AnySlope
    ) -> "Profile":
        """Plan the rest of a path, see `plan_rest`."""
        assert isinstance(deceleration, Slope)
        path_mm, speed_mm_s, _, _ = state
        return plan_rest(path_mm, end_mm, feed_mm_s, self, deceleration, speed_mm_s)

    def stopped(self, state: State, fastest_mm_s: float = math.inf) -> "Profile":
        """Return the profile that stops from a state with this slope."""
        path_mm, speed_mm_s, _, _ = state
        end_mm = path_mm + self.distance_mm(speed_mm_s)
        return _joined(path_mm, end_mm, [], 0.0, self.steps(speed_mm_s))

    def held(self, state: State, end_mm: float, deceleration: AnySlope) -> "Profile":
        """Return the profile that stops from a state no further than `end_mm`."""
        assert isinstance(deceleration, Slope)
        path_mm, speed_mm_s, _, _ = state
        for slope in (self, deceleration):
            stop_mm = path_mm + slope.distance_mm(speed_mm_s)
            if stop_mm <= end_mm:
                break
        if stop_mm > end_mm - _SAME_MM:
            stop_mm = end_mm
        return _joined(path_mm, stop_mm, [], 0.0, slope.steps(speed_mm_s))


class Segment(NamedTuple):
    """A part of constant acceleration: times, path and speed at both ends."""

    start_s: float
    end_s: float
    start_mm: float
    end_mm: float
    start_mm_s: float
    end_mm_s: float
    a_mm_s2: float


class Profile(Course):
    """Path and speed over time from `start_mm` to `end_mm`; time counts from 0.

    segments: in order, without gaps in time; empty for a profile at standstill.
    """

    __slots__ = ("segments",)

    def __init__(self, start_mm: float, end_mm: float, segments: tuple[Segment, ...]) -> None:
        super().__init__(start_mm, end_mm, segments[-1].end_s if segments else 0.0)
        self.segments = segments

    def at(self, t_s: float) -> tuple[float, float]:
        """Return path in mm and speed in mm/s at `t_s`; from the duration on exactly the end.

        The path never goes back: rising speed is counted from the start of a segment, falling
        speed from its end, so that every rounding is monotone. Neither path nor speed leaves the
        values at the ends of its segment, however late the time and short the ramp.
        """
        if t_s >= self.duration_s:
            return self.end_mm, 0.0
        for segment in self.segments:
            if t_s < segment.end_s:
                break
        t0, t1, s0, s1, v0, v1, a = segment
        if a >= 0.0:
            dt = t_s - t0
            s, v = s0 + (v0 + 0.5 * a * dt) * dt, v0 + a * dt
            return (s if s < s1 else s1), (v if v < v1 else v1)
        dt = t1 - t_s
        s, v = s1 - (v1 - 0.5 * a * dt) * dt, v1 - a * dt
        return (s if s > s0 else s0), (v if v < v0 else v0)

    def state(self, t_s: float) -> State:
        """Return where the path is at `t_s`; the acceleration of this slope may jump."""
        path_mm, speed_mm_s = self.at(t_s)
        return State(path_mm, speed_mm_s, 0.0)


def plan(
    distance_mm: float,
    feed_mm_s: float,
    acceleration: Slope,
    deceleration: Slope,
    start_speed_mm_s: float = 0.0,
) -> Profile:
    """Plan a path of `distance_mm` at no more than `feed_mm_s` that ends at standstill.

    A path too short for the feed turns over at the highest speed from which it can still stop.
    Raises ValueError if the path cannot be driven: a negative length, no feed, a start speed above
    the feed or too high to stop on the path.
    """
    if distance_mm < 0.0 or feed_mm_s <= 0.0 or not 0.0 <= start_speed_mm_s <= feed_mm_s:
        raise ValueError(f"no path: {distance_mm} mm at {start_speed_mm_s} to {feed_mm_s} mm/s")
    if deceleration.distance_mm(start_speed_mm_s) > distance_mm * (1.0 + 1e-12):
        raise ValueError(f"{start_speed_mm_s} mm/s cannot stop on {distance_mm} mm")
    return _planned(0.0, distance_mm, feed_mm_s, acceleration, deceleration, start_speed_mm_s)


def plan_rest(
    path_mm: float,
    end_mm: float,
    feed_mm_s: float,
    acceleration: Slope,
    deceleration: Slope,
    speed_mm_s: float,
) -> Profile:
    """Plan the rest of a path, from `path_mm` at `speed_mm_s` on, that ends at rest at `end_mm`.

    A speed above the feed comes down to it with the deceleration. One that just stops at the end,
    or by rounding a little late, brakes at once and ends there. Where a harder hold is let go too
    near the end, v²/2s stops there: no more than that of the hold, which stops no later.
    """
    braking_mm, left_mm = deceleration.distance_mm(speed_mm_s), end_mm - path_mm
    if braking_mm > left_mm + _SAME_MM and left_mm > 0.0:
        a_mm_s2 = 0.5 * speed_mm_s * speed_mm_s / left_mm
        return _joined(path_mm, end_mm, [], 0.0, [(0.0, speed_mm_s, a_mm_s2)])
    if braking_mm >= left_mm:
        return _joined(path_mm, end_mm, [], 0.0, deceleration.steps(speed_mm_s))
    if speed_mm_s > feed_mm_s:
        steps = reversed(deceleration.steps(speed_mm_s, feed_mm_s))
        slowing = [(high, low, -a) for low, high, a in steps]
        cruise_s = (end_mm - path_mm - braking_mm) / feed_mm_s
        return _joined(path_mm, end_mm, slowing, cruise_s, deceleration.steps(feed_mm_s))
    return _planned(path_mm, end_mm, feed_mm_s, acceleration, deceleration, speed_mm_s)


def _planned(
    start_mm: float,
    end_mm: float,
    feed_mm_s: float,
    acceleration: Slope,
    deceleration: Slope,
    start_speed_mm_s: float,
) -> Profile:
    distance_mm = end_mm - start_mm
    if distance_mm == 0.0:
        return Profile(end_mm, end_mm, ())
    gained_mm = acceleration.distance_mm(start_speed_mm_s)
    ramps_mm = acceleration.distance_mm(feed_mm_s) - gained_mm + deceleration.distance_mm(feed_mm_s)
    if ramps_mm <= distance_mm:
        peak_mm_s, cruise_mm = feed_mm_s, distance_mm - ramps_mm
    else:
        highest_mm_s = _peak_mm_s(distance_mm + gained_mm, acceleration, deceleration)
        peak_mm_s, cruise_mm = min(highest_mm_s, feed_mm_s), 0.0  # rounding exceeds it
    up = acceleration.steps(peak_mm_s, start_speed_mm_s)
    return _joined(start_mm, end_mm, up, cruise_mm / peak_mm_s, deceleration.steps(peak_mm_s))


def _peak_mm_s(distance_mm: float, acceleration: Slope, deceleration: Slope) -> float:
    """Return the speed whose two ramps from and to standstill fill `distance_mm`.

    Both ramps are linear in v² between the change-over speeds: s = k·v² + c, solved for v².
    """
    changes = sorted((acceleration.change_over_mm_s, deceleration.change_over_mm_s))
    below_mm_s = 0.0
    for change in changes:
        if acceleration.distance_mm(change) + deceleration.distance_mm(change) > distance_mm:
            break
        below_mm_s = change
    below_mm = acceleration.distance_mm(below_mm_s) + deceleration.distance_mm(below_mm_s)
    per_v2 = 0.0
    for slope in (acceleration, deceleration):
        low = below_mm_s < slope.change_over_mm_s
        per_v2 += 0.5 / (slope.a_low_mm_s2 if low else slope.a_high_mm_s2)
    return math.sqrt(below_mm_s**2 + (distance_mm - below_mm) / per_v2)


def _joined(
    start_mm: float,
    end_mm: float,
    first: list[tuple[float, float, float]],
    cruise_s: float,
    down: list[tuple[float, float, float]],
) -> Profile:
    """Join ramp, constant speed and ramp to one profile that ends exactly at `end_mm`.

    first: steps of the ramp to the constant speed, (speed before, speed after, a), in their order.
    down: those of the ramp to standstill, lowest speed first. That one is placed from the end
    backwards, the first one from the start; what rounding leaves is between them.
    """
    falling_mm = [end_mm]
    for low, high, a in down:
        falling_mm.append(max(falling_mm[-1] - (high - low) * (high + low) / (2.0 * a), start_mm))
    segments: list[Segment] = []
    time_s, path_mm = 0.0, start_mm
    for before, after, a in first:
        way_mm = (after - before) * (after + before) / (2.0 * a)
        end_of_step_mm = min(path_mm + way_mm, falling_mm[-1])
        end_s = time_s + (after - before) / a
        segments.append(Segment(time_s, end_s, path_mm, end_of_step_mm, before, after, a))
        time_s, path_mm = end_s, end_of_step_mm
    if cruise_s > 0.0:
        speed, end_s = down[-1][1], time_s + cruise_s
        segments.append(Segment(time_s, end_s, path_mm, falling_mm[-1], speed, speed, 0.0))
        time_s = end_s
    for at in reversed(range(len(down))):
        low, high, a = down[at]
        end_s = time_s + (high - low) / a
        segments.append(Segment(time_s, end_s, falling_mm[at + 1], falling_mm[at], high, low, -a))
        time_s = end_s
    return Profile(start_mm, end_mm, tuple(segments))
