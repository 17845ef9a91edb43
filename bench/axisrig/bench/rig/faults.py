"""Where a fault of a kind can act in a rig, and what is refused."""

from collections.abc import Collection

from axisrig.bench.rig.families import family_on
from axisrig.bench.rig.reading.fault_targets import place_of, targets
from axisrig.bench.rig.reading.faults import FaultKind, fault_kinds, misses_heartbeats
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.settings import Settings

ON_SEGMENTS = ("frames", "drives", "lines", "idents", "images")
"""Rooms of `faults.csv` whose kinds need a carrier that has them."""


def open_targets(kind: FaultKind, settings: Settings) -> list[str]:
    """Return the targets of a kind in a rig, without those where a plan would be refused."""
    rig = settings.rig
    found = []
    for target in targets(kind.targets, rig):
        axis, segment, _ = place_of(target, kind.targets, rig)
        on = rig.axis[axis].segment if axis else segment
        if kind.room in ON_SEGMENTS and kind.room not in family_on(settings, on).fault_rooms:
            continue
        if not (axis and misses_heartbeats(kind.name, axis, rig)):
            found.append(target)
    return found


def check_faults(settings: Settings) -> None:
    """Refuse faults of drives and segments whose carrier has none.

    Raises UserError with file, line and key of the rig.
    """
    rooms = {name: family_on(settings, name).fault_rooms for name in settings.segment}
    for fault in settings.faults:
        room = fault_kinds()[fault.kind].room
        if room not in ON_SEGMENTS:
            continue
        with_faults = [name for name, of in rooms.items() if room in of]
        on = settings.rig.axis[fault.axis].segment if fault.axis else fault.segment
        if on not in with_faults:
            raise rig_error(
                settings.files,
                ("axis", fault.axis) if fault.axis else ("segment", fault.segment),
                f"fault {fault.kind}: there are no such faults of segments of the kind"
                f" {settings.segment[on].carrier}, nor of their drives",
                value=fault.target,
                allowed=with_faults or "none",
                hint=_kinds_on(on, rooms[on]),
            )


def _kinds_on(segment: str, rooms: Collection[str]) -> str | None:
    """Say which kinds there are on a segment, None where it has none."""
    kinds = [kind.name for kind in fault_kinds().values() if kind.room in rooms]
    return f"on {segment} there are {', '.join(kinds)}" if kinds else None
