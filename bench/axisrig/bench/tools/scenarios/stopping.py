"""How long set positions may still change after an alarm: a bound from the lists and their speed.

An axis with the speed v brakes with the deceleration a, whose ramps rise in t1 and fall in t2, in

    t_up + v' / a + (t1 + t2) / 2,    v' = v + a_up t_up / 2

(docs/motion.md): t_up is what an acceleration a_up that acts as the alarm comes takes to come to
its end and to fall, v' the speed then. Without ramps this is v / a. On a path the axis with the
longest time decides; one that is taken off the path has no ramps (P-AXIS-00003). Which deceleration
acts depends on class and block (docs/errors.md), so the slowest of them counts.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from axisrig.bench.record.axes import Value
from axisrig.bench.record.facts import Facts
from axisrig.bench.record.series import Signal
from axisrig.kernel.time.clock import S, TimeNs

DEAD_CYCLES = 3
"""NC cycles: what was computed before the alarm is still sent, the last cycle of a ramp has a rest
of it, and an alarm comes between two SYNCs."""
CURVED = 2.0
"""The curve of a path of a kinematic may take half of the acceleration of an axis, so that its
ramps have the other half (docs/kinematics.md)."""
_GEAR = "getriebe[0]."
_A_MM_S2, _RAMP_US, _RAPID_RAMP_US = 1000.0, 50_000.0, 10_000.0
"""Accelerations, ramp times, those of rapid and least ones that a list does not write
(docs/parameters.md)."""


@dataclass(frozen=True)
class Braking:
    """A way to brake.

    a_mm_s2: deceleration. ramps_s: mean of its rise and fall. up_mm_s2, up_s: acceleration that may
    act as it begins, with what its ramps take.
    """

    a_mm_s2: float
    ramps_s: float = 0.0
    up_mm_s2: float = 0.0
    up_s: float = 0.0

    def time_s(self, speed_mm_s: float) -> float:
        """Return how long a speed takes to get to 0."""
        highest_mm_s = speed_mm_s + self.up_mm_s2 * self.up_s / 2.0
        return self.up_s + highest_mm_s / self.a_mm_s2 + self.ramps_s


def stop_ns(facts: Facts, alarm_ns: TimeNs, set_mm: Mapping[str, tuple[Signal, Signal]]) -> float:
    """Return until when set positions may change after an alarm, as a time since it, ns.

    set_mm: instants, ns, and set positions of each axis, shape (n,) both.
    """
    period_s = facts.timing.period_ns / S
    share = CURVED if facts.kinematics else 1.0
    longest_s = 0.0
    for axis, (times_ns, places_mm) in set_mm.items():
        speeds_mm_s = np.abs(np.diff(places_mm)) / period_s
        last = int(np.searchsorted(times_ns, alarm_ns, side="right")) - 1
        near_mm_s = speeds_mm_s[max(last - 1, 0) : last + 1]
        if len(near_mm_s):
            speed_mm_s = share * float(np.max(near_mm_s))
            ways = brakings(facts.axes[axis].written, facts.channel)
            longest_s = max(longest_s, *(way.time_s(speed_mm_s) for way in ways))
    cycles = DEAD_CYCLES + facts.timing.buffer_cycles
    return longest_s * S + cycles * facts.timing.period_ns


def brakings(axis: Mapping[str, Value], channel: Mapping[str, Value]) -> Iterator[Braking]:
    """Yield every way in which an axis may brake after an alarm, from what its lists write."""
    own = _value(axis, "dynamik.a_emergency") or _value(axis, "dynamik.a_max")
    if own:
        yield Braking(own)
    has_feedhold = bool(channel.get("use_drive_curr_limit", 0))
    if channel.get("prog_start.slope.profile", 0):
        yield from _ramped(axis, has_feedhold=has_feedhold)
    else:
        yield from _linear(axis, has_feedhold=has_feedhold)


def _linear(axis: Mapping[str, Value], *, has_feedhold: bool) -> Iterator[Braking]:
    """Yield those of the linear slope: P-AXIS-00282, 00283, 00280, 00281, 00024."""
    for step in ("stufe_1", "stufe_2", "grenz_stufe_1", "grenz_stufe_2"):
        up_mm_s2 = _value(axis, f"lslope_profil.a_{step}", _A_MM_S2)
        yield Braking(_value(axis, f"lslope_profil.d_{step}") or up_mm_s2)
    feedhold = _value(axis, "lslope_profil.a_feedh")
    if has_feedhold and feedhold:
        yield Braking(feedhold)


def _ramped(axis: Mapping[str, Value], *, has_feedhold: bool) -> Iterator[Braking]:
    """Yield those of TRAPEZ and SIN2: P-AXIS-00002, 00004, 00053 with their ramp times."""
    least_us = _value(axis, "dynamik.tr_min", _RAPID_RAMP_US)
    highest_mm_s2 = _value(axis, "dynamik.a_max") or np.inf

    def a_mm_s2(name: str) -> float:
        return min(_value(axis, f"slope_profil.{name}", _A_MM_S2), highest_mm_s2)

    def ramp_s(name: str, default_us: float = _RAMP_US) -> float:
        return max(_value(axis, f"slope_profil.{name}", default_us), least_us) * 1e-6

    rapid_s = ramp_s("tr_grenz", _RAPID_RAMP_US)
    ups = [
        (a_mm_s2("a_beschl"), ramp_s("tr_beschl_zu") + ramp_s("tr_beschl_ab")),
        (a_mm_s2("a_grenz"), 2.0 * rapid_s),
    ]
    downs = [
        (a_mm_s2("a_brems"), (ramp_s("tr_brems_zu") + ramp_s("tr_brems_ab")) / 2.0),
        (a_mm_s2("a_grenz"), rapid_s),
    ]
    if has_feedhold and _value(axis, "slope_profil.a_feedh"):
        hold_us = _value(axis, "slope_profil.tr_feedh") or rapid_s * 1e6
        downs.append((a_mm_s2("a_feedh"), max(hold_us, least_us) * 1e-6))
    for down_mm_s2, down_s in downs:
        for up_mm_s2, up_s in ups:
            yield Braking(down_mm_s2, down_s, up_mm_s2, up_s)


def _value(axis: Mapping[str, Value], name: str, default: float = 0.0) -> float:
    """Return a value of the gear of an axis in the unit of the list."""
    return float(axis.get(_GEAR + name, default))
