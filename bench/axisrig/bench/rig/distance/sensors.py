"""What can give a distance control its distance: second encoders and V.E. variables of the PLC."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.rig.families import family_of
from axisrig.bench.rig.reading.file import LOAD, MapTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.channel.distance.sensor import SECOND_ENCODER, VARIABLE
from axisrig.kernel.time.clock import MS, US, TimeNs

INVERTS = "lr_hw[1].vz_istw"
SCALES = ("AxisRig.Sensors.SecondEncoder",)
"""Models of the library that are wired like a distance sensor and give a position."""


@dataclass(frozen=True)
class Sensor:
    """A way from a distance sensor to an axis.

    source: as the control names it (`axis.source_word`). words: what carries it. age: cycles by
    which it is older than 6064, below 0 = newer. late: that the carrier adds to the way of a set
    position until 6064 shows it. every: it comes with every so many SYNCs. sign: 1 when the value
    counts as its control wants it, -1 the other way round; 0: not known. That of an axis gets
    smaller as the tool lifts, that of 3D control grows. promised_ns: the longest time from one
    value to the next, None where nothing promises one.
    """

    source: str
    words: str
    age: int
    every: int
    sign: Literal[-1, 0, 1]
    promised_ns: TimeNs | None
    late: int = 0


def sensors_of(settings: Settings, name: str) -> list[Sensor]:
    """Return what can give an axis its distance: second encoder first, then V.E. variables.

    CHANNEL: what gives 3D control its distance, V.E. variables only.
    """
    if name == CHANNEL:
        return [
            replace(found, sign=-found.sign) for found in _variables(settings, settings.rig.axis)
        ]
    rig = settings.rig
    axis, found = rig.axis[name], []
    way = family_of(settings, name).second_encoder(settings, name)
    if axis.encoder_2 not in (None, LOAD) and way is not None and not is_scale(settings, name):
        inverts = settings.axis[name].flag(INVERTS)
        found.append(
            Sensor(
                SECOND_ENCODER,
                f"{axis.encoder_2} on {way.words}",
                rig.drive[axis.drive].facts().second_delay_cycles,
                way.every,
                _sign(_grows_with(settings, str(axis.encoder_2), [axis.plant]), inverts=inverts),
                way.promised_ns,
                family_of(settings, name).late_cycles(settings, name),
            )
        )
    return [*found, *_variables(settings, [name])]


def _variables(settings: Settings, axes: Iterable[str]) -> list[Sensor]:
    """Return the V.E. variables whose sensors are wired to the plants of all of some axes.

    The PLC reads them as they are at the last SYNC, where 6064 may be of one before it.
    """
    rig, found = settings.rig, []
    plants = [rig.axis[name].plant for name in axes]
    late, fresh = late_of(settings, axes)
    cycle_ns = rig.cycle.period_us * US
    for variable, entry in rig.plc.items():
        grows = _grows_with(settings, entry.sensor, plants)
        words = f"{entry.sensor} in {variable}"
        sign = _sign(grows, inverts=entry.sign == -1)
        every = entry.every(cycle_ns)
        words += f" every {every} cycles" if every > 1 else ""
        promised_ns = None if entry.period_ms is None else round(entry.period_ms * MS)
        source = f"{VARIABLE} {variable}"
        age = entry.delay_cycles - (late - fresh)
        found.append(Sensor(source, words, age, every, sign, promised_ns, late))
    return found


def late_of(settings: Settings, axes: Iterable[str]) -> tuple[int, int]:
    """Return by how many cycles set positions are seen later than on CAN, of the latest axis.

    In 6064, and in what is read as it was at the last SYNC.
    """
    families = [(family_of(settings, name), name) for name in axes]
    late = max((family.late_cycles(settings, name) for family, name in families), default=0)
    fresh = max((family.fresh_late_cycles(settings, name) for family, name in families), default=0)
    return late, fresh


def is_scale(settings: Settings, name: str) -> bool:
    """Whether the second encoder of an axis is a scale, which gives a position."""
    plant = settings.rig.plant.get(settings.rig.axis[name].encoder_2 or "")
    return plant is not None and plant.fmu in SCALES


def _grows_with(settings: Settings, sensor: str, plants: Sequence[str]) -> int:
    """Return 1 when the reading grows as the axis moves up, -1 when it falls; 0: it is not wired.

    plants: of the axis, or of all axes; of these the way up is a matter of the kinematic.

    The role `distance` grows with the coordinate that lifts the sensor; a sign in the map of the
    FMU turns either round.
    """
    table = settings.rig.plant[sensor]
    wired = [group for group, other in table.wire.items() if other in plants]
    if not wired:
        return 0
    wired = wired if len(plants) == 1 else []
    turned = [table.map.get("distance"), *(table.map.get(f"{g}_position") for g in wired)]
    signs = [entry.sign for entry in turned if isinstance(entry, MapTable)]
    return math.prod(signs)


def _sign(grows: int, *, inverts: bool) -> Literal[-1, 0, 1]:
    if grows == 0:
        return 0
    return 1 if (grows > 0) is inverts else -1
