"""Where the position loop of an axis of CiA 402 is closed, and whether the CNC's is stable.

The telegram decides it: one that carries a set speed (60FF) and no set position (607A) leaves the
loop to the CNC (TF5200 commissioning 436095115). P-AXIS-00320 must not say otherwise.
"""

from collections.abc import Iterable
from typing import Final

from axisrig.bench.oracles.position_loop import dead_cycles, gain_limit, ramp_lag_mm
from axisrig.bench.rig.canopen.members import drive_of
from axisrig.bench.rig.loop import OF_LOOP, check_gain, feed_forward, kv_per_s
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.canopen.mapping import Telegram
from axisrig.kernel.drives.canopen.startup_steps import CSP, CSV
from axisrig.kernel.drives.position_loop import LoopSettings
from axisrig.kernel.parameters import Origin
from axisrig.kernel.parameters.drive_types import CNC_MODE, DRIVE_MODE
from axisrig.kernel.parameters.of_drive_type import OPERATION_MODE
from axisrig.kernel.time.clock import US, S

SHOWN_MM_S: Final = 10.0
RELEASED_3D: Final = "configuration.decoder.function", "FCT_3D_DIST_CTRL"


def closes_loop(settings: Settings, name: str) -> bool:
    """Whether the kernel's own telegrams of an axis leave its position loop to the CNC."""
    return bool(drive_of(settings, name).mode == CSV)


def loop_settings(settings: Settings, name: str) -> LoopSettings | None:
    """Return the loop of an axis in the CNC, None where its drive closes it."""
    if not closes_loop(settings, name):
        return None
    return LoopSettings(
        kv_per_s=kv_per_s(settings, name),
        period_s=settings.rig.cycle.period_us * US / S,
        feed_forward=feed_forward(settings, name),
    )


def check_loop(
    settings: Settings, name: str, telegrams: Iterable[Telegram], late_cycles: int
) -> None:
    """Check where the loop of an axis is closed, and its gain where that is in the CNC.

    telegrams: of the axis. late_cycles: that its carrier adds to the way of a set value.
    Raises UserError.
    """
    fields = {mapped.field for telegram in telegrams for mapped in telegram.objects}
    _check_telegram(settings, name, has_speed="speed" in fields)
    _check_place(settings, name)
    if not closes_loop(settings, name):
        return
    parameters, drive = settings.axis[name], settings.rig.axis[name].drive
    is_3d = settings.channel.word(RELEASED_3D[0]) == RELEASED_3D[1]
    if is_3d or parameters.flag("lr_param.distance_control_on"):
        what = "3D distance control (P-CHAN-00500)" if is_3d else "distance control (P-AXIS-00328)"
        raise rig_error(
            settings.files,
            ("drive", drive, "mode"),
            f"axis {name}: {what} needs a drive that closes the position loop; here the CNC closes"
            " it and its lag would be in the loop of the distance",
            value=CSV,
            allowed=str(CSP),
        )
    check_gain(
        settings,
        name,
        _limit(settings, name, late_cycles),
        _dead(settings, name, late_cycles),
        settings.rig.cycle.period_us * US / S,
        "CNC",
        "lower it; a shorter period_us, or a drive with a faster speed loop (speed_loop_us),"
        " allows more",
    )


def _check_telegram(settings: Settings, name: str, *, has_speed: bool) -> None:
    drive = drive_of(settings, name)
    if has_speed is (drive.mode == CSV):
        return
    raise rig_error(
        settings.files,
        ("drive", settings.rig.axis[name].drive, "mode"),
        f"axis {name}: the telegrams of its drive carry a set"
        f" {'speed' if has_speed else 'position'} and mode {drive.mode} follows the other one",
        value=drive.mode,
        allowed=str(CSV if has_speed else CSP),
        hint="or another pdo_map",
    )


def _check_place(settings: Settings, name: str) -> None:
    """Refuse a P-AXIS-00320 that the telegram contradicts."""
    parameters = settings.axis[name]
    word, is_here = parameters.word(OPERATION_MODE), closes_loop(settings, name)
    if word != (DRIVE_MODE if is_here else CNC_MODE):
        return
    place = parameters.origin(OPERATION_MODE) or Origin(OPERATION_MODE)
    raise place.error(
        f"axis {name}: its telegrams carry a set {'speed' if is_here else 'position'}, so that the"
        f" {'CNC' if is_here else 'drive'} closes the position loop (P-AXIS-00320)",
        value=word,
        allowed=f"DRIVE_DEFAULT, {CNC_MODE if is_here else DRIVE_MODE}",
        hint=f"or mode = {CSP if is_here else CSV} of its drive",
    )


def _dead(settings: Settings, name: str, late_cycles: int) -> float:
    speed_loop_ns = round(drive_of(settings, name).speed_loop_us * US)
    return dead_cycles(late_cycles, speed_loop_ns, settings.rig.cycle.period_us * US)


def _limit(settings: Settings, name: str, late_cycles: int) -> float:
    is_held = drive_of(settings, name).make().velocity_demand == "held"
    return gain_limit(_dead(settings, name, late_cycles), is_held=is_held)


def describe_loop(settings: Settings, name: str, late_cycles: int) -> list[str]:
    """Say what a loop in the CNC does, or that parameters of one do not act."""
    loop, parameters = loop_settings(settings, name), settings.axis[name]
    if loop is None:
        given = [path for path in OF_LOOP if parameters.origin(path) is not None]
        if not given:
            return []
        return [
            f"warning: axis {name}: its drive closes the position loop, so that"
            f" {', '.join(given)} of its list count for nothing"
        ]
    lag_mm = ramp_lag_mm(SHOWN_MM_S, loop.kv_per_s, loop.feed_forward)
    limit_per_s = _limit(settings, name, late_cycles) / loop.period_s
    return [
        f"axis {name}: the CNC closes the position loop: Kv {loop.kv_per_s:g} 1/s, feed-forward"
        f" {loop.feed_forward:.6g}, lag {lag_mm:.4g} mm at {SHOWN_MM_S:g} mm/s; stable below"
        f" {limit_per_s:.4g} 1/s with {_dead(settings, name, late_cycles):.4g} dead cycles"
    ]
