"""The jerk-limited slope (TRAPEZ, SIN2): planned in the shortest time from any state to an end."""

import math
from dataclasses import dataclass, replace
from typing import Final

from axisrig.kernel.motion.course import AnySlope, Ramp, State, Weights
from axisrig.kernel.motion.jerk_profile import JerkProfile, joined
from axisrig.kernel.motion.jerk_ramps import (
    JerkLimits,
    Shape,
    braking,
    downwards,
    going_on,
    halved,
    pulse,
    turned,
    way,
    with_jerk,
)
from axisrig.kernel.motion.stroke import RunUp, Stroke

Ramps = tuple[list[Ramp], list[Ramp]]

_SAME_MM: Final = 1e-9  # more than rounding leaves of a path, less than anything shows
_STANDS_MM_S: Final = 1e-9  # a path that is no faster stands
_GAP_MM: Final = 1e-6  # ramps that end so far before the end of a path do not lead to it
_SAME_SPEED: Final = 1e-12  # share of a speed that is rounding


@dataclass(frozen=True)
class JerkSlope(JerkLimits):
    """The limits of an acceleration with its ramps, and what a path does with them.

    stroke: what a stop has to keep to at any instant while this slope accelerates.
    """

    stroke: Stroke | None = None

    def scaled(
        self, share: float, rise: float, fall: float, highest_mm_s2: float = math.inf
    ) -> "JerkSlope":
        """Return the slope with shares of acceleration and ramp times."""
        return replace(
            self,
            a_mm_s2=min(self.a_mm_s2 * share, max(self.a_mm_s2, highest_mm_s2)),
            rise_s=self.rise_s * rise,
            fall_s=self.fall_s * fall,
        )

    def weighted(
        self, deceleration: AnySlope, weights: Weights, highest_mm_s2: float
    ) -> tuple[AnySlope, AnySlope]:
        """Return both slopes with accelerations and ramp times weighted."""
        assert isinstance(deceleration, JerkSlope)
        up = self.scaled(weights.acceleration, weights.rise, weights.fall, highest_mm_s2)
        times = weights.brake_rise, weights.brake_fall
        down = deceleration.scaled(weights.deceleration, *times, highest_mm_s2)
        return up, down.after(up)

    def after(self, acceleration: AnySlope) -> "JerkSlope":
        """Return this deceleration for a motion that accelerates with another slope.

        Before it brakes, an acceleration falls with the jerk that it always falls with.
        """
        assert isinstance(acceleration, JerkSlope)
        return replace(self, release_s=acceleration.falling_s3_mm * self.a_mm_s2)

    def along(self, share: float) -> "JerkSlope":
        """Return what a path may do of which the axis moves by `share`: a and jerk over it."""
        return replace(self, a_mm_s2=self.a_mm_s2 / share)

    def weaker(self, other: AnySlope) -> "JerkSlope":
        """Return the slope with the smaller acceleration and the smaller jerk of both."""
        assert isinstance(other, JerkSlope)
        return with_jerk(
            self,
            min(self.a_mm_s2, other.a_mm_s2),
            max(self.rising_s3_mm, other.rising_s3_mm),
            max(self.falling_s3_mm, other.falling_s3_mm),
            max(self.releasing_s3_mm, other.releasing_s3_mm),
        )

    def flat(self, a_mm_s2: float, speed_mm_s: float) -> "JerkSlope":
        """Return the slope with another acceleration and the same jerk."""
        return with_jerk(self, a_mm_s2, self.rising_s3_mm, self.falling_s3_mm, self.releasing_s3_mm)

    def distance_mm(self, speed_mm_s: float) -> float:
        """Return the path from a constant speed to standstill.

        With equal ramps t_r it is v²/2a + v t_r/2 for v >= a t_r, else v sqrt(v t_r/a).
        """
        return way(speed_mm_s, braking(speed_mm_s, 0.0, self), self.shape)[0]

    def speed_within(self, stroke_mm: float) -> float:
        """Return the highest constant speed, mm/s, from which a path can stop on `stroke_mm`.

        With equal ramps a (-t_r/2 + sqrt(t_r²/4 + 2 H/a)) for v >= a t_r: the inverse of
        `distance_mm`.
        """
        highest_mm_s = math.sqrt(2.0 * self.a_mm_s2 * stroke_mm)  # without ramps
        if self.distance_mm(highest_mm_s) <= stroke_mm:
            return highest_mm_s
        return halved(self.distance_mm, stroke_mm, 0.0, highest_mm_s)

    def stopping_within(self, stroke_mm: float, stop: AnySlope) -> "JerkSlope":
        """Return this slope for a motion that `stop` ends within a stroke at any instant."""
        assert isinstance(stop, JerkSlope)
        return replace(self, stroke=Stroke(stop, stroke_mm))

    def plan(self, distance_mm: float, feed_mm_s: float, deceleration: AnySlope) -> JerkProfile:
        """Plan a path from standstill to standstill; this slope accelerates.

        Raises ValueError for a negative length and without a feed.
        """
        if distance_mm < 0.0 or feed_mm_s <= 0.0:
            raise ValueError(f"no path: {distance_mm} mm at {feed_mm_s} mm/s")
        return self.rest(State(0.0, 0.0, 0.0), distance_mm, feed_mm_s, deceleration)

    def rest(
        self, state: State, end_mm: float, feed_mm_s: float, deceleration: AnySlope
    ) -> JerkProfile:
        """Plan the rest of a path from any state on, in the shortest time; this one accelerates.

        A speed above the feed comes down to it at once. Where the path is too short for that, it
        brakes into its end, as weakly as it can while it is at the feed. A falling ramp of SIN2
        that is under way comes to its end before anything else begins, and one in which it begins
        to brake goes on where that leads to the end: a new one in its place would be steeper.
        """
        assert isinstance(deceleration, JerkSlope)
        kept, after = _kept(state, self)
        planned = _Rest(after, end_mm, feed_mm_s, self, deceleration).planned()
        if planned is None or (kept and _is_end(after, end_mm)):
            return self._to_its_end(state, end_mm, feed_mm_s, deceleration)
        lead, tail = planned
        return joined(state, end_mm, kept + lead, tail, self.shape)

    def _to_its_end(
        self, state: State, end_mm: float, feed_mm_s: float, deceleration: "JerkSlope"
    ) -> JerkProfile:
        """Let the course that is under way come to rest, and go on from there.

        It may be that of a harder hold, which these slopes cannot let go of before it stands.
        """
        left = _to_rest(state, self.shape)
        stop_mm = state.path_mm + way(state.speed_mm_s, left, self.shape)[0]
        standing = State(stop_mm, 0.0, 0.0)
        planned = _Rest(standing, end_mm, feed_mm_s, self, deceleration).planned()
        if planned is None or _is_end(standing, end_mm):
            return joined(state, end_mm, [], left, self.shape)
        lead, tail = planned
        return joined(state, end_mm, left + lead, tail, self.shape)

    def stopped(self, state: State, fastest_mm_s: float = math.inf) -> JerkProfile:
        """Return the profile that stops from a state with this slope, whatever ramp there is.

        The acceleration falls sooner where the speed would pass the fastest one meanwhile.
        """
        path_mm, speed_mm_s, a_mm_s2, _ = state
        slope = self
        squared = a_mm_s2 * a_mm_s2 if a_mm_s2 > 0.0 else 0.0
        if speed_mm_s + 0.5 * squared * self.releasing_s3_mm > fastest_mm_s > speed_mm_s:
            release_s3_mm = 2.0 * (fastest_mm_s - speed_mm_s) / squared
            slope = replace(self, release_s=release_s3_mm * self.a_mm_s2)
        ramps = braking(speed_mm_s, a_mm_s2, slope)
        end_mm = path_mm + way(speed_mm_s, ramps, self.shape)[0]
        return joined(state, end_mm, ramps, [], self.shape)

    def held(self, state: State, end_mm: float, deceleration: AnySlope) -> JerkProfile:
        """Return the profile that stops from a state no further than `end_mm`.

        A falling ramp of SIN2 that is under way comes to its end, a rising one turns. The
        acceleration falls as the motion planned it, where this slope would let it fall more slowly:
        the speed would pass the feed.
        """
        assert isinstance(deceleration, JerkSlope)
        release_s = min(self.releasing_s3_mm, deceleration.releasing_s3_mm) * self.a_mm_s2
        for slope in (replace(self, release_s=release_s), deceleration):
            kept, after = _kept(state, slope, slope.releasing_s3_mm)
            ramps = kept + braking(after.speed_mm_s, after.a_mm_s2, slope, _rising(after))
            stop_mm = state.path_mm + way(state.speed_mm_s, ramps, self.shape)[0]
            if stop_mm < end_mm - _SAME_MM:
                return joined(state, stop_mm, ramps, [], self.shape)
        fitted = _fitted(after, end_mm, deceleration)
        if fitted is None or (kept and _is_end(after, end_mm)):
            return joined(state, end_mm, [], list(state.left), self.shape)
        return joined(state, end_mm, kept, fitted, self.shape)


