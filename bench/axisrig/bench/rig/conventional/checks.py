"""Checks of conventional drives: there is no bus."""

from axisrig.bench.rig.describe import unproved_place
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.settings import Settings
from axisrig.bench.rig.speed_drive.checks import check_speed_drive, describe_speed_drive
from axisrig.kernel.time.clock import TimeNs

WHY_UNPROVED = "a counter is no absolute position; the control has kept the place"


def check_conventional(settings: Settings, name: str, way_ns: TimeNs) -> None:
    """Check one axis. way_ns: from a sample to what is made of it. Raises UserError."""
    check_speed_drive(settings, name, way_ns)
    segment = settings.rig.axis[name].segment
    bus_us = getattr(settings.segment[segment], "bus_us", 0.0)
    if bus_us:
        raise rig_error(
            settings.files,
            ("segment", segment, "bus_us"),
            f"axis {name}: a conventional drive is at a card of the control, and has no bus",
            value=bus_us,
            allowed="0",
        )


def describe_conventional(settings: Settings, name: str, way_ns: TimeNs) -> list[str]:
    """Describe the loop, and which place has no proof."""
    return [
        *describe_speed_drive(settings, name, way_ns),
        unproved_place(settings, name, WHY_UNPROVED),
    ]
