"""A run-up in which a stop at any instant keeps to the stroke of a probe.

A stop lets the acceleration fall before it brakes, so in the last ramp of a run-up to the highest
speed that a stroke allows it takes more way than from that speed. The acceleration therefore falls
in time with what is missing of the speed: the path follows the limit on which a stop takes the
whole stroke, in short ramps, and comes near the speed as an exponential does. Where no ramp goes on
along the limit it falls to 0, and a new pulse leads on: a ramp of SIN2 keeps its acceleration at
first, and one that may fall at once can leave no room for a slower fall.

Source: FCT-C4, P-AXIS-00086 with its remark, for what a stop may take; the stop is that of
`jerk_ramps.braking` (seven phases, ISG 117611531). How the run-up keeps to it is a decision of ours
(docs/ambiguities.md).
"""

import math
from dataclasses import dataclass

from axisrig.kernel.motion.course import Ramp
from axisrig.kernel.motion.jerk_ramps import (
    JerkLimits,
    Shape,
    acceleration,
    braking,
    going_on,
    gone,
    halved,
    part,
    pulse,
    way,
)

_STEPS_A_RATE = 2.0  # ramps in the time in which what is missing of the speed falls to 1/e
_HALVINGS = 12  # of what a ramp changes the acceleration by
_LOOKS = 8  # instants of a ramp at which a stop is tried, and of each such time of a long one
_LOOKS_SIN2 = 16  # the same: its acceleration stays at first, and then falls steeply
_MOST_LOOKS = 64
_RESERVE = 0.02  # share of the stroke that the speed leaves free, for what is between the looks
_ROUNDING = 1e-12  # share of the stroke that is rounding
_SAME_SPEED = 1e-6  # share of the feed that is as good as it
_LEAST_SHARE = 0.2  # share of an acceleration below which a new pulse leads to the feed sooner
_LEAST_GAIN = 1e-3  # share of what is missing of the feed that a pulse has to bring for a next one
_MOST_RAMPS = 500


@dataclass(frozen=True)
class Stroke:
    """What a path has to stop within while it accelerates.

    stop: brakes at the signal. stroke_mm: the way it may take.
    """

    stop: JerkLimits
    stroke_mm: float

    def has_room(self, speed_mm_s: float, a_mm_s2: float) -> bool:
        """Return whether a stop from a state takes less than the stroke, with the reserve."""
        stop, stroke_mm = self.stop, self.stroke_mm
        way_mm, _ = way(speed_mm_s, braking(speed_mm_s, a_mm_s2, stop), stop.shape)
        if way_mm <= (1.0 - _RESERVE) * stroke_mm:
            return True  # more than the reserve is free at any speed
        if way_mm > (1.0 + _ROUNDING) * stroke_mm:
            return False
        steady_mm, _ = way(speed_mm_s, braking(speed_mm_s, 0.0, stop), stop.shape)
        left_mm = max(stroke_mm - steady_mm, 0.0)
        return way_mm <= stroke_mm - _RESERVE * left_mm + _ROUNDING * stroke_mm

    def step_s(self, speed_mm_s: float) -> float:
        """Return the time of a ramp near a speed, by the rate at which a path comes near it.

        On the limit v a r = (v/a_s + t_s/2) (V - v) near the speed V, with the ramp time per
        acceleration r of the stop: a = rate (V - v).
        """
        stop = self.stop
        per_speed_s = speed_mm_s / stop.a_mm_s2 + 0.5 * stop.rise_s
        return speed_mm_s * stop.releasing_s3_mm / per_speed_s / _STEPS_A_RATE

    def holds(self, speed_mm_s: float, ramps: list[Ramp], shape: Shape, step_s: float) -> bool:
        """Return whether a stop has room throughout ramps that begin at a speed."""
        for ramp in ramps:
            a0, a1, whole_s, begun_s = ramp
            t_s = whole_s - begun_s
            if t_s <= 0.0:
                continue
            looks = _LOOKS if shape is Shape.TRAPEZ else _LOOKS_SIN2
            if t_s > step_s:
                many = looks * t_s / step_s if step_s else _MOST_LOOKS
                looks = math.ceil(min(many, _MOST_LOOKS))
            for look in range(looks + 1):
                dt = t_s * look / looks
                if begun_s > 0.0:
                    _, after_mm_s = gone(speed_mm_s, ramp, dt, shape)
                    a = acceleration(ramp._replace(begun_s=begun_s + dt), shape)
                    if not self.has_room(after_mm_s, a):
                        return False
                    continue
                risen, once, _ = part(shape, dt, t_s, a1 - a0)
                if not self.has_room(speed_mm_s + a0 * dt + once, a0 + risen):
                    return False
            _, speed_mm_s = way(speed_mm_s, [ramp], shape)
        return True