def _to_rest(state: State, shape: Shape) -> list[Ramp]:
    """Return the ramps that are left up to where the path stands first."""
    speed_mm_s = state.speed_mm_s
    ramps: list[Ramp] = []
    for ramp in state.left:
        if speed_mm_s < _STANDS_MM_S and ramp.to_mm_s2 > 0.0:
            break
        _, speed_mm_s = way(speed_mm_s, [ramp], shape)
        ramps.append(ramp)
    return ramps


def _rising(state: State) -> Ramp | None:
    """Return the ramp of SIN2 that is under way, if it rises, as magnitudes."""
    ramp = state.left[0] if state.left else None
    if ramp is None or ramp.begun_s == 0.0 or abs(ramp.to_mm_s2) <= abs(ramp.from_mm_s2):
        return None
    return ramp if ramp.to_mm_s2 > 0.0 else downwards([ramp])[0]


def _kept(
    state: State, slope: JerkSlope, releasing_s3_mm: float = math.inf
) -> tuple[list[Ramp], State]:
    """Return what is left of a falling ramp of SIN2, and the state after it.

    A new one in its place would begin slowly again: planned anew in every cycle, the acceleration
    would never fall. releasing_s3_mm: ramp time per acceleration of a harder slope, with which
    an acceleration may fall sooner.
    """
    path_mm, speed_mm_s, _, left = state
    ramp = left[0] if left else Ramp(0.0, 0.0, 0.0)
    a0, a1, duration_s, begun_s = ramp
    if begun_s == 0.0 or abs(a1) >= abs(a0):
        return [], state
    if a0 > 0.0:
        sooner_s = min(duration_s, (a0 - a1) * releasing_s3_mm)
        ramp = Ramp(a0, a1, sooner_s, begun_s * (sooner_s / duration_s))
    way_mm, after_mm_s = way(speed_mm_s, [ramp], slope.shape)
    return [ramp], State(path_mm + way_mm, max(after_mm_s, 0.0), a1, left[1:])


