"""What a rig lacks for the distance control of its axes, and when its loops become unstable.

The dead cycles follow from P-AXIS-00509, the telegram of the sensor and its age on the way; limits
of kp from the closed forms of `bench/axisrig/bench/oracles/distance`.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction

from axisrig.bench.rig.distance.channel import (
    channel_ages,
    channel_warnings,
    describe_channel,
    is_released,
)
from axisrig.bench.rig.distance.loops import (
    WITHOUT_LAG,
    control_lines,
    cycles_line,
    dead_cycles,
    dead_line,
    kp_lines,
    listed_for,
    silence_line,
)
from axisrig.bench.rig.distance.sensors import Sensor, is_scale, sensors_of
from axisrig.bench.rig.families import family_of
from axisrig.bench.rig.reading.file import LOAD
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.parameters.units import UNITS_PER_MM

RELEASED = "lr_param.distance_control_on"
SIGNS = (
    ("P-AXIS-00230", "sensor value", "SET_POS, CONST_DIST and with both encoders"),
    ("0", "less when the tool lifts", "converge"),
    ("1", "the gap: more when the tool lifts", "converge"),
    ("0", "the gap: more when the tool lifts", "run away until 70330 or 70331"),
    ("1", "less when the tool lifts", "run away until 70330 or 70331"),
)


def released_axes(settings: Settings) -> list[str]:
    """Return the axes with P-AXIS-00328."""
    return [name for name, axis in settings.axis.items() if axis.flag(RELEASED)]


@once
def distance_warnings(settings: Settings) -> list[str]:
    """Say what keeps distance control from working as the rig and its lists are."""
    of_axes = [
        f"axis {name}: {text}"
        for name in released_axes(settings)
        for text in (*_missing(settings, name), *_wrong(settings, name))
    ]
    return [*of_axes, *channel_warnings(settings)]


def age_warnings(settings: Settings) -> list[str]:
    """Say which sensors could fall silent without an alarm; a run reports this by 900315."""
    of_axes = [
        f"axis {name}: {sensor.words} promises no time for its next value: no alarm comes when it"
        " falls silent; give the TPDO an event timer (event_ms of its mapping table), the entry of"
        " [plc] a period_ms"
        for name in released_axes(settings)
        for sensor in sensors_of(settings, name)
        if sensor.promised_ns is None
    ]
    return [*of_axes, *channel_ages(settings)]


def _missing(settings: Settings, name: str) -> list[str]:
    """Say why the second encoder gives no distance, where nothing else does."""
    axis, drive = settings.rig.axis[name], settings.rig.axis[name].drive
    if sensors_of(settings, name):
        return []
    start = "distance control is released (P-AXIS-00328) and no sensor gives it a distance:"
    if axis.encoder_2 is None:
        return [
            f"{start} name a distance sensor as encoder_2 of [axis.{name}], or let the PLC read one"
            " ([plc]); without, ON ends in 310029"
        ]
    if axis.encoder_2 == LOAD or is_scale(settings, name):
        return [
            f"{start} encoder_2 = {axis.encoder_2} is a scale: it gives the position of the axis"
        ]
    return [
        f"{start} the mapping table of drive {drive} does not map 60E4:1, field second; ON ends in"
        " 310029"
    ]


def _wrong(settings: Settings, name: str) -> list[str]:
    """Say what of a sensor does not fit the list.

    Where 3D control is released too it wants the other sign: a variable may be for it.
    """
    found, sensors = [], sensors_of(settings, name)
    has_both = is_released(settings) and any(sensor.sign == 1 for sensor in sensors)
    for sensor in sensors:
        if sensor.sign == 0:
            plant = settings.rig.axis[name].plant
            found.append(f"the sensor {sensor.words} is not wired to {plant}: it does not see it")
        if sensor.sign == -1 and not has_both:
            by = "the sign of [plc]" if " in V.E." in sensor.words else "P-AXIS-00230"
            found.append(
                f"{sensor.words} counts with the motor: with {by} as it is the offset feeds back"
                " with the wrong sign and the control runs away"
            )
    return [*found, *_resolution(settings, name)]


def _resolution(settings: Settings, name: str) -> list[str]:
    """Compare P-AXIS-00422 and 00423 with the position unit of the drive."""
    axis, parameters = settings.rig.axis[name], settings.axis[name]
    if (
        axis.encoder_2 in (None, LOAD)
        or family_of(settings, name).second_encoder(settings, name) is None
    ):
        return []
    listed = Fraction(
        parameters.integer("lr_hw[1].encoder_resolution_num") * UNITS_PER_MM,
        parameters.integer("lr_hw[1].encoder_resolution_denom"),
    )
    given = settings.rig.drive[axis.drive].facts().units_per_mm
    if listed == given:
        return []
    return [
        f"P-AXIS-00422 and 00423 say {float(listed):g} increments of the sensor per mm, its drive"
        f" sends {float(given):g}: every distance is {float(given / listed):.6g} times what it is"
    ]


def describe_distance(settings: Settings, lags_s: Mapping[str, float]) -> list[str]:
    """Show sensor, dead cycles and limits of kp of each axis with distance control, then of 3D.

    lags_s: lag of the drive of an axis, s; without it 0.
    """
    released = released_axes(settings)
    texts = [
        f"axis {name}: {axis.encoder_2} is its second encoder, and distance control is not released"
        " (P-AXIS-00328 = 0)"
        for name, axis in settings.rig.axis.items()
        if axis.encoder_2 not in (None, LOAD) and name not in released
    ]
    for name in released:
        for sensor in sensors_of(settings, name):
            if sensor.sign == -1:
                texts.append("\n".join(f"{i:<14}{tells:<36}{ends}" for i, tells, ends in SIGNS))
            lines = _lines(settings, name, sensor, lags_s.get(name, 0.0))
            texts.append("\n".join([f"distance control of axis {name}: {sensor.words}", *lines]))
    return [*texts, *describe_channel(settings, lags_s)]


def drive_lags_s(settings: Settings, plant: Plant) -> dict[str, float]:
    """Return (1 - f)/Kv of each axis whose FMU has both: gain and feed-forward of its drive."""
    found = {}
    for name, axis in settings.rig.axis.items():
        slave = plant.axes[axis.plant].slave if axis.plant in plant.axes else None
        if slave is not None and slave.has("kv") and slave.has("feed_forward"):
            gain, forward = float(slave.get("kv")), float(slave.get("feed_forward"))
            found[name] = (1.0 - forward) / gain if gain > 0 else 0.0
    return found


def _lines(settings: Settings, name: str, sensor: Sensor, lag_s: float) -> Sequence[str]:
    axis = settings.rig.axis[name]
    has_loop = settings.rig.plant[axis.plant].fmu != WITHOUT_LAG
    lines = [
        dead_line(settings, name, sensor),
        cycles_line(settings, name, dead_cycles(listed_for(settings, name), sensor)),
        silence_line(sensor, axis.sensor_age_limit_ms),
    ]
    if has_loop:
        lag = f"lags by {lag_s * 1e3:.3g} ms, counted below as a first order; " if lag_s else ""
        lines.append(
            f"  drive        {lag}what else its loops add is not counted:"
            " axisrig tune distance measures the loop"
        )
    lines += control_lines(settings, name, sensor)
    return [*lines, *kp_lines(settings, name, sensor, lag_s, has_loops=has_loop)]
