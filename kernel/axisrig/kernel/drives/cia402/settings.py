"""The data of a drive that the kernel needs to lead it by words of CiA 402."""

from dataclasses import dataclass

from axisrig.kernel.drives.settings import DriveSettings
from axisrig.kernel.measuring.latest_edge import StampClock
from axisrig.kernel.time.clock import S, TimeNs

# Cyclic telegrams may stay out this often before the drive counts as lost
MISSING_CYCLES = 3
HOMING_LIMIT_NS: TimeNs = 300 * S


@dataclass(frozen=True, kw_only=True)
class Cia402Settings(DriveSettings):
    """The data of a drive that the kernel needs, whatever carries its words.

    increments_per_mm: scaling of 607A, 6064 and the latch objects. node_id: its address on its
    segment. missing_cycles: how often in a row its cyclic values may stay out.
    trigger_source: P-AXIS-00702, CNC_DEFINED = the probe input, DRIVE_DEFINED = what 60D0 of the
    drive names. status_delay_cycles: cycles by which 60B9 may be old when it is sent. stamps: the
    clock of the drive, None where it is not known. homing_limit_ns: a homing that takes longer has
    failed.
    """

    node_id: int
    missing_cycles: int = MISSING_CYCLES
    trigger_source: str = "CNC_DEFINED"
    status_delay_cycles: int = 0
    stamps: StampClock | None = None
    homing_limit_ns: TimeNs = HOMING_LIMIT_NS