def _is_end(state: State, end_mm: float) -> bool:
    """Whether a path has come to its end, but for rounding."""
    path_mm, speed_mm_s, a_mm_s2, _ = state
    return a_mm_s2 == 0.0 and speed_mm_s < _STANDS_MM_S and path_mm > end_mm - _SAME_MM


def _fitted(state: State, end_mm: float, down: JerkSlope) -> list[Ramp] | None:
    """Return the ramps that brake at once; None where the end is too near for them, or too far.

    With longer ones where the end is a little further: with SIN2 a deceleration that falls in two
    ramps, over the feed, takes more way than in one, and ends between the two are reached by
    neither.
    """
    path_mm, speed_mm_s, a_mm_s2, left = state
    length_mm, under_way = end_mm - path_mm, _rising(state)

    def ramps(share: float) -> list[Ramp]:
        rising, falling = down.rising_s3_mm * share, down.falling_s3_mm * share
        longer = with_jerk(down, down.a_mm_s2, rising, falling, down.releasing_s3_mm * share)
        return braking(speed_mm_s, a_mm_s2, longer, under_way)

    def way_mm(share: float) -> float:
        return way(speed_mm_s, ramps(share), down.shape)[0]

    if left and way_mm(1.0) > length_mm + _SAME_MM:
        return None
    is_too_short = way_mm(1.0) < length_mm - _SAME_MM
    if is_too_short and way_mm(2.0) >= length_mm:
        return ramps(halved(way_mm, length_mm, 1.0, 2.0))
    is_braking = under_way is not None and a_mm_s2 < 0.0
    if is_braking and is_too_short and way_mm(1.0) < length_mm - _GAP_MM:
        return None  # a harder hold stands before the end, and longer ramps end with its speed
    return ramps(1.0)