class RunUp:
    """Ramps that lead from a state to a feed as fast as the stroke allows.

    usual: those that would lead there without it. up: what they are made of. All are magnitudes.
    top_mm_s: the speed that is reached, within 1e-6 of the feed.
    """

    def __init__(
        self,
        speed_mm_s: float,
        feed_mm_s: float,
        usual: list[Ramp],
        up: JerkLimits,
        stroke: Stroke,
    ) -> None:
        self._up, self._stroke, self._feed_mm_s = up, stroke, feed_mm_s
        self._start_mm_s = speed_mm_s
        self._step_s = stroke.step_s(feed_mm_s)
        self.is_needed = not stroke.holds(speed_mm_s, usual, up.shape, 0.25 * self._step_s)
        self._ramps: list[Ramp] = []
        self.top_mm_s = speed_mm_s if self.is_needed else feed_mm_s
        while self.is_needed and usual and self._accelerate(usual):
            usual = pulse(self._missing_mm_s, up) if self._missing_mm_s > 0.0 else []

    def lead_to(self, peak_mm_s: float) -> list[Ramp]:
        """Return the ramps to a speed from that of the start to the top."""
        lead: list[Ramp] = []
        speed_mm_s, falling = self._start_mm_s, self._up.falling_s3_mm
        for ramp in self._ramps:
            _, after_mm_s = way(speed_mm_s, [ramp], self._up.shape)
            if after_mm_s + 0.5 * ramp.to_mm_s2 * ramp.to_mm_s2 * falling > peak_mm_s:
                lead.append(_landing(ramp, peak_mm_s - speed_mm_s, falling))
                break
            lead.append(ramp)
            speed_mm_s = after_mm_s
        last = lead[-1].to_mm_s2 if lead else 0.0
        lead.append(Ramp(last, 0.0, last * falling))
        return [ramp for ramp in lead if ramp.duration_s > ramp.begun_s]

    @property
    def _missing_mm_s(self) -> float:
        """What the feed is above the top, 0 where that is as good as it."""
        missing_mm_s = self._feed_mm_s - self.top_mm_s
        return missing_mm_s if missing_mm_s > _SAME_SPEED * self._feed_mm_s else 0.0

    def _accelerate(self, usual: list[Ramp]) -> bool:
        """Add a pulse: begin as ramps would that lead to the feed, go on along the limit.

        It may end below the feed. Return whether a next one comes nearer.
        """
        begun, from_mm_s = self._begin(usual), self.top_mm_s
        for ramp in begun:
            self._add(ramp)
        a = begun[-1].to_mm_s2 if begun else acceleration(usual[0], self._up.shape)
        a = self._go_on(a if begun or self._up.rise_s > 0.0 else self._jump(a))
        self._add(Ramp(a, 0.0, a * self._up.falling_s3_mm))
        gained_mm_s = self.top_mm_s - from_mm_s
        return gained_mm_s > _LEAST_GAIN * self._missing_mm_s and len(self._ramps) < _MOST_RAMPS

    def _is_free(self, ramps: list[Ramp], speed_mm_s: float, least_s: float = 0.0) -> bool:
        """Return whether a stop has room in ramps, and also if the acceleration falls after them.

        It then has to land at the feed at most. least_s: how long the fall takes at least.
        """
        last, shape = ramps[-1].to_mm_s2, self._up.shape
        _, after_mm_s = way(speed_mm_s, ramps, shape)
        if after_mm_s + 0.5 * last * last * self._up.falling_s3_mm > self._feed_mm_s:
            return False
        fall_s = max(last * self._up.falling_s3_mm, least_s)
        falls = [Ramp(last, 0.0, fall_s)] if last > 0.0 else []
        return self._stroke.holds(speed_mm_s, ramps + falls, shape, self._step_s)

    def _begin(self, usual: list[Ramp]) -> list[Ramp]:
        """Return as much of the rise and of the constant acceleration as leaves room."""
        begun: list[Ramp] = []
        for ramp in usual:
            if ramp.to_mm_s2 < ramp.from_mm_s2:
                break
            least, most = 0.0, 1.0
            if self._is_free([*begun, ramp], self.top_mm_s, self._step_s):
                begun.append(ramp)
                continue
            for _ in range(4 * _HALVINGS):
                share = 0.5 * (least + most)
                part_of = [*begun, _cut(ramp, share)]
                is_free = self._is_free(part_of, self.top_mm_s, self._step_s)
                least, most = (share, most) if is_free else (least, share)
            if least > 0.0:
                begun.append(_cut(ramp, least))
            break
        return begun

    def _jump(self, a: float) -> float:
        """Return the acceleration to begin with, where it may jump and the stroke allows less."""
        least, most = 0.0, a
        for _ in range(2 * _HALVINGS):
            middle = 0.5 * (least + most)
            jump = Ramp(middle, middle, self._step_s / _LOOKS)
            is_free = self._is_free([jump], self.top_mm_s, self._step_s)
            least, most = (middle, most) if is_free else (least, middle)
        return least

    def _go_on(self, a: float) -> float:
        """Let the acceleration fall along the limit up to the feed; return what is left of it."""
        falling = self._up.falling_s3_mm
        for _ in range(_MOST_RAMPS - len(self._ramps)):
            missing_mm_s = self._missing_mm_s
            if a <= 0.0 or missing_mm_s == 0.0:
                break
            step_s = max(self._step_s, a * self._up.falling_s3_mm / _LOOKS)
            hold_s = (missing_mm_s - 0.5 * a * a * falling) / a
            held = [Ramp(a, a, max(hold_s, 0.0))]
            if hold_s <= step_s and self._is_free_to_feed(held, a):
                self._add(held[0])
                break
            a = self._add(self._next(a, step_s))
        return a

    def _is_free_to_feed(self, held: list[Ramp], a: float) -> bool:
        ramps = [*held, Ramp(a, 0.0, a * self._up.falling_s3_mm)]
        return self._stroke.holds(self.top_mm_s, ramps, self._up.shape, self._step_s)

    def _next(self, a: float, step_s: float) -> Ramp:
        """Return the ramp that goes on along the limit; one to 0 where none does."""
        release_s = a * self._up.falling_s3_mm
        least = a * (1.0 - step_s / release_s) if release_s > step_s else 0.0
        found, low, high = None, least, a
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            ramp = Ramp(a, middle, step_s)
            after = Ramp(middle, middle * middle / a, step_s)  # a fall that goes on like this
            if self._is_free([ramp, after], self.top_mm_s):
                found, low = ramp, middle
            else:
                high = middle
        if found is not None and found.to_mm_s2 > _LEAST_SHARE * a:
            return found
        if least > 0.0 and self._up.shape is Shape.TRAPEZ:  # what was tried of the whole fall
            return Ramp(a, least, step_s)
        landing_s = (2.0 - _SAME_SPEED) * self._missing_mm_s / a  # at the feed
        slowly = Ramp(a, 0.0, max(min(step_s, landing_s), release_s))
        return slowly if self._is_free([slowly], self.top_mm_s) else Ramp(a, 0.0, release_s)

    def _add(self, ramp: Ramp) -> float:
        if ramp.duration_s > ramp.begun_s:
            self._ramps.append(ramp)
            _, self.top_mm_s = way(self.top_mm_s, [ramp], self._up.shape)
        return ramp.to_mm_s2


def _landing(ramp: Ramp, change_mm_s: float, falling: float) -> Ramp:
    """Return as much of a ramp as changes a speed by so much, with the fall after it."""

    def landed_mm_s(share: float) -> float:
        cut = _cut(ramp, share)
        a0, a1, t_s, begun_s = cut
        if begun_s > 0.0:
            return way(0.0, [cut], Shape.SIN2)[1] + 0.5 * a1 * a1 * falling
        return 0.5 * ((a0 + a1) * t_s + a1 * a1 * falling)

    return _cut(ramp, halved(landed_mm_s, change_mm_s, 0.0, 1.0))


def _cut(ramp: Ramp, share: float) -> Ramp:
    """Return the first part of a ramp, which changes the acceleration by a share.

    One that has begun goes on to less than its own end.
    """
    a0, a1, t_s, begun_s = ramp
    if begun_s > 0.0:
        now = acceleration(ramp, Shape.SIN2)
        end = now + share * (a1 - now)
        return going_on(a0, now, end, t_s * (end - a0) / (a1 - a0))
    return Ramp(a0, a0 + share * (a1 - a0), share * t_s)
