"""The loop of a distance control on a rig: its dead cycles, and up to which kp it is stable.

The dead cycles follow from P-AXIS-00509 or P-CHAN-00818, the telegram of the sensor and its age on
the way; limits of kp from the closed forms of `bench/axisrig/bench/oracles/distance`.
"""

from axisrig.bench.oracles.distance.cycles import DeadCycles, predicted
from axisrig.bench.oracles.distance.limits import braking_mm, overshoot_mm, sloped_overshoot_mm
from axisrig.bench.oracles.distance.lists import (
    CHANNEL,
    OF_CHANNEL,
    Control,
    Listed,
    as_written,
)
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop, growth
from axisrig.bench.oracles.distance.model import first_order_drive
from axisrig.bench.oracles.distance.sample_hold import held_growth, held_limit
from axisrig.bench.oracles.distance.smoothing import none, of_control
from axisrig.bench.oracles.distance.stability import kp_limit
from axisrig.bench.rig.distance.sensors import Sensor
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.channel.distance.sensor import PERIODS_MAX
from axisrig.kernel.parameters.start_up import OPTIMISED
from axisrig.kernel.time.clock import MS, US, S

WITHOUT_LAG = "AxisRig.Drives.KinematicAxis"
MODES = (SET_POS, CONST_DIST, BOTH)
_DELAY = "antr.nbr_delay_cycles"
AT_LIMIT = 1e-6
"""Share of a limit of kp in which a loop counts as above it: there it rings for ever."""


def dead_cycles(listed: Listed, sensor: Sensor) -> DeadCycles:
    """Return the dead cycles of a fresh sensor value."""
    return predicted(
        is_optimized=listed.is_optimized, sensor_age_cycles=sensor.age, late_cycles=sensor.late
    )


def loop_of(
    settings: Settings,
    name: str,
    sensor: Sensor,
    mode: str,
    lag_s: float = 0.0,
    control: Control | None = None,
) -> Loop:
    """Return the loop of an axis, or of CHANNEL, in a mode.

    lag_s: of its drive, first order. control: None = as listed.
    """
    listed, period_ns = listed_for(settings, name), settings.rig.cycle.period_us * US
    control, dead = control or listed.control, dead_cycles(listed, sensor)
    return Loop(
        mode,
        dead.dead - sensor.age,
        of_control(control, period_ns),
        sent_cycles=dead.reaction,
        skew_cycles=sensor.age,
        integral=control.integral(period_ns),
        derivative=control.rate(period_ns),
        of_error=control.looks_at_error,
        drive=first_order_drive(lag_s, period_ns) if lag_s else none(),
    )


def listed_for(settings: Settings, name: str) -> Listed:
    """Return what list and plan say of the control of an axis, or of CHANNEL."""
    if name == CHANNEL:
        listed = as_written(dict(settings.channel.items()), OF_CHANNEL)
    else:
        listed = as_written(dict(settings.axis[name].items()))
    return listed.choosing(settings.rig.distance)


def unstable(
    settings: Settings, name: str, sensor: Sensor, mode: str, control: Control
) -> str | None:
    """Say why a control that acts cannot be stable, None when it can.

    control: what acts, programmed and written values in it.
    """
    loop, kp = loop_of(settings, name, sensor, mode, control=control), control.kp
    rate = growth(loop, kp) if sensor.every == 1 else held_growth(loop, sensor.every, kp)
    limit = limit_of(loop, sensor)
    if rate <= 1.0 and not is_beyond(kp, limit):
        return None
    dead = dead_cycles(listed_for(settings, name), sensor).dead
    whose, parameter = f"axis {name}", "P-AXIS-00759"
    if name == CHANNEL:
        whose, parameter = "3D control of the channel", "P-CHAN-00821"
    return (
        f"{whose}: {mode} by {sensor.words} is unstable with kp {kp:g} ({parameter}): its"
        f" limit is {limit:.3g} with {dead} dead cycles and the filter that acts"
        f" ({loop.smoothing.name}); axisrig tune distance finds a kp"
    )


