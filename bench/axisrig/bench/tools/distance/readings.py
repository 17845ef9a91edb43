"""What each reading of the law of distance control shows on a control, with the list of 12.8.3.

The manuals leave three choices open (`axisrig.kernel.distance.law`). Each shows itself in the first
cycle of a dry run at rest, in the CNC object delta_deviation_pre_limiter, or in how far the offset
goes past a step of the surface. Computed by the models of `oracles/distance`, for the cycle and the
dead cycles of a rig. Lengths in um.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from axisrig.bench.oracles.distance.lists import CHANNEL, Control, Limits
from axisrig.bench.oracles.distance.loop import CONST_DIST
from axisrig.bench.oracles.distance.model import UNLIMITED, Law, Rig, simulate
from axisrig.bench.oracles.distance.smoothing import of_control
from axisrig.bench.rig.distance.channel import is_released
from axisrig.bench.rig.distance.check import released_axes
from axisrig.bench.rig.distance.loops import dead_cycles, listed_for
from axisrig.bench.rig.distance.sensors import sensors_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US, TimeNs

LIST = Control(kp=0.3, tn_s=0.0, tv_s=0.01, filter_type="MOVING_AVERAGE", count=20)
"""FCT-M3 12.8.3, with the usual choices."""
LIMITS: Limits = replace(UNLIMITED, v_mm_s=10.0, a_mm_s2=100.0)
OBJECT = "delta_deviation_pre_limiter"
SMALL_MM, LARGE_MM = 0.1, 2.8
_REST, _CYCLES, _UM = 2, 4000, 1e3
_PER = ("per_second", "per_cycle")


@dataclass(frozen=True)
class Shown:
    """A step and what is seen of it under one choice. first: in its cycle; later: from the 20th on.

    um; later is None for how far the offset goes past the surface.
    """

    step: str
    choice: str
    first_um: float
    later_um: float | None = None


def readings(settings: Settings) -> Iterator[tuple[str, list[Shown]]]:
    """Yield what is seen at rest, then past a step for each control of a rig, by its name.

    Raises UserError where the rig has no distance control.
    """
    period_ns = settings.rig.cycle.period_us * US
    yield "", [*_at_rest(period_ns)]
    names = [*released_axes(settings), *([CHANNEL] if is_released(settings) else [])]
    if not names:
        raise UserError("no axis of the rig has distance control", file=settings.files[0])
    for name in names:
        for sensor in sensors_of(settings, name):
            dead = dead_cycles(listed_for(settings, name), sensor)
            rig = Rig(dead.reaction, dead.way - sensor.age, sensor.age)
            owner = f"{'3D control' if name == CHANNEL else f'axis {name}'}, n = {dead.dead}"
            yield owner, [*_past(period_ns, rig)]


def _at_rest(period_ns: TimeNs) -> Iterator[Shown]:
    for per in _PER:
        control = replace(LIST, derivative=per)
        yield Shown("sensor", f'derivative = "{per}"', *_asked(control, period_ns, sensor=True))
    for of, per in (("feedback", _PER[0]), ("error", _PER[0]), ("error", _PER[1])):
        choice = f'derivative_of = "{of}"' + (", per cycle" if per == _PER[1] else "")
        control = replace(LIST, derivative_of=of, derivative=per)
        yield Shown("SET_DIST", choice, *_asked(control, period_ns, sensor=False))


def _asked(control: Control, period_ns: TimeNs, *, sensor: bool) -> tuple[float, float]:
    """Return what is asked for in the first cycle of a step, and once the filter is full."""
    law = Law(CONST_DIST, control, period_ns, smoothing=of_control(control, period_ns))
    asked = []
    for cycle in range(_REST + control.count + 1):
        step = SMALL_MM if cycle >= _REST else 0.0
        law.walk(step if sensor else 0.0, 0.0, 0.0, 0.0 if sensor else step)
        asked.append(law.step_mm * _UM)  # without limits that is what is asked for
    return asked[_REST], asked[-1]


def _past(period_ns: TimeNs, rig: Rig) -> Iterator[Shown]:
    surface = np.where(np.arange(_CYCLES) < _REST, 0.0, LARGE_MM)
    for limiter in ("slope", "clamp"):
        control = replace(LIST, limiter=limiter)
        law = Law(CONST_DIST, control, period_ns, LIMITS, of_control(control, period_ns))
        offsets = simulate(law, rig, surface, 0.0, 0.0).offset_mm
        yield Shown("surface", f'limiter = "{limiter}"', (float(offsets.max()) - LARGE_MM) * _UM)


def readings_text(settings: Settings) -> str:
    """Say it in lines of a terminal."""
    chosen, period_ms = settings.rig.distance, settings.rig.cycle.period_us * US / MS
    lines = [
        f'cycle {period_ms:g} ms; the rig has derivative_of = "{chosen.derivative_of}", limiter ='
        f' "{chosen.limiter}", derivative = "{chosen.derivative}" ([distance])',
        "on the control: the list of FCT-M3 12.8.3, as a program of an axis Z",
        "  N10 Z[DIST_CTRL FILTER_TYPE=MOVING_AVERAGE N_CYCLES=20 KP=0.3 I_TN=0 D_TV=0.01]",
        f"1. at rest, N20 Z[DIST_CTRL DRYRUN CONST_DIST SET_DIST=..]: the CNC object {OBJECT}",
    ]
    for owner, shown in readings(settings):
        if owner:
            lines.append(f"2. {owner}, ON CONST_DIST, v_max 10 mm/s, a_max 100 mm/s2: the offset")
        lines += [_line(one) for one in shown]
    return "\n".join(lines)


def _line(one: Shown) -> str:
    if one.later_um is None:
        step = f"{one.step} steps by {LARGE_MM:g} mm"
        seen = f"goes past it by {one.first_um / _UM:.3g} mm"
    else:
        step = f"{one.step} steps by {SMALL_MM:g} mm"
        seen = (
            f"{_digits(one.first_um)} um in the first cycle, {one.later_um:.1f} from cycle"
            f" {LIST.count} on"
        )
    return f"   {step:<26} {one.choice:<36} {seen}"


def _digits(value_um: float) -> str:
    """Four digits, as 1.515 and 16.5."""
    text = f"{value_um:.4g}"
    return text if "." in text else f"{text}.0"
