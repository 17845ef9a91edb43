"""A run to a fixed stop in words: why it was found here, whether that is true, what it pressed."""

from collections.abc import Callable, Sequence

import pyarrow as pa

from axisrig.bench.judge.fixed_stop.stop_findings import BrokenContact, Mark, StopLimits
from axisrig.reports.fixed_stop.signals import (
    Contact,
    Shortfall,
    Stop,
    contact,
    contact_ns,
    largest,
    mark,
    shortfall,
    value_at,
)

LEGEND = (
    "Plots of a run to a fixed stop count from its contact; their shaded stretches are where the"
    " closed form expects an instant."
)
"""How to read its plots."""

_NS_PER_MS = 1e6
_SHORT_MM = 0.1


def state(stop: Stop, trouble: Sequence[Mark]) -> str:
    """Return `found`, `false` (a trigger without a contact), `missed` or `ended` (by trouble).

    trouble: alarms and faults in the run, as marks.
    """
    if stop.is_found:
        return "false" if tells_contact(stop) and not _touches(stop) else "found"
    return "ended" if trouble else "missed"


def _touches(stop: Stop) -> bool:
    """Whether an axis is in contact when the stop is detected."""
    touched = contact(stop)
    if touched is None:
        return False
    broken = _broken(stop, touched)
    return broken is None or broken.since_ns is not None


def _broken(stop: Stop, touched: Contact) -> BrokenContact | None:
    """What is known of a contact that was lost before the detection; None when it was not."""
    return stop.broken_contacts.get(touched.axis)


def tells_contact(stop: Stop) -> bool:
    """Whether a plant gives a contact when there is one."""
    is_measured = any(row.key == "contact" and row.measured_ns for row in stop.marks)
    return is_measured or any("stop_force_n" in names for names in stop.signals.values())


def answers(stop: Stop, trouble: Sequence[Mark], trace: pa.Table | None) -> list[tuple[str, str]]:
    """Return what a reader asks first, each with its answer.

    trace: with the columns of `with_changes`.
    """
    ended = "; ".join(row.label + (f": {row.note}" if row.note else "") for row in trouble)
    answers = [("ended by", ended)]
    answers += [("why here", _why(stop))] if stop.is_found else _missing(stop, trace)
    if stop.is_found or contact_ns(stop) is not None:
        answers.append(("real stop", _real(stop)))
    answers.append(("pressed with", _pressed(stop, trace)))
    if mark(stop, "relax_end") is not None:
        answers.append(("left after relaxing", _left(stop, trace)))
    return [(question, answer) for question, answer in answers if answer]


def _why(stop: Stop) -> str:
    """The criteria that found the stop, and which of two came last."""
    decided = stop.decided_by
    if decided is None:
        return ""
    axis, limits = decided.axis, stop.limits.get(decided.axis)
    if limits is None:
        return f"{axis}: {decided.criterion}"
    tau = f"{limits.min_time_ms:g} ms"
    lag, window, way = limits.lag_limit_mm, limits.window_mm, _way_of(stop, axis)
    criteria = []
    if lag is not None:
        criteria.append(f"lag above {way(lag)} for {tau}")
    if window is not None:
        criteria.append(f"moved no more than {way(window)} in {tau}")
    text = f"{axis}: " + " and ".join(criteria)
    beyond, still = mark(stop, "beyond", axis), mark(stop, "window", axis)
    if len(criteria) == 2 and beyond is not None and still is not None:
        ripe = beyond + round(limits.min_time_ms * _NS_PER_MS)
        text += f"; the {'lag' if ripe > still else 'window'} came last"
    return text


def _missing(stop: Stop, trace: pa.Table | None) -> list[tuple[str, str]]:
    """How far each watched axis came towards its criteria."""
    if mark(stop, "armed") is None:
        arming = (limits.arming_mm for limits in stop.limits.values())
        ways = {each for each in arming if each is not None}
        way = _way_of(stop, stop.main_axis)
        words = " or ".join(way(each) for each in sorted(ways)) or "their part"
        return [("what was missing", f"the criteria are armed after {words} of the path only")]
    texts = [
        f"{axis}: "
        + _short_of(stop.limits[axis], shortfall(trace, stop, axis), _way_of(stop, axis))
        for axis in stop.watched
        if axis in stop.limits
    ]
    return [("what was missing", "; ".join(texts))]


