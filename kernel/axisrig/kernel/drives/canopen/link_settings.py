"""The data of a drive that the kernel needs to link an axis with it over CANopen."""

from dataclasses import dataclass

from axisrig.kernel.drives.settings import DriveSettings
from axisrig.kernel.measuring.latest_edge import StampClock

# Cyclic telegrams may stay out this often before the drive counts as lost
MISSING_CYCLES = 3


@dataclass(frozen=True, kw_only=True)
class LinkSettings(DriveSettings):
    """The data of a drive that the kernel needs.

    increments_per_mm: scaling of 607A, 6064 and the latch objects. pdo_map: path of a mapping
    table, None for the kernel's own. missing_cycles: how often in a row a cyclic telegram may stay
    out.
    trigger_source: P-AXIS-00702, CNC_DEFINED = the probe input, DRIVE_DEFINED = what 60D0 of the
    drive names. status_delay_cycles: SYNCs by which 60B9 may be old when it is sent. stamps: the
    clock of the drive, None where it is not known. has_counter, has_inputs, has_second: of the
    kernel's own mapping.
    """

    node_id: int
    pdo_map: str | None = None
    missing_cycles: int = MISSING_CYCLES
    trigger_source: str = "CNC_DEFINED"
    status_delay_cycles: int = 0
    stamps: StampClock | None = None
    has_counter: bool = False
    has_inputs: bool = True
    has_second: bool = False
