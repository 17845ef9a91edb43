"""Checks of axes with an encoder terminal: nothing may be half a turn of the counter apart."""

from axisrig.bench.rig.describe import unproved_place
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.settings import Settings
from axisrig.bench.rig.speed_drive.checks import check_speed_drive, describe_speed_drive
from axisrig.bench.rig.speed_drive.members import drive_of, fastest_way_mm
from axisrig.kernel.profiles.encoder_terminal.words import COUNTS
from axisrig.kernel.time.clock import TimeNs

WHY_UNPROVED = "a counter of 16 bits is no absolute position; the control has kept the place"


def check_encoder_terminal(settings: Settings, name: str, way_ns: TimeNs) -> None:
    """Check one axis. way_ns: from a sample to what is made of it. Raises UserError."""
    check_speed_drive(settings, name, way_ns)
    table = drive_of(settings, name)
    cycles = table.missing_cycles + 1
    way_mm = fastest_way_mm(settings, name, cycles)
    half_mm = float(COUNTS / 2 / table.per_mm)
    if way_mm < half_mm:
        return
    raise rig_error(
        settings.files,
        ("drive", settings.rig.axis[name].drive, "lines"),
        f"axis {name}: at P-AXIS-00212 it goes {way_mm:.4g} mm in {cycles} cycles, and half of its"
        f" counter is {half_mm:.4g} mm: nobody knows how often it has wrapped",
        value=getattr(table, "lines", None),
        allowed=f"less than {half_mm:.4g} mm in missing_cycles + 1 cycles",
        hint="fewer lines, a lower P-AXIS-00212 or fewer missing_cycles",
    )


def describe_encoder_terminal(settings: Settings, name: str, way_ns: TimeNs) -> list[str]:
    """Describe the loop, and which place has no proof."""
    return [
        *describe_speed_drive(settings, name, way_ns),
        unproved_place(settings, name, WHY_UNPROVED),
    ]