def _short_of(limits: StopLimits, seen: Shortfall, way: Callable[[float], str]) -> str:
    """How far one axis came; both criteria off is said as such. way: writes one of the axis."""
    lag, window, tau = limits.lag_limit_mm, limits.window_mm, limits.min_time_ms
    reasons = []
    if lag is not None:
        text = f"lag limit {way(lag)}"
        if seen.largest_lag_mm is not None:
            text = f"largest lag {way(seen.largest_lag_mm)} of {way(lag)}"
        if seen.beyond_ms:
            text += f", above it for {seen.beyond_ms:g} of {tau:g} ms"
        reasons.append(text)
    if window is not None:
        text = f"window {way(window)}"
        if seen.change_um is not None:
            moved = way(seen.change_um / 1000.0)
            text = f"moved {moved} or more in {tau:g} ms, window {way(window)}"
        reasons.append(text)
    return ", ".join(reasons) or "both criteria are off"


def _real(stop: Stop) -> str:
    """Whether a stop was there, by the truth of the plant."""
    detected, touched = mark(stop, "detected"), contact(stop)
    if touched is not None:
        who = "" if touched.axis == stop.decided_axis else f"{touched.axis} "
        if detected is None:
            return f"yes: {who}was in contact"
        return _lasted(detected, touched, who, _broken(stop, touched))
    if not tells_contact(stop):
        return "not known: no plant gives a contact"
    later = mark(stop, "contact")
    if later is None or detected is None:
        return "no: nothing was touched"
    return f"no: contact came {(later - detected) / _NS_PER_MS:.1f} ms after the detection"


def _lasted(detected: int, touched: Contact, who: str, broken: BrokenContact | None) -> str:
    """How long the contact had lasted; one that was lost counts from its return."""
    since_ms = _ms(detected - touched.time_ns)
    if broken is None:
        return f"yes: {who}in contact for {since_ms:.1f} ms when detected"
    lost = f"first contact {since_ms:.1f} ms before, lost for {_ms(broken.lost_ns):.0f} ms"
    if broken.since_ns is None:
        return f"no: {touched.axis} had lost its contact when detected; {lost}"
    since_ms = _ms(detected - broken.since_ns)
    return f"yes: {who}in contact for {since_ms:.1f} ms when detected; {lost}"


def _pressed(stop: Stop, trace: pa.Table | None) -> str:
    """Largest and last force of each axis at its stop; where the bench gives none, of the trace."""
    texts = []
    for axis in stop.watched:
        name = stop.column(axis, "stop_force_n")
        most = _value(stop, "stop_force_max", axis)
        last = _value(stop, "stop_force_end", axis)
        most = largest(trace, name, stop) if most is None else most
        last = value_at(trace, name, stop.end_ns) if last is None else last
        if most == 0.0:
            texts.append(f"{axis}: nothing")
        elif most is not None or last is not None:
            parts = [
                *([f"at most {most:.4g} {_unit(stop, axis)}"] if most is not None else []),
                *([f"{last:.4g} {_unit(stop, axis)} at the end"] if last is not None else []),
            ]
            texts.append((f"{axis}: " if len(stop.watched) > 1 else "") + ", ".join(parts))
    if texts and all(text.endswith("nothing") for text in texts):
        return "nothing: no force at the stop"
    return "; ".join(texts) or "not known: no plant gives the force"


def _left(stop: Stop, trace: pa.Table | None) -> str:
    """Lag and force of the main axis when its relaxing motion is over."""
    axis = stop.main_axis
    end = mark(stop, "end") or stop.end_ns
    lag, force = (
        value_at(trace, stop.column(axis, name), end) for name in ("cnc_lag_mm", "stop_force_n")
    )
    parts = []
    if lag is not None:
        parts.append(f"lag {_way_of(stop, axis)(lag)}")
    if force is not None:
        parts.append(f"{force:.4g} {_unit(stop, axis)}")
    return ", ".join(parts)


def _ms(time_ns: int) -> float:
    return time_ns / _NS_PER_MS


def _value(stop: Stop, key: str, axis: str) -> float | None:
    for row in stop.values:
        if row.key == key and row.axis == axis and row.measured is not None:
            return float(row.measured)
    return None


def _unit(stop: Stop, axis: str | None) -> str:
    """Of what an axis presses with."""
    return "N.m" if stop.rotary.get(axis or "") else "N"


def _way_of(stop: Stop, axis: str | None) -> Callable[[float], str]:
    """Return what writes a way of an axis."""
    return angle if axis in stop.rotary else length


def angle(value_deg: float) -> str:
    """Write the amount of an angle."""
    return f"{abs(value_deg):.4g}°"


def length(value_mm: float) -> str:
    """Write the amount of a length in the unit that needs no long row of zeros."""
    if abs(value_mm) < _SHORT_MM:
        text = f"{1000.0 * abs(value_mm):.3f}".rstrip("0").rstrip(".")
        return f"{text} µm"
    return f"{abs(value_mm):.4g} mm"
