"""Path, speed and acceleration over time with a limited jerk, by closed form at any instant."""

from typing import NamedTuple

from axisrig.kernel.motion.course import Course, State
from axisrig.kernel.motion.jerk_ramps import Ramp, Shape, part, way


class Phase(NamedTuple):
    """A ramp on its place: times, path, speed and acceleration at both ends.

    is_from_end: computed back from its end, as everything that brakes into the end of the path.
    """

    start_s: float
    end_s: float
    start_mm: float
    end_mm: float
    start_mm_s: float
    end_mm_s: float
    start_mm_s2: float
    end_mm_s2: float
    is_from_end: bool


class JerkProfile(Course):
    """What a path with ramps does; phases: in order, without gaps in time, maybe none."""

    __slots__ = ("phases", "shape")

    def __init__(
        self, start_mm: float, end_mm: float, phases: tuple[Phase, ...], shape: Shape
    ) -> None:
        super().__init__(start_mm, end_mm, phases[-1].end_s if phases else 0.0)
        self.phases, self.shape = phases, shape

    def at(self, t_s: float) -> tuple[float, float]:
        """Return path in mm and speed in mm/s at `t_s`; from the duration on exactly the end."""
        path_mm, speed_mm_s, _ = self.state(t_s)
        return path_mm, speed_mm_s

    def state(self, t_s: float) -> State:
        """Return path, speed and acceleration at `t_s`.

        Path and speed do not leave the values at the ends of their phase, so that the path never
        goes back.
        """
        if t_s >= self.duration_s:
            return State(self.end_mm, 0.0, 0.0)
        for phase in self.phases:
            if t_s < phase.end_s:
                break
        t0, t1, s0, s1, v0, v1, a0, a1, is_from_end = phase
        if is_from_end:
            dt = t1 - t_s
            risen, once, twice = part(self.shape, dt, t1 - t0, a0 - a1)
            a, v = a1 + risen, v1 - (a1 * dt + once)
            s = s1 - ((v1 - 0.5 * a1 * dt) * dt - twice)
        else:
            dt = t_s - t0
            risen, once, twice = part(self.shape, dt, t1 - t0, a1 - a0)
            a, v = a0 + risen, v0 + (a0 * dt + once)
            s = s0 + ((v0 + 0.5 * a0 * dt) * dt + twice)
        slow, fast = (v0, v1) if v0 < v1 else (v1, v0)
        return State(min(max(s, s0), s1), min(max(v, slow), fast), a)


def joined(
    state: State, end_mm: float, lead: list[Ramp], tail: list[Ramp], shape: Shape
) -> JerkProfile:
    """Put ramps on their places: the lead from the start, the tail from the end backwards.

    What constant speed and rounding leave is between them.
    """
    start_mm, speed_mm_s, _ = state
    share = shape.way_share
    back: list[tuple[float, float, float, float, Ramp]] = []  # path and speed at both ends
    path_mm, slower_mm_s = end_mm, 0.0
    for ramp in reversed(tail):
        a0, a1, t_s = ramp
        faster_mm_s = max(slower_mm_s - 0.5 * (a0 + a1) * t_s, 0.0)
        way_mm = (slower_mm_s - (0.5 * a1 + share * (a0 - a1)) * t_s) * t_s
        before_mm = max(path_mm - max(way_mm, 0.0), start_mm)
        back.append((before_mm, path_mm, faster_mm_s, slower_mm_s, ramp))
        path_mm, slower_mm_s = before_mm, faster_mm_s
    tail_mm, time_s, path_mm = path_mm, 0.0, start_mm
    phases: list[Phase] = []
    for ramp in lead:
        a0, a1, t_s = ramp
        way_mm, after_mm_s = way(speed_mm_s, [ramp], shape)
        end_s, after_mm = time_s + t_s, min(path_mm + max(way_mm, 0.0), tail_mm)
        after_mm_s = max(after_mm_s, 0.0)
        phases.append(
            Phase(time_s, end_s, path_mm, after_mm, speed_mm_s, after_mm_s, a0, a1, False)
        )
        time_s, path_mm, speed_mm_s = end_s, after_mm, after_mm_s
    if path_mm < tail_mm and speed_mm_s > 0.0:
        end_s = time_s + (tail_mm - path_mm) / speed_mm_s
        constant = speed_mm_s, speed_mm_s, 0.0, 0.0
        phases.append(Phase(time_s, end_s, path_mm, tail_mm, *constant, False))
        time_s = end_s
    for before_mm, after_mm, faster_mm_s, slower_mm_s, (a0, a1, t_s) in reversed(back):
        speeds = faster_mm_s, slower_mm_s
        phases.append(Phase(time_s, time_s + t_s, before_mm, after_mm, *speeds, a0, a1, True))
        time_s += t_s
    return JerkProfile(start_mm, end_mm, tuple(phases), shape)
