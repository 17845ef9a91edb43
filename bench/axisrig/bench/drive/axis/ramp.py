"""Courses of a profile generator: velocity ramps and ways from point to point.

A ramp between two velocities is linear, or has the shape sin2 with the same largest acceleration
a: v(t) = v0 + dv sin2(pi t / 2T), T = pi |dv| / 2a. The mean velocity of both is (v0 + v1) / 2, so
that a way with sin2 ramps is planned as one with linear ramps of 2a / pi.
Source: uniformly accelerated motion; CiA 402-2, object 6086 (0 linear, 1 sin2).
"""

import math
from typing import NamedTuple

LINEAR, SIN2 = 0, 1


class Ramp(NamedTuple):
    """A part of a course: from velocity `start_m_s` at `start_m` the velocity changes by dv."""

    begin_s: float
    duration_s: float
    start_m: float
    start_m_s: float
    dv_m_s: float


class Course:
    """Position and velocity over time, from 0 on; afterwards it rests or goes on evenly.

    braking_s: when the last ramp begins, infinite when the course does not end at rest.
    """

    __slots__ = ("braking_s", "duration_s", "end_m", "end_m_s", "ramps", "shape")

    def __init__(self, start_m: float, start_m_s: float, shape: int = LINEAR) -> None:
        self.ramps: list[Ramp] = []
        self.shape = shape
        self.duration_s = 0.0
        self.end_m, self.end_m_s = start_m, start_m_s
        self.braking_s = math.inf

    def change(self, velocity_m_s: float, acceleration_m_s2: float) -> None:
        """Append a ramp to a velocity."""
        dv = velocity_m_s - self.end_m_s
        if dv:
            full = 0.5 * math.pi if self.shape == SIN2 else 1.0
            self._append(full * abs(dv) / acceleration_m_s2, dv)
            self.end_m_s = velocity_m_s

    def cruise(self, way_m: float) -> None:
        """Append a way at the present velocity."""
        if way_m and self.end_m_s:
            self._append(way_m / self.end_m_s, 0.0)

    def _append(self, duration_s: float, dv: float) -> None:
        self.ramps.append(Ramp(self.duration_s, duration_s, self.end_m, self.end_m_s, dv))
        self.end_m += (self.end_m_s + 0.5 * dv) * duration_s
        self.duration_s += duration_s

    def at(self, time_s: float) -> tuple[float, float]:
        """Return position and velocity at a time."""
        if time_s >= self.duration_s:
            return self.end_m + self.end_m_s * (time_s - self.duration_s), self.end_m_s
        for ramp in self.ramps:
            if time_s < ramp.begin_s + ramp.duration_s:
                break
        begin_s, duration_s, start, v, dv = ramp
        t = time_s - begin_s
        if self.shape == SIN2:
            phase = math.pi * t / duration_s
            shift = duration_s / math.pi * math.sin(phase)
            return start + v * t + 0.5 * dv * (t - shift), v + 0.5 * dv * (1.0 - math.cos(phase))
        return start + (v + 0.5 * dv * t / duration_s) * t, v + dv * t / duration_s


def to_velocity(
    start: tuple[float, float], velocity_m_s: float, rates: tuple[float, float], shape: int = LINEAR
) -> Course:
    """Return the course to a velocity.

    start: position (m) and velocity (m/s). rates: acceleration and deceleration (m/s2); a change
    of direction first stops, then accelerates.
    """
    acceleration, deceleration = rates
    course = Course(*start, shape)
    v0 = start[1]
    if v0 * velocity_m_s < 0.0:
        course.change(0.0, deceleration)
        course.change(velocity_m_s, acceleration)
    else:
        course.change(velocity_m_s, acceleration if abs(velocity_m_s) > abs(v0) else deceleration)
    return course


def to_point(
    start: tuple[float, float],
    end_m: float,
    speed_m_s: float,
    rates: tuple[float, float],
    shape: int = LINEAR,
) -> Course:
    """Return the shortest course that ends at rest at `end_m`.

    Arguments as `to_velocity`; speed_m_s: the largest speed, above 0. A start from which the end
    cannot be reached without turning back stops first.
    """
    acceleration, deceleration = rates
    effective = 2.0 / math.pi if shape == SIN2 else 1.0
    course = Course(*start, shape)
    v0 = start[1]
    stop_m = v0 * abs(v0) / (2.0 * deceleration * effective)
    way_m = end_m - start[0]
    if v0 and (way_m - stop_m) * v0 < 0.0:
        course.change(0.0, deceleration)
        way_m = end_m - course.end_m
        v0 = 0.0
    sign = math.copysign(1.0, way_m)
    if abs(v0) > speed_m_s:
        course.change(sign * speed_m_s, deceleration)
        v0 = sign * speed_m_s
        way_m = end_m - course.end_m
    a, d = acceleration * effective, deceleration * effective
    peak = math.sqrt((2.0 * abs(way_m) * a * d + v0 * v0 * d) / (a + d))
    peak = max(min(peak, speed_m_s), abs(v0))
    if way_m:
        course.change(sign * peak, acceleration)
        braking_m = peak * peak / (2.0 * d)
        rest_m = abs(end_m - course.end_m) - braking_m
        if rest_m > 0.0:
            course.cruise(sign * rest_m)
        course.braking_s = course.duration_s
        course.change(0.0, deceleration)
    course.end_m, course.end_m_s = end_m, 0.0
    course.braking_s = min(course.braking_s, course.duration_s)
    return course
