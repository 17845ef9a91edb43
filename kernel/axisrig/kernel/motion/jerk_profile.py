"""Path, speed and acceleration over time with a limited jerk, by closed form at any instant."""

from typing import Final, NamedTuple

from axisrig.kernel.motion.course import Course, Ramp, State
from axisrig.kernel.motion.jerk_ramps import Shape, acceleration, gone, part, way

_ROUNDING_S: Final = 1e-12


class Phase(NamedTuple):
    """A ramp on its place: times, path, speed and acceleration at both ends.

    is_from_end: computed back from its end, as everything that brakes into the end of the path.
    ramp: the whole one, of which the phase may be what is left.
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
    ramp: Ramp


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
        if t_s >= self.duration_s:
            return self.end_mm, 0.0
        here = _within(self._phase(t_s), t_s, self.shape)
        return here.path_mm, here.speed_mm_s

    def state(self, t_s: float) -> State:
        """Return path, speed and acceleration at `t_s`, and the ramps that are left."""
        if t_s >= self.duration_s:
            return State(self.end_mm, 0.0, 0.0)
        first = self._phase(t_s)
        here = _within(first, t_s, self.shape)
        a0, a1, duration_s, begun_s = first.ramp
        past_s = t_s - first.start_s + begun_s
        if self.shape is Shape.TRAPEZ or a0 == a1:
            ramp = Ramp(here.a_mm_s2, a1, first.end_s - t_s)
        else:  # its course depends on when it has begun
            past_s = min(past_s, duration_s) if past_s > _ROUNDING_S else 0.0
            ramp = Ramp(a0, a1, duration_s, past_s)
        later = [phase.ramp for phase in self.phases if phase.start_s > first.start_s]
        return State(here.path_mm, here.speed_mm_s, here.a_mm_s2, (ramp, *later))

    def _phase(self, t_s: float) -> Phase:
        for phase in self.phases:
            if t_s < phase.end_s:
                break
        return phase


def _within(phase: Phase, t_s: float, shape: Shape) -> State:
    """Return where a phase is at a time.

    Path and speed do not leave the values at the ends of their phase, so that the path never goes
    back.
    """
    t0, t1, s0, s1, v0, v1, a0, a1, is_from_end, ramp = phase
    if is_from_end:
        dt = t1 - t_s
        duration_s = t1 - t0 if ramp.begun_s == 0.0 else ramp.duration_s
        risen, once, twice = part(shape, dt, duration_s, ramp.from_mm_s2 - a1)
        a, v = a1 + risen, v1 - (a1 * dt + once)
        s = s1 - ((v1 - 0.5 * a1 * dt) * dt - twice)
    elif ramp.begun_s > 0.0:
        dt = t_s - t0
        way_mm, v = gone(v0, ramp, dt, shape)
        s, a = s0 + way_mm, acceleration(ramp._replace(begun_s=ramp.begun_s + dt), shape)
    else:
        dt = t_s - t0
        risen, once, twice = part(shape, dt, t1 - t0, a1 - a0)
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
    start_mm, speed_mm_s, _, _ = state
    share = shape.way_share
    back: list[tuple[float, float, float, float, Ramp]] = []  # path and speed at both ends
    path_mm, slower_mm_s = end_mm, 0.0
    for ramp in reversed(tail):
        a0, a1, t_s, begun_s = ramp
        if begun_s > 0.0:
            _, once, twice = part(shape, t_s - begun_s, t_s, a0 - a1)
            t_s -= begun_s
            faster_mm_s = max(slower_mm_s - (a1 * t_s + once), 0.0)
            way_mm = (slower_mm_s - 0.5 * a1 * t_s) * t_s - twice
        else:
            faster_mm_s = max(slower_mm_s - 0.5 * (a0 + a1) * t_s, 0.0)
            way_mm = (slower_mm_s - (0.5 * a1 + share * (a0 - a1)) * t_s) * t_s
        before_mm = max(path_mm - max(way_mm, 0.0), start_mm)
        back.append((before_mm, path_mm, faster_mm_s, slower_mm_s, ramp))
        path_mm, slower_mm_s = before_mm, faster_mm_s
    tail_mm, time_s, path_mm = path_mm, 0.0, start_mm
    phases: list[Phase] = []
    for ramp in lead:
        way_mm, after_mm_s = way(speed_mm_s, [ramp], shape)
        end_s = time_s + (ramp.duration_s - ramp.begun_s)
        after_mm = min(path_mm + max(way_mm, 0.0), tail_mm)
        after_mm_s = max(after_mm_s, 0.0)
        a = acceleration(ramp, shape), ramp.to_mm_s2
        speeds = speed_mm_s, after_mm_s
        phases.append(Phase(time_s, end_s, path_mm, after_mm, *speeds, *a, False, ramp))
        time_s, path_mm, speed_mm_s = end_s, after_mm, after_mm_s
    last_mm_s2 = lead[-1].to_mm_s2 if lead else state.a_mm_s2
    rest_s = _ROUNDING_S if last_mm_s2 else 0.0  # where braking goes on there is no constant speed
    if speed_mm_s > 0.0 and tail_mm - path_mm > rest_s * speed_mm_s:
        end_s = time_s + (tail_mm - path_mm) / speed_mm_s
        constant = speed_mm_s, speed_mm_s, 0.0, 0.0
        nothing = Ramp(0.0, 0.0, end_s - time_s)
        phases.append(Phase(time_s, end_s, path_mm, tail_mm, *constant, False, nothing))
        time_s = end_s
    for before_mm, after_mm, faster_mm_s, slower_mm_s, ramp in reversed(back):
        end_s = time_s + (ramp.duration_s - ramp.begun_s)
        speeds, a = (faster_mm_s, slower_mm_s), (acceleration(ramp, shape), ramp.to_mm_s2)
        phases.append(Phase(time_s, end_s, before_mm, after_mm, *speeds, *a, True, ramp))
        time_s = end_s
    return JerkProfile(start_mm, end_mm, tuple(phases), shape)
