"""The data of a drive that only takes a speed, as the kernel needs them."""

from dataclasses import dataclass

from axisrig.kernel.drives.settings import DriveSettings


@dataclass(frozen=True, kw_only=True)
class SpeedDriveSettings(DriveSettings):
    """The data of one drive.

    speed_counts: of the output for 1 mm/s, as P-AXIS-00129/P-AXIS-00128 has to have it. period_s:
    of the cycle. echo_cycles: from an image to the one that was made after it. missing_cycles:
    images in a row that may stay out.
    """

    speed_counts: float
    period_s: float
    echo_cycles: int = 2
    missing_cycles: int = 3
