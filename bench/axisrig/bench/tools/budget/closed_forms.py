"""The closed forms of shares, from the settings and from instants and motion of the truth."""

from math import copysign, exp

from axisrig.bench.record.signal_sources import STAMPED
from axisrig.bench.rig.ethercat.members import TERMINAL, segment_of, slaves_on
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.budget.causes import Active, probe_of
from axisrig.bench.tools.budget.observed_run import Seen
from axisrig.bench.tools.budget.starts import start_number
from axisrig.bench.tools.budget.surface import contact_um, normal_of, seat_um
from axisrig.kernel.time.clock import MS, S

BOUNCE_MS = 1.0
"""Default of bounce_time (WorkpieceProbe)."""
STIFFNESS_N_M, STRIBECK_M_S = 120e6, 5e-3
"""Defaults of screw_stiffness (ScrewAxis) and friction.stribeck (LuGreFriction)."""
SAMPLE = "sample_us"
"""Key of a drive: the time of a sample of its encoder."""
_NEAR_MS = 0.01
_BY_INSTANT = ("time", "drawn", "rest")
_BY_EDGE = ("length", "first", "drift", "seat", "contact", "edge")
"""What makes the edge later; a level that is sampled is found by the next cycle then."""
_CHANGING = ("fault:alter", "fault:second_sender")
"""Faults that change what a telegram says."""


def expected_um(
    active: Active, settings: Settings, axis: str, later: Seen, without: Seen
) -> float | None:
    """Return the closed form of a share, None without one.

    later, without: the runs with and without the cause, all later causes off. A time costs the
    way of the axis in it, v t + a t^2/2; what is drawn is known by the instants of the truth. A
    length has the sign of the motion. A PLC source gives the position of an instant that follows
    from the edge of the plant and the cycles of the rig.
    """
    form = active.cause.form
    is_by_instant = form in _BY_INSTANT and later.latch_ms is None
    is_sampled = form in _BY_EDGE and later.latch_ms is None and later.source != STAMPED
    if form in ("source", "handed", "pdo") or is_by_instant or is_sampled:
        return _way_um(active, later, without)
    if form in ("length", "half", "first", "drift", "seat", "contact"):
        return _length_um(active, settings, axis, later)
    found_um: float | None
    match form:
        case "motion":
            found_um = _difference_um(later.delayed_um, without.delayed_um)
        case "noise":
            # A program that goes on from where the axis is takes the noise with it: another phase
            moved_um = _difference_um(later.way_um, without.way_um) or 0.0
            found_um = later.noise * float(active.value) + moved_um
        case "edge":
            found_um = _edge_um(later, without)
        case "assumed" | "line":
            found_um = later.moved_um(0.0, line_shift_ms(active, settings, axis))
        case "sampling":
            found_um = _sampled_um(active, settings, axis, later, without.latch_ms or 0.0)
        case "twist" | "viscous":
            found_um = _twist_um(active, settings, axis, later.velocity_mm_s * 1e-3)
        case _:
            return _delay_um(active, settings, axis, later, without)
    return found_um


def _difference_um(later_um: float | None, without_um: float | None) -> float | None:
    return None if later_um is None or without_um is None else later_um - without_um


def _way_um(active: Active, later: Seen, without: Seen) -> float | None:
    """Return the difference of the ways to the instants of the value."""
    if active.cause.form == "pdo":
        if any(kind in active.setting for kind in _CHANGING):
            return None
        if later.latch_ms is not None:  # the drive has stored it: no telegram changes it
            return 0.0
    return _difference_um(later.way_um, without.way_um)


def line_shift_ms(active: Active, settings: Settings, axis: str) -> float:
    """Return by how much later than its stamp the position is that a value has.

    A clock whose delay was not written is behind by the way from the first slave to the last one. A
    position is that of the last sample before its frame, whenever the control takes that to be.
    """
    segment = settings.rig.axis[axis].segment
    table, names = segment_of(settings, segment), slaves_on(settings, segment)
    if active.cause.form == "line":
        way_ns = sum(table.of("wire_ns", name) for name in names[1:])
        return -(way_ns + sum(table.of("slave_ns", name) for name in names[:-1])) / MS
    period_us = settings.rig.cycle.period_us
    assumed_us, sampled_us = (
        (table.frame_us - table.shift_us - at_us) % period_us or period_us
        for at_us in (table.of(active.cause.key, axis), table.of(active.cause.off, axis))
    )
    return (assumed_us - sampled_us) * 1e-3


def _edge_um(later: Seen, without: Seen) -> float | None:
    if later.track is None or without.track is None:
        return None
    return later.moved_um(0, later.track.edge_ms) - without.moved_um(0, without.track.edge_ms)


