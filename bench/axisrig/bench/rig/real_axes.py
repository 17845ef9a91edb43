"""What of a rig is simulated here, and what is real, on a real interface.

A drive is real when its segment has an interface other than the simulated one, unless its
axis says `outside = false`. Neither its plant nor a sensor that reads this plant is simulated then.
"""

from axisrig.bench.rig.reading.file import PlantTable, rig_error
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError


def is_real(settings: Settings, segment: str) -> bool:
    """Whether a segment is a bus outside this process."""
    return settings.segment[segment].is_real


def is_paced(settings: Settings) -> bool:
    """Whether the rig runs in real time: it has a segment that does."""
    return any(is_real(settings, name) for name in settings.segment)


def outside_axes(settings: Settings) -> frozenset[str]:
    """Return the axes whose drive is not simulated here."""
    if not settings.has_kernel:
        return frozenset()
    return frozenset(
        name
        for name, axis in settings.rig.axis.items()
        if (axis.segment in settings.segment and is_real(settings, axis.segment))
        and axis.outside is not False
    )


def simulated_plants(settings: Settings) -> dict[str, PlantTable]:
    """Return the plants that are simulated here, in the order of the rig."""
    away = {settings.rig.axis[name].plant for name in outside_axes(settings)}
    return {
        instance: table
        for instance, table in settings.rig.plant.items()
        if instance not in away and away.isdisjoint(table.wire.values())
    }


def check_outside(settings: Settings) -> None:
    """Refuse what needs a simulation and is real.

    Raises UserError with the place: `outside` on a simulated segment, start values of plants that
    are not simulated, faults on a real bus, a sensor that a simulated drive lacks.
    """
    outside, plants = outside_axes(settings), simulated_plants(settings)
    if settings.faults and is_paced(settings):
        raise UserError(
            "faults are simulated, and this rig has a real bus",
            value=", ".join(dict.fromkeys(fault.kind for fault in settings.faults)),
            hint="leave the fault: columns of the row empty, or run it on the simulated rig",
        )
    for name, axis in settings.rig.axis.items():
        if axis.outside and settings.has_kernel and not is_real(settings, axis.segment):
            raise rig_error(
                settings.files,
                ("axis", name, "outside"),
                f"axis {name} cannot have a real drive: segment {axis.segment} is simulated",
                hint=f"give segment {axis.segment} an interface and a channel",
            )
        for key, sensor in {**axis.signals, "encoder_2": axis.encoder_2}.items():
            if name not in outside and sensor in settings.rig.plant and sensor not in plants:
                raise rig_error(
                    settings.files,
                    ("axis", name, key),
                    f"axis {name}: {sensor} reads an axis outside, so it is not simulated",
                    value=sensor,
                )
    for instance, items in settings.start.items():
        if instance not in plants:
            item, located = items[0]
            raise located(
                UserError(
                    f"{instance} is not simulated: it belongs to a drive outside",
                    value=item.value,
                    hint="set what the real machine has there, and leave the cell empty",
                ),
                item,
            )
