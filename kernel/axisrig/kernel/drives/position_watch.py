"""What positions alone say is wrong with a drive, whatever its words are: jumps and the lag."""

from math import inf

from axisrig.kernel.drives.frozen_encoder import STANDS_S
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.drives.power import Power
from axisrig.kernel.errors import Alarm


def jump_alarm(drive: Drive) -> Alarm | None:
    """Return Alarm 900029 for a jump in operation, None without one; the jump is forgotten.

    Before operation a drive may still be looking for its encoder.
    """
    jump_mm, drive.jump_mm = drive.jump_mm, None
    if jump_mm is None or drive.power is not Power.OPERATING:
        return None
    return Alarm(900029, axis=drive.name, jump_mm=f"{jump_mm:.3f}")


def lag_alarm(drive: Drive) -> Alarm | None:
    """Return Alarm 900037 for an encoder that counts nothing at a set speed, 900036 for a lag
    beyond that of the rig, None where neither is.
    """
    frozen, limit_mm = drive.frozen, drive.settings.lag_limit_mm
    if frozen is not None and frozen.is_frozen:
        speed = f"{frozen.speed_mm_s:.4g}"
        return Alarm(900037, axis=drive.name, speed_mm_s=speed, time_ms=f"{1e3 * STANDS_S:g}")
    if limit_mm == inf or not drive.watches_lag or abs(drive.lag_mm) <= limit_mm:
        return None
    return Alarm(900036, axis=drive.name, lag_mm=f"{drive.lag_mm:.4f}", limit_mm=f"{limit_mm:g}")
