"""What a rig has for the 3D distance control of its channel: dead cycles, limits of kp, sign, mode.

The loop is that of an axis with a variable: the offset is one number along the normal of the
assumed plane, and the tool moves by offset/cos b along its direction, b between both. Over a
surface parallel to that plane the limit of kp does not depend on b.
"""

from collections.abc import Sequence

from axisrig.bench.oracles.distance.cycles import predicted
from axisrig.bench.oracles.distance.lists import NEWER, Listed, as_written
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS, Loop
from axisrig.bench.oracles.distance.sample_hold import held_limit
from axisrig.bench.oracles.distance.smoothing import of_control
from axisrig.bench.oracles.distance.stability import kp_limit
from axisrig.bench.rig.distance.check import WITHOUT_LAG
from axisrig.bench.rig.reading.plc_sensors import PlcSensorTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.channel.distance.sensor import PERIODS_MAX
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.time.clock import US, S

FUNCTION, RELEASES = "configuration.decoder.function", "FCT_3D_DIST_CTRL"
PREFIX = "dist_ctrl[0]."


def is_released(settings: Settings) -> bool:
    """Whether the channel list releases 3D distance control (P-CHAN-00500)."""
    return settings.channel.word(FUNCTION) == RELEASES


def listed_of_channel(channel: ParameterSet) -> Listed:
    """Return what the channel list says of its distance control, P-CHAN-00800 to 00827."""
    found = dict(channel.items())
    written = {
        NEWER + name.removeprefix(PREFIX): value
        for name, value in found.items()
        if name.startswith(PREFIX)
    }
    return as_written(written)


def loop_of_channel(settings: Settings, entry: PlcSensorTable, mode: str) -> Loop:
    """Return the loop of the channel with a variable of the PLC."""
    listed, period_ns = listed_of_channel(settings.channel), settings.rig.cycle.period_us * US
    control = listed.control
    dead = predicted(is_optimized=listed.is_optimized, sensor_age_cycles=entry.delay_cycles)
    return Loop(
        mode,
        dead.dead - entry.delay_cycles,
        of_control(control, period_ns),
        sent_cycles=dead.reaction,
        skew_cycles=entry.delay_cycles,
        integral=period_ns / S / control.tn_s if control.tn_s else 0.0,
        derivative=control.tv_s * S / period_ns,
    )


def channel_warnings(settings: Settings) -> list[str]:
    """Say what keeps 3D distance control from working as the rig and its list are."""
    if not is_released(settings):
        return []
    plc = settings.rig.plc
    if not plc:
        return ["3D distance control has no sensor: [plc] of the rig names no variable"]
    return [
        f"{name} counts negative with a growing distance; 3D distance control wants the orthogonal"
        " distance as it is: sign = 1 in [plc]"
        for name, entry in plc.items()
        if entry.sign == -1
    ]


def describe_channel(settings: Settings) -> list[str]:
    """Show sensor, dead cycles and limits of kp of the channel, for each variable of the PLC."""
    if not is_released(settings):
        return []
    return [
        "\n".join([f"3D distance control of the channel: {entry.sensor} in {name}", *lines])
        for name, entry in settings.rig.plc.items()
        for lines in [_lines(settings, entry)]
    ]


def _lines(settings: Settings, entry: PlcSensorTable) -> Sequence[str]:
    listed, cycle_ns = listed_of_channel(settings.channel), settings.rig.cycle.period_us * US
    control, age = listed.control, entry.delay_cycles
    dead = predicted(is_optimized=listed.is_optimized, sensor_age_cycles=age)
    goes = "the same" if listed.is_optimized else "the next"
    smoothing = loop_of_channel(settings, entry, CONST_DIST).smoothing
    lines = [
        f"  dead cycles  n = {dead.dead}: the offset is sent in {goes} cycle (P-CHAN-00818 ="
        f" {int(listed.is_optimized)}) and is reached at the 2nd SYNC after it; the sensor value is"
        f" {age} cycles old",
        f"  sign         {_sign(entry)}",
        f"  value        {_value(entry)}",
        f"  silence      {_silence(entry)}",
        f"  filter       {smoothing.name}: {smoothing.delay_cycles:.3g} cycles late, noise times"
        f" {smoothing.noise_gain:.3g}",
        f"  listed       kp {control.kp:g}, Tn {control.tn_s:g} s, Tv {control.tv_s:g} s",
    ]
    every = entry.every(cycle_ns)
    plants = {settings.rig.plant[axis.plant].fmu for axis in settings.rig.axis.values()}
    for mode in (SET_POS, CONST_DIST):
        loop = loop_of_channel(settings, entry, mode)
        limit = kp_limit(loop) if every == 1 else held_limit(loop, every)
        at_best = plants != {WITHOUT_LAG} and (mode == CONST_DIST or age > 0)
        verdict = "UNSTABLE" if control.kp >= limit else "not known" if at_best else "stable"
        bound = f"{'at best' if at_best else 'stable'} below kp {limit:.4g}"
        lines.append(f"  {bound:<24} {mode}: {verdict} as listed")
    lines.append(
        "  surface      over one inclined by p against the assumed plane, in the plane of the tilt"
        " b, the limits are divided by cos p + sin p tan b (ECS), by cos p (MCS, ACS)"
    )
    return lines


def _sign(entry: PlcSensorTable) -> str:
    return "positive, as 3D distance control wants it" if entry.sign == 1 else "WRONG: sign = -1"


def _value(entry: PlcSensorTable) -> str:
    if entry.normalise == "none":
        return "as the sensor gives it: right where that is the orthogonal distance"
    text = "made orthogonal by the tilt that the channel shows"
    if entry.tilt_delay_cycles:
        text += f", {entry.tilt_delay_cycles} cycles older than the value"
    if entry.tilt_error_deg:
        text += f", wrong by {entry.tilt_error_deg:g} degrees"
    return text


def _silence(entry: PlcSensorTable) -> str:
    if entry.period_ms is None:
        return "not noticed: nothing promises when the next value comes"
    return (
        f"a value every {entry.period_ms:g} ms is promised; control freezes when it is older than"
        f" {PERIODS_MAX * entry.period_ms:g} ms (900314)"
    )
