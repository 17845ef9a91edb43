"""What a rig lacks for 3D distance control, and when its loop becomes unstable.

The control of the channel has a V.E. variable as its sensor; its offset counts along the normal of
the surface. Over a surface that is inclined to it the distance changes by more or less than the
offset, which divides the limit of kp; by how much depends on the sensor and on what the PLC makes
of its value (`oracles/distance/tool.py`).
"""

import math
from collections.abc import Mapping
from types import MappingProxyType

from axisrig.bench.oracles.distance.lists import CHANNEL, Listed
from axisrig.bench.oracles.distance.loop import CONST_DIST
from axisrig.bench.oracles.distance.tool import (
    ECS,
    MCS,
    STEEPEST_DEG,
    inclined_gain,
    steepest_gain,
)
from axisrig.bench.oracles.kinematics.lists import Lists
from axisrig.bench.rig.distance.loops import (
    WITHOUT_LAG,
    control_lines,
    cycles_line,
    dead_cycles,
    dead_line,
    is_beyond,
    kp_lines,
    limit_of,
    listed_for,
    loop_of,
    silence_line,
)
from axisrig.bench.rig.distance.sensors import Sensor, sensors_of
from axisrig.bench.rig.reading.plc_sensors import PlcSensorTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.channel.distance.sensor import VARIABLE

OF_AXIS = "lr_param.distance_control_on"
RELEASED, RELEASE = "configuration.decoder.function", "FCT_3D_DIST_CTRL"
ALONG = ("AxisRig.Sensors.HeadDistanceSensor", "AxisRig.Sensors.RobotDistanceSensor")
"""Models of the library that measure along the tool."""
ALONG_TOOL, ORTHOGONAL, ELECTRODE = 0, 1, 2
"""Their `quantity`."""
EXTENSION = 98
EXAMPLES_DEG = ((60.0, 10.0), (75.0, 10.0), (75.0, -10.0))
"""Tilt b of the tool and slope p of the surface, turned to the side of the tool when positive."""


def is_released(settings: Settings) -> bool:
    """Whether the list of the channel has P-CHAN-00500."""
    return str(settings.channel.get(RELEASED)) == RELEASE


def channel_warnings(settings: Settings) -> list[str]:
    """Say what keeps 3D distance control from working as the rig and its lists are.

    A rig whose axes have controls of their own may read their sensors into variables too.
    """
    if not is_released(settings):
        return []
    found = []
    if not settings.rig.plc:
        found.append(
            "no entry of [plc] reads a distance sensor into a V.E. variable: without one that the"
            " program or the PLC side writes ON ends in 310027"
        )
    if not any(axis.flag(OF_AXIS) for axis in settings.axis.values()):
        found += [text for sensor in sensors_of(settings, CHANNEL) for text in _wrong(sensor)]
    for variable, entry in settings.rig.plc.items():
        plant = settings.rig.plant.get(entry.sensor)
        if plant is not None and plant.fmu in ALONG and entry.normalise == "none":
            if _quantity(settings, entry) == ORTHOGONAL:
                continue
            found.append(
                f"{entry.sensor} in {variable} measures along the tool and 3D control wants the"
                " distance along the normal, which is cos of the tilt times that: normalise ="
                ' "along" in [plc] makes the one of the other'
            )
    return [f"3D distance control (P-CHAN-00500): {text}" for text in found]


def _wrong(sensor: Sensor) -> list[str]:
    """Say where a sensor does not fit the control."""
    if sensor.sign == 0:
        return [f"the sensor {sensor.words} is wired to no axis: it does not see the tool"]
    if sensor.sign == 1:
        return []
    return [
        f"{sensor.words} falls when the tool lifts; it has to be the distance of the clamping point"
        " itself: with sign in [plc] as it is the control runs away"
    ]


def channel_ages(settings: Settings) -> list[str]:
    """Say which variables could fall silent without an alarm."""
    sensors = sensors_of(settings, CHANNEL) if is_released(settings) else []
    return [
        f"3D distance control: {sensor.words} promises no time for its next value: no alarm comes"
        " when it falls silent; give the entry of [plc] a period_ms"
        for sensor in sensors
        if sensor.promised_ns is None
    ]


def describe_channel(
    settings: Settings, lags_s: Mapping[str, float] = MappingProxyType({})
) -> list[str]:
    """Show mode, sensor, dead cycles and limits of kp of 3D control; lags_s: of drives, s."""
    if not is_released(settings):
        return []
    by_source = {f"{VARIABLE} {name}": entry for name, entry in settings.rig.plc.items()}
    return [
        "\n".join(
            [
                f"3D distance control of the channel: {sensor.words}",
                *_lines(settings, sensor, by_source[sensor.source], lags_s),
            ]
        )
        for sensor in sensors_of(settings, CHANNEL)
    ]


def _lines(
    settings: Settings, sensor: Sensor, entry: PlcSensorTable, lags_s: Mapping[str, float]
) -> list[str]:
    rig, listed = settings.rig, listed_for(settings, CHANNEL)
    has_loops = any(rig.plant[axis.plant].fmu != WITHOUT_LAG for axis in rig.axis.values())
    lag_s = max(lags_s.values(), default=0.0)
    lines = [
        f"  mode         {_mode(settings)}",
        f"  sign         {_SIGNS[sensor.sign]}",
        f"  value        {_value(entry)}",
        dead_line(settings, CHANNEL, sensor),
        cycles_line(settings, CHANNEL, dead_cycles(listed, sensor)),
        silence_line(sensor, None),
    ]
    if has_loops:
        lag = f"the slowest lags by {lag_s * 1e3:.3g} ms, counted below as a first order; "
        lines.append(
            f"  drives       {lag if lag_s else ''}what else their loops add is not counted"
        )
    lines += control_lines(settings, CHANNEL, sensor)
    lines += kp_lines(settings, CHANNEL, sensor, lag_s, has_loops=has_loops)
    limit = limit_of(loop_of(settings, CHANNEL, sensor, CONST_DIST, lag_s), sensor)
    if has_loops:
        lines.append("  at best all of what follows, as drives with loops of their own lower it")
    return [*lines, *_inclined(settings, entry, listed, limit)]