def is_beyond(kp: float, limit: float) -> bool:
    """Whether a kp is at its limit or above it."""
    return kp >= limit * (1.0 - AT_LIMIT)


def limit_of(loop: Loop, sensor: Sensor) -> float:
    """Return the limit of kp with a sensor."""
    return kp_limit(loop) if sensor.every == 1 else held_limit(loop, sensor.every)


def dead_words(dead: DeadCycles, sensor: Sensor) -> str:
    """Return the dead cycles in words."""
    if sensor.every == 1:
        return f"n = {dead.dead}"
    return f"n = {dead.dead} to {dead.dead + sensor.every - 1}, a value comes every {sensor.every}."


def limits_words(listed: Listed, period_us: int, loop: Loop) -> str:
    """Say what v_max and a_max make of a far surface; loop: of the constant distance."""
    limits = listed.limits
    if not listed.control.is_sloped:
        return clamp_words(listed, period_us)
    if limits.a_mm_s2 <= 0.0:
        return "a control without a_max does not move by them"
    unseen = loop.dead_cycles + loop.skew_cycles + loop.smoothing.delay_cycles
    past = sloped_overshoot_mm(limits.v_mm_s, period_us * US, unseen)
    a_mm_s2 = limits.a_mm_s2
    if limits.adaptive is not None:
        a_mm_s2 = min(a_mm_s2, limits.adaptive[0])
    behind = braking_mm(limits.v_mm_s, a_mm_s2)
    return (
        f"v_max {limits.v_mm_s:g} mm/s and a_max {limits.a_mm_s2:g} mm/s2 as a slope: a step can"
        f" still stop at the error. Past a far surface by {past:.3g} mm in CONST_DIST, whose error"
        f" is {unseen:.3g} cycles old, by nothing in SET_POS; behind one that rises with v_max by"
        f" {behind:.3g} mm"
    )


def clamp_words(listed: Listed, period_us: int) -> str:
    """Say whether clamps may make a loop ring that is stable without them.

    They have no braking distance: within v_max <= a_max T/kp the law itself brakes in time
    (docs/distance-control.md). What 3D control may lower by its axes is not looked at.
    """
    kp, limits, period_s = listed.control.kp, listed.limits, period_us * US / S
    a_mm_s2 = limits.a_mm_s2
    if limits.adaptive is not None:
        a_mm_s2 = min(a_mm_s2, limits.adaptive[0])
    if kp <= 0.0 or a_mm_s2 <= 0.0:
        return "a control without kp or a_max does not move by them"
    allowed = a_mm_s2 * period_s / kp
    bound = f"a_max T/kp = {allowed:.4g} mm/s"
    if limits.v_mm_s <= allowed * (1.0 + AT_LIMIT):
        return f"v_max {limits.v_mm_s:g} mm/s is within {bound}: the law brakes in time"
    past = overshoot_mm(kp, period_us * US, limits.v_mm_s, a_mm_s2)
    remedies = (
        f"a_max >= {limits.v_mm_s * kp / period_s:g} mm/s2, v_max <= {allowed:g} mm/s or"
        f" kp <= {a_mm_s2 * period_s / limits.v_mm_s:.4g}"
    )
    return (
        f"v_max {limits.v_mm_s:g} mm/s is above {bound}: where the limits act they may make it ring"
        f" though it is stable without them. a_max {a_mm_s2:g} mm/s2 lets the offset change its"
        f" speed by {a_mm_s2 * period_s:.4g} mm/s in a cycle; after a large step it goes {past:.3g}"
        f" mm too far, more with dead cycles. Remedy: {remedies}"
    )


