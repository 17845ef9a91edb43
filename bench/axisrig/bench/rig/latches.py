"""Which measured values of a rig SDO proves, and which rest on telegrams alone."""

from collections.abc import Mapping
from enum import Enum

from axisrig.bench.bus.can.arithmetic import PlannedFrame
from axisrig.bench.rig.check import SDO_FRAMES, axis_telegrams, schedule_of
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.time.clock import S

MEASURES = "kenngr.messachse"
WHAT_PASSES = (
    "a latch that is altered alike in every telegram passes if it is at a place where the axis was"
)

MISSING_BY_SDO = 2
"""So many cycles in a row may request and answer keep telegrams away."""


class SdoRoom(Enum):
    """When a segment has room for SDO beside its cyclic telegrams."""

    CYCLE = "in every cycle"
    STANDSTILL = "while no axis of the segment moves"
    NONE = "never"


@once
def sdo_room(settings: Settings, name: str) -> SdoRoom:
    """Return when the segment of an axis has room for SDO.

    CYCLE: each cycle still fits with a transfer for each drive. STANDSTILL: it does not, but a
    cycle has the time for one frame more, which may make telegrams late; the kernel bears that
    while no axis of the segment moves (`StandstillRoom`).
    """
    segment = settings.rig.axis[name].segment
    counters = schedule_of(settings, segment, counters=True).fits
    if schedule_of(settings, segment, counters=counters, rare=SDO_FRAMES).fits:
        return SdoRoom.CYCLE
    schedule = schedule_of(settings, segment, counters=counters)
    frame_ns = -(-PlannedFrame(*SDO_FRAMES[0], 8).bits * S // schedule.bitrate)
    has_time = schedule.busy_ns + frame_ns <= schedule.cycle_ns
    patience = min(
        settings.rig.drive[axis.drive].missing_cycles
        for axis in settings.rig.axis.values()
        if axis.segment == segment
    )
    is_enough = has_time and patience >= MISSING_BY_SDO
    return SdoRoom.STANDSTILL if is_enough else SdoRoom.NONE


def _measuring_axes(settings: Settings) -> list[str]:
    """Axes that may measure and whose drive reports its latches."""
    return [
        name
        for name, parameters in settings.axis.items()
        if parameters.flag(MEASURES)
        and any(
            mapped.field == "latch"
            for telegram in axis_telegrams(settings, name).values()
            for mapped in telegram.objects
        )
    ]


def describe_latches(settings: Settings) -> list[str]:
    """Say of each measuring axis how its latches are proved, and warn where they are not."""
    lines = []
    for name in _measuring_axes(settings):
        axis = settings.rig.axis[name]
        room = sdo_room(settings, name)
        if not settings.rig.drive[axis.drive].latch_check:
            reason = f"latch_check of drive {axis.drive} is false"
        elif room is SdoRoom.NONE:
            reason = f"segment {axis.segment} has no room for SDO, not even at standstill"
        else:
            lines.append(f"axis {name}: SDO proves its latches; room for that {room.value}")
            continue
        lines.append(f"warning: axis {name}: its latches are unproved: {reason}; {WHAT_PASSES}")
    return lines


def unproved_axes(links: Mapping[str, AxisLink]) -> list[str]:
    """Return the axes that have measured without a proof; links: by axis."""
    return [name for name, link in links.items() if link.unproved_latches]


def unproved_notes(links: Mapping[str, AxisLink]) -> list[str]:
    """Say after a run which axes have measured without a proof; links: by axis."""
    return [
        f"axis {name}: unproved latches: {links[name].unproved_latches}; no SDO has confirmed"
        f" them, and {WHAT_PASSES}"
        for name in unproved_axes(links)
    ]