_SIGNS = {
    1: "the value grows when the tool lifts, as 3D control wants it",
    -1: "WRONG: the value falls when the tool lifts; the control runs away",
    0: "not known: the sensor is wired to no axis",
}


def _mode(settings: Settings) -> str:
    steps = [int(settings.channel.get(f"default_id_of_kin_step[{k}]") or 0) for k in range(2)]
    chosen = ", ".join(str(step) for step in steps if step)
    if not chosen:
        return (
            "without MODE ACS, which needs DIRECTION; no kinematic is listed (P-CHAN-00264), MCS"
            " and ECS need one"
        )
    return (
        f"without MODE MCS while a kinematic is on (#TRAFO ON: {chosen} by P-CHAN-00264), else ACS,"
        " which needs DIRECTION"
    )


def _value(entry: PlcSensorTable) -> str:
    if entry.normalise == "none":
        return "as the sensor gives it: right where that is the orthogonal distance"
    text = "made orthogonal by the tilt that the channel shows"
    if entry.tilt_delay_cycles:
        text += f", {entry.tilt_delay_cycles} cycles older than the value"
    if entry.tilt_error_deg:
        text += f", wrong by {entry.tilt_error_deg:g} degrees"
    return text


def largest_tilt_deg(settings: Settings) -> float:
    """Return the largest tilt in ECS: HD4 of a listed kinematic 98, at most that of ECS."""
    written = dict(settings.channel.items())
    if int(written.get("default_id_of_kin_step[1]", 0) or 0) != EXTENSION:
        return STEEPEST_DEG
    largest = Lists(written, {}).of(1, EXTENSION).hd(4)
    return min(largest, STEEPEST_DEG) if largest > 0.0 else STEEPEST_DEG


def _inclined(settings: Settings, entry: PlcSensorTable, listed: Listed, limit: float) -> list[str]:
    """Say how an inclined surface changes the limit of the constant distance, by its sensor."""
    kp, tilt_deg = listed.control.kp, largest_tilt_deg(settings)
    if _quantity(settings, entry) == ELECTRODE or entry.normalise == "electrode":
        return [
            _PARALLEL,
            "  inclined     not known: over an inclined surface a disc electrode does not give the"
            " distance (docs/rigs.md)",
        ]
    along, normalised = _quantity(settings, entry) == ALONG_TOOL, entry.normalise != "none"
    if along and not normalised:
        return [
            "  these hold with the tool along the normal only: the value is not normalised; over a"
            f" parallel surface with the tool at b that of {CONST_DIST} is {limit:.4g} times cos b"
        ]

    def examples(mode: str) -> str:
        found = [
            (inclined_gain(mode, *place, along_tool=along, is_normalised=normalised), *place)
            for place in EXAMPLES_DEG
        ]
        words = [f"{limit / gain:.4g} at {b:g}/{p:g} deg" for gain, b, p in found]
        return f"kp {', '.join(words)} (b/p)"

    if along:
        return [
            _PARALLEL,
            f"  inclined     {CONST_DIST}, the value along the tool times cos b: ECS as above over"
            " any surface; ACS along Z and MCS times 1 + tan p tan b with the tool at b in the"
            f" plane of p: {examples(MCS)}",
            f"  {_turned_away(kp, limit, tilt_deg)}",
        ]
    if normalised:
        return [
            "  these hold with the tool along Z only: the sensor gives the orthogonal distance and"
            ' the PLC takes it times cos b; set normalise = "none" in [plc]'
        ]
    worst = limit / steepest_gain(tilt_deg)
    verdict = "UNSTABLE as listed" if is_beyond(kp, worst) else "stable as listed"
    return [
        _PARALLEL,
        f"  inclined     a surface inclined by p divides that of {CONST_DIST} by cos p in ACS and"
        " MCS, by cos p + sin p tan b in ECS with the tool at b in the plane of p:"
        f" {examples(ECS)}",
        f"  {f'stable below kp {worst:.4g}':<24} ECS, worst: tool at b = {tilt_deg:g} deg, surface"
        f" across it (p = b): {verdict}",
    ]


_PARALLEL = "  these hold over a surface parallel to the assumed plane, at every tilt of the tool"


def _quantity(settings: Settings, entry: PlcSensorTable) -> int:
    """Return what a sensor measures: ALONG_TOOL, ORTHOGONAL or ELECTRODE."""
    plant = settings.rig.plant.get(entry.sensor)
    if plant is None or plant.fmu not in ALONG:
        return ORTHOGONAL
    return int(float(str(plant.start.get("quantity", ALONG_TOOL))))


def _turned_away(kp: float, limit: float, tilt_deg: float) -> str:
    """Say from which slope on the listed kp is unstable along the normal: kp = (1 + t) limit."""
    if is_beyond(kp, limit):
        return f"{'UNSTABLE':<24} MCS, ACS: as listed, also over a parallel surface"
    slope_deg = math.degrees(math.atan((1.0 - kp / limit) / math.tan(math.radians(tilt_deg))))
    return (
        f"{f'stable up to p -{slope_deg:.3g} deg':<24} MCS, ACS, kp {kp:g} as listed: tool at b ="
        f" {tilt_deg:g} deg, surface turned away from it; up to p = b - 90 deg no kp is left"
    )
