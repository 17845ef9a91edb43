"""Checks of axes whose drives only take a speed: scale of the output, gain of the loop."""

from axisrig.bench.oracles.position_loop import gain_limit, ramp_lag_mm
from axisrig.bench.rig.loop import check_gain, feed_forward, kv_per_s
from axisrig.bench.rig.settings import Settings
from axisrig.bench.rig.speed_drive.members import NUMERATOR, drive_of, listed_counts
from axisrig.kernel.parameters import Origin
from axisrig.kernel.profiles.speed_drive.words import OUTPUT_MAX
from axisrig.kernel.time.clock import US, S, TimeNs

SHOWN_MM_S = 10.0


def check_speed_drive(settings: Settings, name: str, way_ns: TimeNs) -> None:
    """Check one axis. way_ns: from a sample to what is made of it. Raises UserError."""
    _check_scale(settings, name)
    period_s, dead = _period_and_dead(settings, name, way_ns)
    check_gain(
        settings,
        name,
        gain_limit(dead, is_held=True),
        dead,
        period_s,
        "CNC",
        "lower it; a shorter period_us, instants closer to each other or a faster speed loop of"
        " the drive (speed_loop_us) allow more",
    )


def _check_scale(settings: Settings, name: str) -> None:
    """Refuse a speed of the list that is not that of the drive: a factor in the gain."""
    listed, full_mm_s = listed_counts(settings, name), float(drive_of(settings, name).full_mm_s)
    if abs(listed * full_mm_s - OUTPUT_MAX) < 1.0:
        return
    parameters = settings.axis[name]
    raise (parameters.origin(NUMERATOR) or Origin(NUMERATOR)).error(
        f"axis {name}: its drive has {full_mm_s:g} mm/s at the full output by the rig: speeds wrong"
        f" by a factor of {listed * full_mm_s / OUTPUT_MAX:.6g} (P-AXIS-00129, P-AXIS-00128)",
        value=f"{listed * full_mm_s:.6g} counts",
        allowed=f"{OUTPUT_MAX} counts, to less than one",
    )


def _period_and_dead(settings: Settings, name: str, way_ns: TimeNs) -> tuple[float, float]:
    """Return T in s and the dead cycles of the loop."""
    speed_loop_ns = round(drive_of(settings, name).speed_loop_us * US)
    period_ns = settings.rig.cycle.period_us * US
    return period_ns / S, (way_ns + speed_loop_ns) / period_ns


def describe_speed_drive(settings: Settings, name: str, way_ns: TimeNs) -> list[str]:
    """Say what the loop is, and how fine its output."""
    table = drive_of(settings, name)
    gain, forward = kv_per_s(settings, name), feed_forward(settings, name)
    period_s, dead = _period_and_dead(settings, name, way_ns)
    full_mm_s = float(table.full_mm_s)
    bits, offset = table.output
    step_mm_s = full_mm_s * (1 << 16 - bits) / OUTPUT_MAX
    offset_mm_s = full_mm_s * offset / OUTPUT_MAX
    return [
        f"axis {name}: the CNC closes the position loop: Kv {gain:g} 1/s, feed-forward"
        f" {forward:.6g}, lag {ramp_lag_mm(SHOWN_MM_S, gain, forward):.4g} mm at {SHOWN_MM_S:g}"
        f" mm/s; stable below {gain_limit(dead, is_held=True) / period_s:.4g} 1/s with {dead:.4g}"
        " dead cycles",
        f"axis {name}: output of {bits} bits, {full_mm_s:g} mm/s at the full one: steps of"
        f" {step_mm_s * 1e3:.4g} um/s are {step_mm_s / gain * 1e3:.4g} um of lag, its offset"
        f" {offset_mm_s * 1e3:.4g} um/s {offset_mm_s / gain * 1e3:.4g} um",
    ]
