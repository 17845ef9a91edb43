"""What a rig lacks for the distance control of its axes, and when its loops become unstable.

The dead cycles follow from P-AXIS-00509, the telegram of the sensor and its age on the way; limits
of kp from the closed forms of `bench/axisrig/bench/oracles/distance`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from axisrig.bench.oracles.distance.cycles import DeadCycles, predicted
from axisrig.bench.oracles.distance.lists import Control, Listed, as_written
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop, growth
from axisrig.bench.oracles.distance.model import first_order_drive
from axisrig.bench.oracles.distance.sample_hold import held_growth, held_limit
from axisrig.bench.oracles.distance.smoothing import none, of_control
from axisrig.bench.oracles.distance.stability import kp_limit
from axisrig.bench.rig.check import axis_telegrams
from axisrig.bench.rig.reading.file import LOAD, MapTable
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.channel.distance.sensor import PERIODS_MAX, SECOND_ENCODER, VARIABLE
from axisrig.kernel.channel.distance.settings import ChannelDistanceSettings
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.drives.mapping import Telegram
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.parameters.units import UNITS_PER_MM
from axisrig.kernel.time.clock import MS, US, S, TimeNs

RELEASED = "lr_param.distance_control_on"
INVERTS = "lr_hw[1].vz_istw"
SCALES = ("AxisRig.Sensors.SecondEncoder",)
"""Models of the library that are wired like a distance sensor and give a position."""
WITHOUT_LAG = "AxisRig.Drives.KinematicAxis"
MODES = (SET_POS, CONST_DIST, BOTH)
AT_LIMIT = 1e-6
"""Share of a limit of kp in which a loop counts as above it: there it rings for ever."""
SIGNS = (
    ("P-AXIS-00230", "sensor value", "SET_POS, CONST_DIST and with both encoders"),
    ("0", "less when the tool lifts", "converge"),
    ("1", "the gap: more when the tool lifts", "converge"),
    ("0", "the gap: more when the tool lifts", "run away until 70330 or 70331"),
    ("1", "less when the tool lifts", "run away until 70330 or 70331"),
)


@dataclass(frozen=True)
class Sensor:
    """A way from a distance sensor to an axis.

    source: as the control names it (`axis.source_word`). words: what carries it. age: cycles by
    which it is older than 6064. every: it comes with every so many SYNCs. sign: 1 when the value
    gets smaller as the tool lifts, -1 when it grows; 0: not known. promised_ns: the longest time
    from one value to the next, None where nothing promises one.
    """

    source: str
    words: str
    age: int
    every: int
    sign: Literal[-1, 0, 1]
    promised_ns: TimeNs | None


def released_axes(settings: Settings) -> list[str]:
    """Return the axes with P-AXIS-00328."""
    return [name for name, axis in settings.axis.items() if axis.flag(RELEASED)]


def sensors_of(settings: Settings, name: str) -> list[Sensor]:
    """Return what can give an axis its distance: second encoder first, then V.E. variables."""
    rig = settings.rig
    axis, found, cycle_ns = rig.axis[name], [], rig.cycle.period_us * US
    telegram = second_telegram(settings, name)
    if (
        axis.encoder_2 not in (None, LOAD)
        and telegram is not None
        and not _is_scale(settings, name)
    ):
        drive = rig.drive[axis.drive].make()
        inverts = settings.axis[name].flag(INVERTS)
        found.append(
            Sensor(
                SECOND_ENCODER,
                f"{axis.encoder_2} on 60E4:1, {telegram.name} {_comes(telegram)}",
                drive.second_delay_cycles,
                _every(telegram, rig.cycle.period_us),
                _sign(_grows_with(settings, str(axis.encoder_2), axis.plant), inverts=inverts),
                telegram.promised_ns(cycle_ns),
            )
        )
    for variable, entry in rig.plc.items():
        grows = _grows_with(settings, entry.sensor, axis.plant)
        words = f"{entry.sensor} in {variable}"
        sign = _sign(grows, inverts=entry.sign == -1)
        every = entry.every(cycle_ns)
        words += f" every {every} cycles" if every > 1 else ""
        promised_ns = None if entry.period_ms is None else round(entry.period_ms * MS)
        source = f"{VARIABLE} {variable}"
        found.append(Sensor(source, words, entry.delay_cycles, every, sign, promised_ns))
    return found


def second_telegram(settings: Settings, name: str) -> Telegram | None:
    """Return the TPDO of an axis that carries 60E4:1."""
    for telegram in axis_telegrams(settings, name).values():
        if any(mapped.field == "second" for mapped in telegram.objects):
            return telegram
    return None


def _comes(telegram: Telegram) -> str:
    if not telegram.is_cyclic:
        timer = f", every {telegram.event_ms} ms at least" if telegram.event_ms else ""
        return f"when it changes{timer}"
    number = telegram.transmission
    return "with every SYNC" if number == 1 else f"with every {number}. SYNC"


def _every(telegram: Telegram, period_us: int) -> int:
    if telegram.is_cyclic:
        return telegram.transmission
    return max(1, math.ceil(telegram.inhibit_100us * 100 / period_us))


def _is_scale(settings: Settings, name: str) -> bool:
    plant = settings.rig.plant.get(settings.rig.axis[name].encoder_2 or "")
    return plant is not None and plant.fmu in SCALES


def _grows_with(settings: Settings, sensor: str, plant: str) -> int:
    """Return 1 when the reading grows as the axis moves up, -1 when it falls; 0: it is not wired.

    The role `distance` grows with the coordinate that lifts the sensor; a sign in the map of the
    FMU turns either round.
    """
    table = settings.rig.plant[sensor]
    wired = [group for group, other in table.wire.items() if other == plant]
    if not wired:
        return 0
    turned = [table.map.get("distance"), *(table.map.get(f"{g}_position") for g in wired)]
    signs = [entry.sign for entry in turned if isinstance(entry, MapTable)]
    return math.prod(signs)


def _sign(grows: int, *, inverts: bool) -> Literal[-1, 0, 1]:
    if grows == 0:
        return 0
    return 1 if (grows > 0) is inverts else -1


def dead_cycles(listed: Listed, sensor: Sensor) -> DeadCycles:
    """Return the dead cycles of a fresh sensor value."""
    return predicted(is_optimized=listed.is_optimized, sensor_age_cycles=sensor.age)


def loop_of(
    settings: Settings,
    name: str,
    sensor: Sensor,
    mode: str,
    lag_s: float = 0.0,
    control: Control | None = None,
) -> Loop:
    """Return the loop of an axis in a mode.

    lag_s: of its drive, first order. control: None = as listed.
    """
    listed, period_ns = listed_of(settings.axis[name]), settings.rig.cycle.period_us * US
    control, dead = control or listed.control, dead_cycles(listed, sensor)
    return Loop(
        mode,
        dead.dead - sensor.age,
        of_control(control, period_ns),
        sent_cycles=dead.reaction,
        skew_cycles=sensor.age,
        integral=period_ns / S / control.tn_s if control.tn_s else 0.0,
        derivative=control.tv_s * S / period_ns,
        drive=first_order_drive(lag_s, period_ns) if lag_s else none(),
    )


def listed_of(axis: ParameterSet) -> Listed:
    """Return what the lists and the plan say of distance control."""
    return as_written(dict(axis.items()))


@once
def distance_warnings(settings: Settings) -> list[str]:
    """Say what keeps the distance control of an axis from working as the rig and its lists are."""
    return [
        f"axis {name}: {text}"
        for name in released_axes(settings)
        for text in (*_missing(settings, name), *_wrong(settings, name))
    ] + _of_channel(settings)


def _of_channel(settings: Settings) -> list[str]:
    """Say what keeps 3D control from working: no variable, or one that falls when the tool lifts.

    A rig whose axes have controls of their own may read their sensors into variables too.
    """
    if ChannelDistanceSettings.read(settings.channel) is None or released_axes(settings):
        return []
    start = "3D distance control (P-CHAN-00500):"
    if not settings.rig.plc:
        return [f"{start} no entry of [plc] reads a distance sensor into a V.E. variable"]
    plants = {axis.plant for axis in settings.rig.axis.values()}
    return [
        f"{start} {variable} falls when the tool lifts; it has to be the distance of the clamping"
        f" point itself: with sign = {entry.sign} the control runs away"
        for variable, entry in settings.rig.plc.items()
        if any(_grows_with(settings, entry.sensor, plant) * entry.sign < 0 for plant in plants)
    ]


def age_warnings(settings: Settings) -> list[str]:
    """Say which sensors could fall silent without an alarm; a run reports this by 900315."""
    return [
        f"axis {name}: {sensor.words} promises no time for its next value: no alarm comes when it"
        " falls silent; give the TPDO an event timer (event_ms of its mapping table), the entry of"
        " [plc] a period_ms"
        for name in released_axes(settings)
        for sensor in sensors_of(settings, name)
        if sensor.promised_ns is None
    ]


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
    if axis.encoder_2 == LOAD or _is_scale(settings, name):
        return [
            f"{start} encoder_2 = {axis.encoder_2} is a scale: it gives the position of the axis"
        ]
    return [
        f"{start} the mapping table of drive {drive} does not map 60E4:1, field second; ON ends in"
        " 310029"
    ]


def _wrong(settings: Settings, name: str) -> list[str]:
    """Say what of a sensor does not fit the list."""
    found = []
    for sensor in sensors_of(settings, name):
        if sensor.sign == 0:
            plant = settings.rig.axis[name].plant
            found.append(f"the sensor {sensor.words} is not wired to {plant}: it does not see it")
        if sensor.sign == -1:
            by = "the sign of [plc]" if " in V.E." in sensor.words else "P-AXIS-00230"
            found.append(
                f"{sensor.words} counts with the motor: with {by} as it is the offset feeds back"
                " with the wrong sign and the control runs away"
            )
    return [*found, *_resolution(settings, name)]


def _resolution(settings: Settings, name: str) -> list[str]:
    """Compare P-AXIS-00422 and 00423 with the position unit of the drive."""
    axis, parameters = settings.rig.axis[name], settings.axis[name]
    if axis.encoder_2 in (None, LOAD) or second_telegram(settings, name) is None:
        return []
    listed = Fraction(
        parameters.integer("lr_hw[1].encoder_resolution_num") * UNITS_PER_MM,
        parameters.integer("lr_hw[1].encoder_resolution_denom"),
    )
    told = settings.rig.drive[axis.drive].make().units_per_mm
    if listed == told:
        return []
    return [
        f"P-AXIS-00422 and 00423 say {float(listed):g} increments of the sensor per mm, its drive"
        f" sends {float(told):g}: every distance is {float(told / listed):.6g} times what it is"
    ]


def unstable(
    settings: Settings, name: str, sensor: Sensor, mode: str, control: Control
) -> str | None:
    """Say why a control that acts cannot be stable, None when it can.

    control: what acts, programmed and written values in it.
    """
    loop, kp = loop_of(settings, name, sensor, mode, control=control), control.kp
    rate = growth(loop, kp) if sensor.every == 1 else held_growth(loop, sensor.every, kp)
    limit = _limit(loop, sensor)
    if rate <= 1.0 and not _is_beyond(kp, limit):
        return None
    dead = dead_cycles(listed_of(settings.axis[name]), sensor).dead
    return (
        f"axis {name}: {mode} by {sensor.words} is unstable with kp {kp:g} (P-AXIS-00759): its"
        f" limit is {limit:.3g} with {dead} dead cycles and the filter that acts"
        f" ({loop.smoothing.name}); axisrig tune distance finds a kp"
    )


def _is_beyond(kp: float, limit: float) -> bool:
    return kp >= limit * (1.0 - AT_LIMIT)


def _limit(loop: Loop, sensor: Sensor) -> float:
    return kp_limit(loop) if sensor.every == 1 else held_limit(loop, sensor.every)


def describe_distance(settings: Settings, lags_s: Mapping[str, float]) -> list[str]:
    """Show sensor, dead cycles and limits of kp of each axis with distance control.

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
    return texts


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
    listed = listed_of(settings.axis[name])
    control, dead = listed.control, dead_cycles(listed, sensor)
    goes = "the same" if listed.is_optimized else "the next"
    lines = [
        f"  dead cycles  {_dead(dead, sensor)}: the offset is sent in {goes} cycle"
        f" (P-AXIS-00509 = {int(listed.is_optimized)}) and is reached at the 2nd SYNC after it;"
        f" the sensor value is {sensor.age} cycles old",
        f"  silence      {_silence(settings, name, sensor)}",
    ]
    plant = settings.rig.plant[settings.rig.axis[name].plant]
    if plant.fmu != WITHOUT_LAG:
        lag = f"lags by {lag_s * 1e3:.3g} ms, counted below as a first order; " if lag_s else ""
        lines.append(
            f"  drive        {lag}what else its loops add is not counted:"
            " axisrig tune distance measures the loop"
        )
    smoothing = loop_of(settings, name, sensor, CONST_DIST).smoothing
    lines += [
        f"  filter       {smoothing.name}: {smoothing.delay_cycles:.3g} cycles late, noise times"
        f" {smoothing.noise_gain:.3g}",
        f"  listed       kp {control.kp:g}, Tn {control.tn_s:g} s, Tv {control.tv_s:g} s",
    ]
    for mode in MODES:
        limit = _limit(loop_of(settings, name, sensor, mode, lag_s), sensor)
        bound = "unstable with any kp" if limit == 0 else f"stable below kp {limit:.4g}"
        verdict = "UNSTABLE as listed" if _is_beyond(control.kp, limit) else "stable as listed"
        if plant.fmu != WITHOUT_LAG and verdict[0] == "s" and (mode == CONST_DIST or sensor.age):
            verdict, bound = "not known as listed", f"at best below kp {limit:.4g}"
        lines.append(f"  {bound:<24} {mode}: {verdict}")
    return lines


def _silence(settings: Settings, name: str, sensor: Sensor) -> str:
    if sensor.promised_ns is None:
        return "not noticed: nothing promises when the next value comes"
    limit_ms = settings.rig.axis[name].sensor_age_limit_ms
    limit_ms = PERIODS_MAX * sensor.promised_ns / MS if limit_ms is None else limit_ms
    return (
        f"a value every {sensor.promised_ns / MS:g} ms is promised; control freezes when it is"
        f" older than {limit_ms:g} ms (900314)"
    )


def _dead(dead: DeadCycles, sensor: Sensor) -> str:
    if sensor.every == 1:
        return f"n = {dead.dead}"
    return f"n = {dead.dead} to {dead.dead + sensor.every - 1}, a value comes every {sensor.every}."
