"""Where the position loop of a PROFIdrive axis is closed, and whether it is stable.

In the drive where the telegram has XERR and KPC (DSC), in the CNC else, or where P-AXIS-00320 says
so: KPC is 0 then. Source: TF5200 commissioning 436095115, diagnosis 260807563.
"""

from axisrig.bench.oracles.position_loop import gain_limit
from axisrig.bench.rig.loop import check_gain, feed_forward, kv_per_s
from axisrig.bench.rig.profidrive.members import drive_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.position_loop import LoopSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.parameters.drive_types import CNC_MODE, DRIVE_MODE, DSC_MODE
from axisrig.kernel.parameters.of_drive_type import OPERATION_MODE
from axisrig.kernel.profiles.profidrive.words import KPC_PER_S
from axisrig.kernel.time.clock import US, S, TimeNs


def uses_dsc(settings: Settings, name: str) -> bool:
    """Whether the drive closes the position loop."""
    is_cnc = settings.axis[name].word(OPERATION_MODE) == CNC_MODE
    return drive_of(settings, name).make().telegram.has_dsc and not is_cnc


def wrong_mode(settings: Settings, name: str) -> Alarm | None:
    """Return Alarm 70344 or 70346 for a P-AXIS-00320 that the telegram cannot serve."""
    parameters, table = settings.axis[name], drive_of(settings, name)
    mode = parameters.word(OPERATION_MODE)
    if mode == DRIVE_MODE:
        return Alarm(70346, axis=name, drive_type="PROFIDRIVE MC", mode=mode)
    if mode == DSC_MODE and not table.make().telegram.has_dsc:
        return Alarm(70344, axis=name, drive_type="PROFIDRIVE MC", mode=mode)
    return None


def loop_settings(settings: Settings, name: str) -> LoopSettings | None:
    """Return the loop of an axis in the CNC, None where its drive closes it."""
    if uses_dsc(settings, name):
        return None
    return LoopSettings(
        kv_per_s=kv_per_s(settings, name),
        period_s=settings.rig.cycle.period_us * US / S,
        feed_forward=feed_forward(settings, name),
    )


def gain_of(settings: Settings, name: str) -> int:
    """Return KPC: the gain P-AXIS-00099 in 0.001 1/s; 0 = the drive closes no loop."""
    return round(kv_per_s(settings, name) * KPC_PER_S) if uses_dsc(settings, name) else 0


def period_and_dead(settings: Settings, name: str, way_ns: TimeNs) -> tuple[float, float]:
    """Return T in s and the dead cycles of the loop.

    way_ns: from the sample of a position to the set speed that is made of it, of a loop in the CNC.
    That of the drive acts in its ticks, and has no way.
    """
    table = drive_of(settings, name)
    speed_loop_ns = round(table.speed_loop_us * US)
    if uses_dsc(settings, name):
        tick_ns = table.make().drive.tick_ns
        return tick_ns / S, speed_loop_ns / tick_ns
    period_ns = settings.rig.cycle.period_us * US
    return period_ns / S, (way_ns + speed_loop_ns) / period_ns


def limit_of(settings: Settings, name: str, way_ns: TimeNs) -> float:
    """Return the largest stable Kv T."""
    return gain_limit(period_and_dead(settings, name, way_ns)[1], is_held=True)


def check_loop(settings: Settings, name: str, way_ns: TimeNs) -> None:
    """Refuse a gain at which the loop is unstable. Raises UserError."""
    period_s, dead = period_and_dead(settings, name, way_ns)
    check_gain(
        settings,
        name,
        limit_of(settings, name, way_ns),
        dead,
        period_s,
        "drive (DSC)" if uses_dsc(settings, name) else "CNC",
        "lower it; a shorter tick_us or a faster speed loop (speed_loop_us) of the drive, or a"
        " shorter period_us where the CNC closes the loop, allow more",
    )
