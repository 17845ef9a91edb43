"""Checks of drives on Lightbus: a latch within a turn, function of input 2."""

from typing import Any

from axisrig.bench.rig.describe import unproved_place
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.settings import Settings
from axisrig.bench.rig.speed_drive.checks import check_speed_drive, describe_speed_drive
from axisrig.bench.rig.speed_drive.members import drive_of, fastest_way_mm, measures
from axisrig.kernel.profiles.lightbus.words import IN2MODE_LATCH
from axisrig.kernel.time.clock import TimeNs

WHY_UNPROVED = "nothing beside its image gives the absolute position"


def check_lightbus(settings: Settings, name: str, way_ns: TimeNs) -> None:
    """Check one axis. way_ns: from a sample to what is made of it. Raises UserError."""
    check_speed_drive(settings, name, way_ns)
    table: Any = drive_of(settings, name)
    if not table.is_in_turn:
        return
    cycles = table.missing_cycles + 1
    way_mm, half_mm = fastest_way_mm(settings, name, cycles), float(table.lead_mm) / 2
    if way_mm < half_mm:
        return
    raise rig_error(
        settings.files,
        ("drive", settings.rig.axis[name].drive, "latch_variable"),
        f"axis {name}: at P-AXIS-00212 it goes {way_mm:.4g} mm in {cycles} cycles, half a turn is"
        f" {half_mm:.4g} mm: nobody knows in which turn LATCH16 was",
        value=table.latch_variable,
        allowed="LATCH32",
        hint="a lower P-AXIS-00212, fewer missing_cycles or a shorter period_us allow LATCH16 too",
    )


def describe_lightbus(settings: Settings, name: str, way_ns: TimeNs) -> list[str]:
    """Describe the loop, which place has no proof, and what input 2 does."""
    table: Any = drive_of(settings, name)
    lines = [
        *describe_speed_drive(settings, name, way_ns),
        unproved_place(settings, name, WHY_UNPROVED),
    ]
    if measures(settings, name) and table.in2mode != IN2MODE_LATCH:
        lines.append(
            f"warning: axis {name}: in2mode of its drive is {table.in2mode} and not"
            f" {IN2MODE_LATCH}: its input 2 latches nothing"
        )
    return lines
