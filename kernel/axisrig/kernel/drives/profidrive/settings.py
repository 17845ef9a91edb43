"""The data of a PROFIdrive drive that the kernel needs."""

from dataclasses import dataclass

from axisrig.kernel.drives.settings import DriveSettings
from axisrig.kernel.profiles.profidrive.words import Telegram


@dataclass(frozen=True, kw_only=True)
class ProfidriveSettings(DriveSettings):
    """The data of one drive.

    speed_counts: NSOLL_B for 1 mm/s, by P-AXIS-00379. period_s: of the cycle. gain: KPC in
    0.001 1/s by P-AXIS-00099, where the telegram has it. feed_forward: share of the set speed.
    proves_places: the position from
    which the drive is led counts only when G1_XIST2 gives it too. echo_cycles: from a telegram to
    the one that the drive has made after it. missing_cycles: telegrams in a row that may stay out.
    """

    telegram: Telegram
    speed_counts: float
    period_s: float
    gain: int = 0
    feed_forward: float = 0.0
    proves_places: bool = True
    echo_cycles: int = 2
    missing_cycles: int = 3