def _twist_um(active: Active, settings: Settings, axis: str, v_m_s: float) -> float:
    """Return how far the encoder is before the slide in steady motion: friction over stiffness.

    Dry friction as LuGre has it: F_c + (F_s - F_c) exp(-(v/v_s)^2).
    """
    plant = settings.rig.axis[axis].plant
    stiffness_n_m = start_number(settings, plant, "screw_stiffness", STIFFNESS_N_M)
    if active.cause.form == "viscous":
        force_n = abs(v_m_s) * float(active.value)
    else:
        names, defaults = active.cause.key.split(), map(float, active.cause.default.split())
        coulomb_n, breakaway_n = (
            start_number(settings, plant, name, default)
            for name, default in zip(names, defaults, strict=True)
        )
        stribeck_m_s = start_number(settings, plant, "friction.stribeck", STRIBECK_M_S)
        force_n = coulomb_n + (breakaway_n - coulomb_n) * exp(-((v_m_s / stribeck_m_s) ** 2))
    return copysign(force_n / stiffness_n_m * 1e6, v_m_s)


def _length_um(active: Active, settings: Settings, axis: str, later: Seen) -> float | None:
    """Return what a length along the normal of the surface makes the axis move."""
    form, probe = active.cause.form, probe_of(settings, axis)
    sign = copysign(1.0, later.velocity_mm_s)
    if form == "half":  # the encoder comes half of the play before the load
        return sign * float(active.value) / 2
    per_length = sign if later.per_length is None else later.per_length
    if form in ("seat", "contact"):
        normal = normal_of(settings, probe)
        if normal is None:
            return None
        yields_um = {"seat": seat_um, "contact": contact_um}[form]
        return per_length * yields_um(settings, probe, normal)
    length_um = per_length * float(active.value)
    if form == "length":
        return length_um
    if later.track is None:
        return None
    before = later.track.touches - 1
    return length_um * (before if form == "drift" else not before)


def _delay_um(
    active: Active, settings: Settings, axis: str, later: Seen, without: Seen
) -> float | None:
    begin_ms = without.latch_ms or 0.0
    match active.cause.form:
        case "time":
            return later.moved_um(begin_ms, begin_ms + float(active.value) * 1e-3)
        case "minus_time":
            return -later.moved_um(begin_ms - float(active.value) * 1e-3, begin_ms)
        case "led_back":  # the kernel takes the speed at the latch for all of the time
            speed_um_ms = later.moved_um(begin_ms - _NEAR_MS, begin_ms + _NEAR_MS) / (2 * _NEAR_MS)
            return -speed_um_ms * float(active.value) * 1e-3
        case "rest":
            rest_ms = _rest_ms(settings, axis, float(active.value) * 1e-3)
            return later.moved_um(begin_ms, begin_ms + rest_ms)
        case "drawn":
            end_ms = later.latch_ms
            return None if end_ms is None else later.moved_um(begin_ms, end_ms)
    return None


def _sampled_um(
    active: Active, settings: Settings, axis: str, later: Seen, at_ms: float
) -> float | None:
    """Return what a sample, or the line between two of them, differs from the position itself.

    Samples are at whole multiples of the time of a sample; what is latched at one is that one.
    """
    if later.track is None:
        return None
    drive = settings.rig.drive[settings.rig.axis[axis].drive]
    grid_ms = float(getattr(drive, SAMPLE)) * 1e-3
    since_ms = (later.track.contact_ns + round(at_ms * MS)) % round(grid_ms * MS) / MS
    begin_ms = at_ms - since_ms
    if active.value == "linear":
        return later.moved_um(at_ms, begin_ms) + later.moved_um(begin_ms, begin_ms + grid_ms) * (
            since_ms / grid_ms
        )
    return later.moved_um(at_ms, begin_ms)


def _rest_ms(settings: Settings, axis: str, filter_ms: float) -> float:
    """Return when a level has lasted for the filter, after the first edge of a bouncing signal.

    After the edge it changes 2 n times within the time T of the bounce, every T/(2 n)
    (ContactBounce); it lasts long enough at once, or only after the last change.
    """
    probe = probe_of(settings, axis)
    count = start_number(settings, probe, "bounce_count", 0.0)
    bounce_ms = start_number(settings, probe, "bounce_time", BOUNCE_MS * 1e-3) * 1e3
    is_short = count > 0 and bounce_ms / (2 * count) < filter_ms
    return filter_ms + (bounce_ms if is_short else 0.0)


def bound_um(
    active: Active, settings: Settings, axis: str, whole: Seen, increment_um: float
) -> float | None:
    """Return how large a share may be where only that is known."""
    v_um_s = abs(whole.velocity_mm_s) * 1e3
    match active.cause.form:
        case "rounding":
            return increment_um
        case "jitter":
            return v_um_s * float(active.value) * 1e-9
        case "drifted" if whole.track is not None:  # since the start-up has written the offset
            table = segment_of(settings, settings.rig.axis[axis].segment)
            drift_ppm = abs(table.of("drift_ppm", TERMINAL))
            return v_um_s * drift_ppm * 1e-6 * whole.track.contact_ns / S
    return None
