"""Which measured values and start positions SDO proves, and which rest on telegrams alone."""

from enum import Enum

from axisrig.bench.bus.can.arithmetic import PlannedFrame
from axisrig.bench.rig.canopen.members import can_axes, drive_of
from axisrig.bench.rig.canopen.schedule import (
    SDO_FRAMES,
    axis_telegrams,
    has_touch_probe,
    schedule_of,
)
from axisrig.bench.rig.describe import WHAT_PASSES, unproved_place
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.parameters.signal_sources import SOURCES
from axisrig.kernel.time.clock import S

MEASURES = "kenngr.messachse"
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
        drive_of(settings, other).missing_cycles
        for other, axis in settings.rig.axis.items()
        if axis.segment == segment
    )
    is_enough = has_time and patience >= MISSING_BY_SDO
    return SdoRoom.STANDSTILL if is_enough else SdoRoom.NONE


def _measuring_axes(settings: Settings) -> list[str]:
    """Axes that may measure and whose drive reports its latches."""
    return [
        name
        for name in can_axes(settings)
        if settings.axis[name].flag(MEASURES)
        and any(
            mapped.field == "latch"
            for telegram in axis_telegrams(settings, name).values()
            for mapped in telegram.objects
        )
    ]


def describe_places(settings: Settings) -> list[str]:
    """Warn of each axis whose start position rests on telegrams alone."""
    lines = []
    for name in can_axes(settings):
        if not drive_of(settings, name).position_check:
            lines.append(unproved_place(settings, name))
        elif sdo_room(settings, name) is SdoRoom.NONE:
            segment = settings.rig.axis[name].segment
            reason = f"segment {segment} has no room for SDO, not even at standstill"
            lines.append(unproved_place(settings, name, reason))
    return lines


def missing_touch_probe(settings: Settings, name: str) -> list[str]:
    """Warn of an axis that measures with the latch of a drive of CiA 402 that has none."""
    parameters = settings.axis[name]
    signal = parameters.word("kenngr.measure.signal")
    measures = parameters.flag(MEASURES) and SOURCES[signal].latched == "drive"
    if not measures or has_touch_probe(settings, name):
        return []
    return [
        f"warning: axis {name}: drive {settings.rig.axis[name].drive} has no touch probe (60B8),"
        f" and the axis measures with the latch of its drive (P-AXIS-00516 = {signal}): a measuring"
        " block ends with 900002; name another source, or a drive that has one"
    ]


def describe_latches(settings: Settings) -> list[str]:
    """Say of each measuring axis how its latches are proved, and warn where they are not."""
    lines = [line for name in can_axes(settings) for line in missing_touch_probe(settings, name)]
    for name in _measuring_axes(settings):
        axis = settings.rig.axis[name]
        room = sdo_room(settings, name)
        if not drive_of(settings, name).latch_check:
            reason = f"latch_check of drive {axis.drive} is false"
        elif room is SdoRoom.NONE:
            reason = f"segment {axis.segment} has no room for SDO, not even at standstill"
        else:
            lines.append(f"axis {name}: SDO proves its latches; room for that {room.value}")
            continue
        lines.append(f"warning: axis {name}: its latches are unproved: {reason}; {WHAT_PASSES}")
    return lines
