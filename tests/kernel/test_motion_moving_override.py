"""Whatever course an override takes and whenever a path is held, no limit of it is passed.

Random slopes of every type, feeds, lengths and courses of the override: steps, ramps, every cycle,
holds of a few cycles, all of them mixed. The limits are those of the slopes as they are given;
speed and acceleration are also taken from the positions of the cycles, as a drive gets them.
"""

import math
from dataclasses import dataclass, field
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.override_courses import between, course

from axisrig.kernel.motion.course import AnySlope, State
from axisrig.kernel.motion.curves import Line
from axisrig.kernel.motion.dynamics import Dynamics
from axisrig.kernel.motion.feed import Feed
from axisrig.kernel.motion.interpolator import Interpolator
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.time.clock import MS

T = 1e-3
LOOKS = 4  # in a cycle
STEP, TRAPEZ, SIN2 = "STEP", "TRAPEZ", "SIN2"
# Peak of the jerk over its mean in a ramp: (pi/2) sin(pi x) with SIN2
PEAK = {TRAPEZ: 1.0, SIN2: math.pi / 2.0}


@dataclass
class Limits:
    """What a path may do at most: speed, acceleration, jerk, stroke of a stop."""

    a_mm_s2: float
    jerk_mm_s3: float
    stop: AnySlope
    stroke_mm: float | None
    top_mm_s: float = 0.0
    before: State | None = None
    passed: list[str] = field(default_factory=list)

    def look(self, state: State, dt: float) -> None:
        """Note what a state passes; what a change takes from one look to the next counts too."""
        self._note("speed", state.speed_mm_s, self.top_mm_s, 1e-9)
        self._note("acceleration", abs(state.a_mm_s2), self.a_mm_s2, 1e-9)
        if self.before is not None:
            change = abs(state.a_mm_s2 - self.before.a_mm_s2)
            # Rounding of an end that is hit to 1e-9 mm
            self._note("jerk", change, self.jerk_mm_s3 * dt, 1e-3 * self.a_mm_s2)
            self._note("way back", self.before.path_mm - state.path_mm, 0.0, 1e-9)
        if self.stroke_mm is not None and state.a_mm_s2 >= 0.0:
            stop_mm = self.stop.stopped(state).end_mm - state.path_mm
            self._note("stroke", stop_mm, self.stroke_mm, 1e-6 * self.stroke_mm)
        self.before = state

    def _note(self, what: str, value: float, limit: float, rounding: float) -> None:
        if value > limit * (1.0 + 1e-6) + rounding:
            self.passed.append(f"{what} {value} of {limit}")


class Driven:
    """A straight path with random slopes that a random override leads."""

    def __init__(self, rng: Random, kind: str, *, has_stroke: bool) -> None:
        keeps_time = rng.random() < 0.25

        def time_s() -> float:
            return rng.choice([0.002, 0.01, 0.05, rng.uniform(0.001, 0.1)])

        def slope() -> AnySlope:
            a = between(rng, 100.0, 5000.0)
            if kind == STEP:
                return Slope(a, between(rng, 100.0, 5000.0), rng.uniform(1.0, 100.0))
            return JerkSlope(a, time_s(), time_s(), Shape(kind), keeps_time)

        up = slope()
        slopes = [up, slope(), slope()]
        if rng.random() < 0.5:
            slopes.append(slope())  # of the feedhold
        _, down, stop, *feedhold = slopes
        fastest = between(rng, 5.0, 500.0)
        dynamics = Dynamics(up, down.after(up), stop, fastest, feedhold[0] if feedhold else None)
        stroke_mm = between(rng, 0.1, 10.0) if has_stroke else None
        if stroke_mm is not None:
            dynamics = dynamics.within_stroke(stroke_mm)
        moving = [up, down, *feedhold]
        self.limits = Limits(_highest(moving), _steepest(moving, kind), stop, stroke_mm)
        self.length_mm = between(rng, 0.01, 300.0)
        self.feed = Feed(dynamics.speed_max_mm_s * rng.uniform(0.1, 1.3), dynamics)
        self.path = Interpolator("Z", MS)
        acceleration, deceleration = dynamics.acceleration, dynamics.deceleration
        profile = acceleration.plan(self.length_mm, self.feed.speed_mm_s, deceleration)
        self.path.follow(Line((0.0,), (self.length_mm,)), profile)
        self.at_mm = [0.0, 0.0]

    def cycle(self, share: float) -> None:
        limits, path = self.limits, self.path
        self.feed.lead(path, share or self.feed.share, is_held=share == 0.0)
        limits.top_mm_s = max(limits.top_mm_s, self.feed.speed_mm_s)
        if isinstance(self.feed.dynamics.acceleration, JerkSlope):
            for look in range(LOOKS):
                limits.look(path._profile.state((path._cycle + look / LOOKS) * T), T / LOOKS)
        path.advance()
        self.at_mm.append(path.path_travelled_mm)
        x0, x1, x2 = self.at_mm[-3:]
        limits._note("way", x2 - x1, limits.top_mm_s * T, 1e-9)
        limits._note("change of way", abs(x2 - 2.0 * x1 + x0), limits.a_mm_s2 * T * T, 3e-9)

    def run(self, shares: list[float]) -> None:
        for share in shares:
            if self.path.is_standing:
                break
            self.cycle(share)
        for _ in range(10**6):
            if self.path.is_standing:
                break
            self.feed.lead(self.path, 1.0, is_held=False)
            self.path.advance()
        assert self.limits.passed == []
        assert self.path.positions_mm == (self.length_mm,)


def _highest(slopes: list[AnySlope]) -> float:
    return max(
        max(s.a_low_mm_s2, s.a_high_mm_s2) if isinstance(s, Slope) else s.least_mm_s2
        for s in slopes
    )


def _steepest(slopes: list[AnySlope], kind: str) -> float:
    jerk_limited = [s for s in slopes if isinstance(s, JerkSlope)]
    means = (s.a_mm_s2 / t for s in jerk_limited for t in (s.rise_s, s.fall_s))
    return PEAK.get(kind, math.inf) * max(means, default=math.inf)


@pytest.mark.parametrize("kind", [STEP, TRAPEZ, SIN2])
@settings(max_examples=6, deadline=None)
@given(st.integers(0, 2**32))
@pytest.mark.long(but=1)
def test_no_course_of_an_override_passes_a_limit(kind: str, seed: int) -> None:
    rng = Random(seed)
    Driven(rng, kind, has_stroke=False).run(course(rng, 300))


@pytest.mark.long
@pytest.mark.parametrize("kind", [STEP, TRAPEZ, SIN2])
@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32))
def test_no_course_of_many_passes_a_limit(kind: str, seed: int) -> None:
    rng = Random(seed)
    Driven(rng, kind, has_stroke=False).run(course(rng, 3000))


@pytest.mark.long
@pytest.mark.parametrize("kind", [STEP, TRAPEZ, SIN2])
@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32))
def test_whatever_the_override_does_a_stop_keeps_to_the_stroke(kind: str, seed: int) -> None:
    rng = Random(seed)
    Driven(rng, kind, has_stroke=True).run(course(rng, 400))