def control_lines(settings: Settings, name: str, sensor: Sensor) -> list[str]:
    """Show filter, controller and limits of an axis, or of CHANNEL, as listed."""
    listed = listed_for(settings, name)
    loop = loop_of(settings, name, sensor, CONST_DIST)
    control, smoothing = listed.control, loop.smoothing
    return [
        f"  filter       {smoothing.name}: {smoothing.delay_cycles:.3g} cycles late, noise times"
        f" {smoothing.noise_gain:.3g}",
        f"  listed       kp {control.kp:g}, Tn {control.tn_s:g} s, Tv {control.tv_s:g} s",
        f"  law          {law_words(control)}",
        f"  limits       {limits_words(listed, settings.rig.cycle.period_us, loop)}",
    ]


def law_words(control: Control) -> str:
    """Say what the rig has chosen of the law, [distance]."""
    worth = "Tv/T" if control.derivative == "per_second" else "Tv"
    return (
        f"derivative of the {control.derivative_of}, {worth} in a cycle; limiter {control.limiter}"
        " ([distance] of the rig: the manuals leave them open)"
    )


def cycles_line(settings: Settings, name: str, dead: DeadCycles) -> str:
    """Show two parameters that are about cycles and change nothing of the dead cycles."""
    axes = list(settings.axis.values()) if name == CHANNEL else [settings.axis[name]]
    delays = sorted({axis.integer(_DELAY) for axis in axes})
    has = int(all(axis.flag(OPTIMISED) for axis in axes))
    return (
        f"  cycles       P-AXIS-00191 = {', '.join(map(str, delays))}, P-AXIS-00276 = {has}: of the"
        " displayed lag and of the bus of a real control; neither changes n ="
        f" {dead.dead}, which the frames decide"
    )


def kp_lines(
    settings: Settings, name: str, sensor: Sensor, lag_s: float, *, has_loops: bool
) -> list[str]:
    """Show the limit of kp in each mode. has_loops: drives add lags that nobody counts."""
    kp, lines = listed_for(settings, name).control.kp, []
    for mode in MODES:
        limit = limit_of(loop_of(settings, name, sensor, mode, lag_s), sensor)
        bound = "unstable with any kp" if limit == 0 else f"stable below kp {limit:.4g}"
        verdict = "UNSTABLE as listed" if is_beyond(kp, limit) else "stable as listed"
        if has_loops and verdict[0] == "s" and (mode == CONST_DIST or sensor.age):
            verdict, bound = "not known as listed", f"at best below kp {limit:.4g}"
        lines.append(f"  {bound:<24} {mode}: {verdict}")
    return lines


def dead_line(settings: Settings, name: str, sensor: Sensor) -> str:
    """Show the dead cycles and the parameter that decides on them."""
    listed = listed_for(settings, name)
    goes = "the same" if listed.is_optimized else "the next"
    parameter = "P-CHAN-00818" if name == CHANNEL else "P-AXIS-00509"
    newer = -sensor.age
    age = f"{newer} cycles newer than 6064" if newer > 0 else f"{sensor.age} cycles old"
    return (
        f"  dead cycles  {dead_words(dead_cycles(listed, sensor), sensor)}: the offset is sent in"
        f" {goes} cycle ({parameter} = {int(listed.is_optimized)}) and is reached at the 2nd SYNC"
        f" after it; the sensor value is {age}"
        f"{f', and the carrier adds {sensor.late}' if sensor.late else ''}"
    )


def silence_line(sensor: Sensor, limit_ms: float | None) -> str:
    """Show when a silent sensor is noticed; limit_ms: of the rig, None for three periods."""
    if sensor.promised_ns is None:
        return "  silence      not noticed: nothing promises when the next value comes"
    limit_ms = PERIODS_MAX * sensor.promised_ns / MS if limit_ms is None else limit_ms
    return (
        f"  silence      a value every {sensor.promised_ns / MS:g} ms is promised; control freezes"
        f" when it is older than {limit_ms:g} ms (900314)"
    )
