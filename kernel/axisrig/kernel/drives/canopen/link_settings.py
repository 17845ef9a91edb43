"""The data of a drive that the kernel needs to link an axis with it."""

from dataclasses import dataclass

from axisrig.kernel.measuring.latest_edge import StampClock

# Cyclic telegrams may stay out this often before the drive counts as lost
MISSING_CYCLES = 3


@dataclass(frozen=True)
class LinkSettings:
    """The data of a drive that the kernel needs.

    increments_per_mm: scaling of 607A, 6064 and the latch objects. probe_input: 1 or 2
    (P-AXIS-00517). edge: POS or NEG (P-AXIS-00518). lag_delay_cycles: P-AXIS-00191. pdo_map:
    path of a mapping table, None for the kernel's own. missing_cycles: how often in a row a cyclic
    telegram may stay out. jump_mm: largest credible motion from one SYNC to the next.
    lag_limit_mm: of the CNC's position lag while a program runs. fault_reset: a fault that is
    active when the drive is switched on is acknowledged.
    trigger_source: P-AXIS-00702, CNC_DEFINED = the probe input, DRIVE_DEFINED = what 60D0 of the
    drive names. status_delay_cycles: SYNCs by which 60B9 may be old when it is sent. stamps: the
    clock of the drive, None where it is not known. has_counter, has_inputs, has_second: of the
    kernel's own mapping. sensor_age_limit_ms: of the sensor of distance control, None = three of
    its periods.
    """

    axis: str
    node_id: int
    increments_per_mm: float
    probe_input: int = 1
    edge: str = "POS"
    lag_delay_cycles: int = 0
    pdo_map: str | None = None
    missing_cycles: int = MISSING_CYCLES
    jump_mm: float = float("inf")
    lag_limit_mm: float = float("inf")
    fault_reset: bool = False
    trigger_source: str = "CNC_DEFINED"
    status_delay_cycles: int = 0
    stamps: StampClock | None = None
    has_counter: bool = False
    has_inputs: bool = True
    has_second: bool = False
    sensor_age_limit_ms: float | None = None