class _Rest:
    """Plans to the end: over the highest speed possible, or with the least braking at first.

    The time is shortest with the highest speed between a first part, that accelerates or slows
    down, and one that brakes; its way grows with that speed. Where even the speed that is reached
    at once is too high, braking goes on: the deceleration falls no further than it must.
    """

    def __init__(
        self, state: State, end_mm: float, feed_mm_s: float, up: JerkSlope, down: JerkSlope
    ) -> None:
        self._state, self._end_mm, self._feed_mm_s = state, end_mm, feed_mm_s
        self._speed_mm_s, self._a = state.speed_mm_s, state.a_mm_s2
        self._rising = _rising(state)
        self._length_mm = end_mm - state.path_mm
        # An acceleration falls as it would at the end of its own pulse
        self._up, self._shape = up, up.shape
        rising, falling = down.rising_s3_mm, down.falling_s3_mm
        self._down = with_jerk(down, down.a_mm_s2, rising, falling, up.falling_s3_mm)
        self._now = max(-self._a, 0.0)  # deceleration
        self._falling = falling
        # Whether a deceleration that falls at once ends with the speed
        self._stands = 0.5 * self._now * self._now * falling > self._speed_mm_s
        if self._stands:
            self._falling = 2.0 * self._speed_mm_s / (self._now * self._now)
        self._first, self._at_once_mm_s = self._release()
        # A lead to less than this begins with the release
        self._turns_mm_s = math.inf if self._a <= 0.0 else self._at_once_mm_s
        if self._a > 0.0 and self._rising is not None:
            self._turns_mm_s = self._speed_mm_s + 0.5 * self._a * self._a * up.falling_s3_mm
        self._is_too_fast = self._at_once_mm_s > feed_mm_s * (1.0 + _SAME_SPEED)
        self._run_up: RunUp | None = None
        self._turns_first, self._run_up_from_mm_s = False, self._at_once_mm_s
        if up.stroke is not None and not self._is_too_fast:
            self._keep_to(up.stroke)

    def _release(self) -> tuple[list[Ramp], float]:
        """Return the ramps in which acceleration or deceleration falls, and the speed after them.

        A rising ramp of SIN2 turns; one of a deceleration ends with the speed at the latest.
        """
        speed_mm_s, shape = self._speed_mm_s, self._shape
        s3_mm = self._up.falling_s3_mm if self._a > 0.0 else self._falling
        if self._rising is None:
            release_s = abs(self._a) * s3_mm
            ramps = [Ramp(self._a, 0.0, release_s)] if release_s > 0.0 else []
            return ramps, speed_mm_s + 0.5 * self._a * release_s
        if self._a < 0.0:
            s3_mm = self._down.falling_s3_mm
        ramps = turned(self._rising, s3_mm)
        _, change_mm_s = way(0.0, ramps, shape)
        if self._a > 0.0:
            return ramps, speed_mm_s + change_mm_s
        if change_mm_s > speed_mm_s:
            ramps = turned(self._rising, s3_mm * speed_mm_s / change_mm_s)
            change_mm_s = speed_mm_s
        return downwards(ramps), speed_mm_s - change_mm_s

    def _keep_to(self, stroke: Stroke) -> None:
        """Accelerate so that a stop keeps to a stroke, where it would not do so anyway."""
        usual = self._lead_to(self._feed_mm_s)
        start_mm_s = self._speed_mm_s
        self._turns_first = self._a < 0.0 or (
            self._rising is not None and self._feed_mm_s < self._turns_mm_s
        )
        if self._turns_first:
            usual, start_mm_s = usual[len(self._first) :], self._at_once_mm_s
        elif self._rising is not None:
            self._run_up_from_mm_s = self._turns_mm_s
        run_up = RunUp(start_mm_s, self._feed_mm_s, usual, self._up, stroke)
        if run_up.is_needed:
            self._run_up, self._feed_mm_s = run_up, run_up.top_mm_s

    def planned(self) -> Ramps | None:
        """Return the ramps of the rest: those from its begin, and those into its end.

        None where the path is too short for them.
        """
        length_mm = self._length_mm
        as_it_is = self._as_it_is()
        if as_it_is is not None:
            return [], as_it_is
        if not self._is_too_fast:
            if self._way_over(self._feed_mm_s) <= length_mm:
                return self._over(self._feed_mm_s)
            if self._way_over(self._at_once_mm_s) <= length_mm:
                between = self._at_once_mm_s, self._feed_mm_s
                return self._over(halved(self._way_over, length_mm, *between))
        if self._is_too_fast or self._a <= 0.0:  # else too short by rounding, or by a harder hold
            way_mm = self._way_with(0.0)
            jumps = self._rising is not None
            if way_mm <= length_mm and not (
                jumps and self._stands and way_mm < length_mm - _GAP_MM
            ):
                return self._with(0.0)
            hardest = self._hardest()
            if hardest > 0.0 and self._way_with(hardest) < length_mm:
                left = halved(self._way_with, length_mm, hardest, 0.0)
                # A ramp of SIN2 that turns makes the way jump: none of them leads to the end then
                if not jumps or self._way_with(left) > length_mm - _GAP_MM:
                    return self._with(left)
        fitted = _fitted(self._state, self._end_mm, self._down)
        return None if fitted is None else ([], fitted)

    def _as_it_is(self) -> list[Ramp] | None:
        """Return nothing at the end, or the ramps that brake into it already; None elsewhere."""
        if self._length_mm <= 0.0 and self._speed_mm_s <= 0.0:
            return []
        if self._a >= 0.0 or self._rising is None:
            return None
        goes_on = braking(self._speed_mm_s, self._a, self._down, self._rising)
        way_mm, _ = way(self._speed_mm_s, goes_on, self._shape)
        return goes_on if abs(way_mm - self._length_mm) < _SAME_MM else None

    # Over a peak speed, from the one that is reached at once to the feed

    def _lead_to(self, peak_mm_s: float) -> list[Ramp]:
        if self._run_up is not None and peak_mm_s >= self._run_up_from_mm_s:
            return (self._first if self._turns_first else []) + self._run_up.lead_to(peak_mm_s)
        if peak_mm_s > self._turns_mm_s:
            return pulse(peak_mm_s - self._speed_mm_s, self._up, self._a, 0.0, self._rising)
        return self._first + pulse(peak_mm_s - self._at_once_mm_s, self._up)

    def _way_over(self, peak_mm_s: float) -> float:
        lead_mm, _ = way(self._speed_mm_s, self._lead_to(peak_mm_s), self._shape)
        return lead_mm + self._down.distance_mm(peak_mm_s)

    def _over(self, peak_mm_s: float) -> Ramps:
        return self._lead_to(peak_mm_s), braking(peak_mm_s, 0.0, self._down)

    # With a deceleration that is still there at the feed, or at the end of its fall

    def _slow_to(self, left: float) -> list[Ramp]:
        if not self._is_too_fast:
            t_s = (self._now - left) * self._falling
            return [Ramp(-self._now, -left, t_s)] if t_s > 0.0 else []
        if self._a > 0.0:
            change_mm_s = self._at_once_mm_s - self._feed_mm_s
            return self._first + downwards(pulse(change_mm_s, self._down, 0.0, left))
        change_mm_s = self._speed_mm_s - self._feed_mm_s
        fall_mm_s = 0.5 * (self._now * self._now - left * left) * self._down.falling_s3_mm
        if self._rising is not None and change_mm_s < fall_mm_s:  # it turns first
            change_mm_s = self._at_once_mm_s - self._feed_mm_s
            return self._first + downwards(pulse(change_mm_s, self._down, 0.0, left))
        return downwards(pulse(change_mm_s, self._down, self._now, left, self._rising))

    def _hardest(self) -> float:
        """Return the deceleration at the feed of a path that brakes as hard as it can."""
        if not self._is_too_fast:
            return self._now
        down, now = self._down, self._now
        from_mm_s = self._at_once_mm_s if self._a > 0.0 else self._speed_mm_s
        limits = [max(down.a_mm_s2, now)]
        if down.rise_s > 0.0:
            limits.append(self._risen(from_mm_s - self._feed_mm_s, limits[0]))
        if down.fall_s > 0.0:
            limits.append(math.sqrt(2.0 * self._feed_mm_s / down.falling_s3_mm))
        return min(limits)

    def _risen(self, change_mm_s: float, most: float) -> float:
        """Return what a deceleration rises to while it takes so much of the speed."""
        now, rising, s3_mm = self._now, self._rising, self._down.rising_s3_mm
        if self._a >= 0.0 or rising is None:
            return math.sqrt(2.0 * change_mm_s / s3_mm + now * now)
        base = rising.from_mm_s2

        def taken_mm_s(peak: float) -> float:
            return way(0.0, [going_on(base, now, peak, (peak - base) * s3_mm)], self._shape)[1]

        if taken_mm_s(most) <= change_mm_s:
            return most
        return halved(taken_mm_s, change_mm_s, now, most)

    def _way_with(self, left: float) -> float:
        lead_mm, speed_mm_s = way(self._speed_mm_s, self._slow_to(left), self._shape)
        tail_mm, _ = way(speed_mm_s, braking(speed_mm_s, -left, self._down), self._shape)
        return lead_mm + tail_mm

    def _with(self, left: float) -> Ramps:
        lead = self._slow_to(left)
        _, speed_mm_s = way(self._speed_mm_s, lead, self._shape)
        return lead, braking(speed_mm_s, -left, self._down)
