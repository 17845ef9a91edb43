"""What switches off that an axis brakes or gains speed while a value is made.

Braking is off where the axis passes at its feed: the target is braked for within a cycle. A value
that is taken after a signal, as of an axis whose own signal comes later, needs that the signal does
not brake: then it brakes so weakly that nothing comes of it. Which parameters act is in the table
of the kernel (`measuring_dynamics.csv`, FCT-C4 2.1).
"""

from axisrig.bench.rig.settings import Settings
from axisrig.kernel.motion.dynamics import Motion, effective_row

AT_ONCE, HARDLY = 10_000_000, 1
"""Decelerations in mm/s2: within a cycle up to 10 m/s; 0.0005 um in 1 ms."""
_STOP_S = 0.5
"""So long a stop may take whose begin only touches the value: 0.0025 um at 10 mm/s in 0.5 ms."""
_LINEAR, _JERK = "getriebe[0].lslope_profil", "getriebe[0].slope_profil"
_RAMP_TIME = 1
"""us; 0 would be P-AXIS-00200."""
_KEYS = {"rapid": ("grenz_stufe_1", "grenz_stufe_2"), "feed": ("stufe_1", "stufe_2")}


def without_braking(
    settings: Settings, *, is_after_signal: bool, speed_mm_s: float | None = None
) -> dict[str, str | None]:
    """Return the columns with which nothing brakes while a value is made.

    is_after_signal: the value is of an instant at which the axes brake for a signal. speed_mm_s: at
    the contact, where the value has only to do with the first two cycles of the stop.
    """
    stop = HARDLY if is_after_signal else AT_ONCE
    if is_after_signal and speed_mm_s is not None:
        stop = max(HARDLY, round(abs(speed_mm_s) / _STOP_S))
    found = {"set:channel.use_drive_curr_limit": "1", "set:channel.meas_deceleration_mode": "0"}
    for axis in settings.rig.axis:
        for key in _deceleration_keys(settings):
            found[f"set:{axis}.{_LINEAR}.{key}"] = str(AT_ONCE)
        found[f"set:{axis}.{_LINEAR}.a_feedh"] = str(stop)
        found[f"set:{axis}.{_JERK}.a_feedh"] = str(stop)
        found[f"set:{axis}.{_JERK}.tr_feedh"] = str(_RAMP_TIME)
    return {**found}


def without_run_up(settings: Settings) -> dict[str, str | None]:
    """Return the columns with which the axes have their feed within a cycle; they brake as before.

    What brakes takes its value from the acceleration where it has none of its own.
    """
    found: dict[str, str | None] = {}
    for axis in settings.rig.axis:
        values = settings.axis[axis]
        for key in _deceleration_keys(settings):
            found[f"set:{axis}.{_LINEAR}.{key}"] = f"{values.mm_s2(f'{_LINEAR}.{key}'):.0f}"
        feedhold_mm_s2 = values.mm_s2(f"{_LINEAR}.a_feedh")
        found[f"set:{axis}.{_LINEAR}.a_feedh"] = f"{feedhold_mm_s2:.0f}"
        for key in _KEYS[_kind(settings)]:
            found[f"set:{axis}.{_LINEAR}.a_{key}"] = str(AT_ONCE)
    return found


def braking_words(settings: Settings, axis: str) -> str:
    """Say what the axis brakes with in a measurement run."""
    key = _deceleration_keys(settings)[0]
    return f"{key} {settings.axis[axis].mm_s2(f'{_LINEAR}.{key}'):g} mm/s2"


def run_up_words(settings: Settings, axis: str) -> str:
    """Say what the axis gains speed with in a measurement run."""
    key = f"a_{_KEYS[_kind(settings)][0]}"
    return f"{key} {settings.axis[axis].mm_s2(f'{_LINEAR}.{key}'):g} mm/s2"


def _kind(settings: Settings) -> str:
    row = effective_row(settings.channel, Motion.MEASURING)
    return row["acceleration"].removesuffix("_acceleration")


def _deceleration_keys(settings: Settings) -> list[str]:
    return [f"d_{key}" for key in _KEYS[_kind(settings)]]
