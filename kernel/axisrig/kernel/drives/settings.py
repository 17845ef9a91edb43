"""What the control knows of a drive of any family."""

from dataclasses import dataclass

from axisrig.kernel.drives.position_loop import LoopSettings


@dataclass(frozen=True)
class DriveSettings:
    """The data of a drive that do not depend on its family.

    increments_per_mm: of set, actual and latched positions. probe_input: 1 or 2 (P-AXIS-00517).
    edge: POS or NEG (P-AXIS-00518). lag_delay_cycles: P-AXIS-00191. jump_mm: largest credible
    motion from one cycle to the next. acceleration_mm_s2: the largest that the axis can have.
    lag_limit_mm: of the CNC's position lag while a program runs. fault_reset: a fault that is
    active when the drive is switched on is acknowledged.
    sensor_age_limit_ms: of the sensor of distance control, None = three of its periods. loop: of an
    axis whose position loop the CNC closes, None where the drive does.
    """

    axis: str
    increments_per_mm: float
    probe_input: int = 1
    edge: str = "POS"
    lag_delay_cycles: int = 0
    jump_mm: float = float("inf")
    acceleration_mm_s2: float = float("inf")
    lag_limit_mm: float = float("inf")
    fault_reset: bool = False
    sensor_age_limit_ms: float | None = None
    loop: LoopSettings | None = None
