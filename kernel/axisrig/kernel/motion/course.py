"""What every slope offers: plan a path, stop it, go on with it; and where the path is at a time.

A path begins and ends at standstill, so that its slopes are all of one kind: the linear one with
two steps (`profile`) or one with a limited jerk (`jerk`). Interpolator and feed know no difference.
What a kind has to provide raises NotImplementedError here: a compiled dataclass takes no abstract
base.
"""

import math
from typing import NamedTuple


class Ramp(NamedTuple):
    """A change of the acceleration from one value to another, or none; its duration.

    begun_s: how much of it is past where the path is: what is left of a ramp that a new plan
    finds under way.
    """

    from_mm_s2: float
    to_mm_s2: float
    duration_s: float
    begun_s: float = 0.0


class State(NamedTuple):
    """Where a path is, how fast, and its acceleration, negative while it brakes.

    a_mm_s2: 0 where the slope has no ramps, since nothing depends on it. left: the ramps that lead
    on from here to standstill, if a course is under way.
    """

    path_mm: float
    speed_mm_s: float
    a_mm_s2: float
    left: tuple[Ramp, ...] = ()


class Weights(NamedTuple):
    """Shares of accelerations and ramp times that a program sets, 1 = as in the lists.

    contour_time: of the ramp time of curves (G134). Source: P-CHAN-00001, P-CHAN-00073.
    """

    acceleration: float = 1.0
    deceleration: float = 1.0
    rise: float = 1.0
    fall: float = 1.0
    brake_rise: float = 1.0
    brake_fall: float = 1.0
    contour_time: float = 1.0


NO_WEIGHTS = Weights()


class Course:
    """Path and speed over time from `start_mm` to `end_mm`; time counts from 0."""

    __slots__ = ("duration_s", "end_mm", "start_mm")

    def __init__(self, start_mm: float, end_mm: float, duration_s: float) -> None:
        self.start_mm = start_mm
        self.end_mm = end_mm
        self.duration_s = duration_s

    def at(self, t_s: float) -> tuple[float, float]:
        """Return path in mm and speed in mm/s at `t_s`; from the duration on exactly the end."""
        raise NotImplementedError

    def state(self, t_s: float) -> State:
        """Return what a new plan from `t_s` on begins with."""
        raise NotImplementedError

    def brake(
        self, t_s: float, deceleration: "AnySlope", fastest_mm_s: float = math.inf
    ) -> "Course":
        """Return the course that stops from the state at `t_s`; its time counts from 0 there.

        The path runs on from its value at `t_s`; the distance to go is deleted. fastest_mm_s: see
        `AnySlope.stopped`.
        """
        return deceleration.stopped(self.state(t_s), fastest_mm_s)

    def held(self, t_s: float, feedhold: "AnySlope", deceleration: "AnySlope") -> "Course":
        """Return the course that stops from the state at `t_s` no further than the end.

        It brakes with `feedhold`; where that would go past the end, with the deceleration that the
        path was planned with, which never does.
        """
        return feedhold.held(self.state(t_s), self.end_mm, deceleration)


class AnySlope:
    """What an axis or a path may do to change its speed, upwards or downwards.

    Slopes that meet in one call are of one kind.
    """

    @property
    def least_mm_s2(self) -> float:
        """The acceleration that is there at every speed."""
        raise NotImplementedError

    @property
    def most_mm_s2(self) -> float:
        """The largest acceleration at any speed."""
        return self.least_mm_s2

    def weighted(
        self, deceleration: "AnySlope", weights: Weights, highest_mm_s2: float
    ) -> "tuple[AnySlope, AnySlope]":
        """Return this acceleration and a deceleration with weights.

        highest_mm_s2: what none of them may be raised above.
        """
        raise NotImplementedError

    def after(self, acceleration: "AnySlope") -> "AnySlope":
        """Return this deceleration for a motion that accelerates with another slope."""
        return self

    def along(self, share: float) -> "AnySlope":
        """Return what a path may do of which the axis moves by `share`, from 0 to 1."""
        raise NotImplementedError

    def weaker(self, other: "AnySlope") -> "AnySlope":
        """Return the slope that both allow at every speed."""
        raise NotImplementedError

    def flat(self, a_mm_s2: float, speed_mm_s: float) -> "AnySlope":
        """Return a slope with one acceleration up to a speed, with the jerk of this one."""
        raise NotImplementedError

    def distance_mm(self, speed_mm_s: float) -> float:
        """Return the path between standstill and a speed."""
        raise NotImplementedError

    def speed_within(self, stroke_mm: float) -> float:
        """Return the highest constant speed, mm/s, from which a path can stop on `stroke_mm`."""
        raise NotImplementedError

    def stopping_within(self, stroke_mm: float, stop: "AnySlope") -> "AnySlope":
        """Return this acceleration for a motion that `stop` ends within a stroke at any instant.

        A slope without ramps needs nothing: a stop is shorter the slower the path is.
        """
        return self

    def plan(self, distance_mm: float, feed_mm_s: float, deceleration: "AnySlope") -> Course:
        """Plan a path from standstill to standstill; this slope accelerates.

        Raises ValueError if the path cannot be driven.
        """
        raise NotImplementedError

    def rest(
        self, state: State, end_mm: float, feed_mm_s: float, deceleration: "AnySlope"
    ) -> Course:
        """Plan the rest of a path that ends at rest at `end_mm`; this slope accelerates."""
        raise NotImplementedError

    def stopped(self, state: State, fastest_mm_s: float = math.inf) -> Course:
        """Return the course that stops with this slope as soon as it can.

        fastest_mm_s: speed that an acceleration which falls first may lead to.
        """
        raise NotImplementedError

    def held(self, state: State, end_mm: float, deceleration: "AnySlope") -> Course:
        """Return the course that stops with this slope, no further than `end_mm`.

        deceleration: brakes where this one would go past it.
        """
        raise NotImplementedError
