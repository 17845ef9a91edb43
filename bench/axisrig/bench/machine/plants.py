"""From the plant tables of a rig to initialisable FMUs with start values and wires."""

import re
from collections.abc import Mapping, Sequence
from functools import partial
from math import isclose
from pathlib import Path
from typing import Literal

from axisrig.bench.machine.deflection import check_strokes
from axisrig.bench.machine.fmu_files import plant_path, problems, remarks
from axisrig.bench.machine.kept_fmus import close_fmus, close_plant, roles_of, take_fmu
from axisrig.bench.machine.start_places import blamed_start, check_places
from axisrig.bench.machine.start_values import set_start_values
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.file import LOAD, MapTable, PlantTable, error_at, rig_error
from axisrig.bench.rig.real_axes import outside_axes, simulated_plants
from axisrig.bench.rig.settings import Settings
from axisrig.fmus import MODELS
from axisrig.kernel.cosim.fmi.fmu import FmuSlave, PlantError, load_fmu
from axisrig.kernel.cosim.fmi.role_table import roles_of as names_of_roles
from axisrig.kernel.cosim.fmi.roles import (
    FLAG_THRESHOLD,
    Roles,
    Source,
    coordinates_of,
    guess_kind,
    map_roles,
    refuse_unknown,
)
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import US

WARNINGS_SHOWN_MAX = 20


def build_plant(settings: Settings) -> Plant:
    """Load every plant FMU of a rig, set its start values, wire the sensors to the axes.

    Raises UserError with file, line and key of the rig (or the cell of the plan).
    """
    plant = _empty_plant(settings)
    sensors: list[tuple[str, PlantTable, Roles]] = []
    loaded: list[FmuSlave] = []
    encoders = {axis.plant: axis.encoder_2 for axis in settings.rig.axis.values()}
    try:
        plants = simulated_plants(settings).items()
        for instance, table in sorted(plants, key=lambda item: item[1].shares is not None):
            if table.shares is None:
                slave = _load(settings, instance, table)
                loaded.append(slave)
            else:
                slave = _shared(settings, plant, instance, table, table.shares)
            find = partial(_roles, settings, instance, table, slave)
            roles = roles_of(slave, table, find)
            second = instance if encoders.get(instance) == LOAD else encoders.get(instance)
            if table.shares is not None:
                _add_beside(settings, plant, instance, table.shares, roles, second)
            elif roles.kind == "axis":
                plant.add_axis(slave, roles, second)
            else:
                sensors.append((instance, table, roles))
            set_start_values(settings, instance, table, roles)
            notes = [note for note in roles.notes if not _is_needless(settings, instance, note)]
            plant.notes[instance] = [*problems(slave), *notes]
            plant.remarks[instance] = remarks(table, roles)
        for instance, table, roles in sensors:
            _wire(settings, plant, instance, table, roles)
    except BaseException:
        close_fmus(loaded)
        raise
    return plant


def _shared(
    settings: Settings, plant: Plant, instance: str, table: PlantTable, first: str
) -> FmuSlave:
    """Return the FMU that a plant has in common with another. Raises UserError when it cannot."""
    owners = [name for name, axis in plant.axes.items() if axis.slave.name == name]
    if first not in owners:
        message = f"plant {instance}: shares must name the plant of an axis that is simulated here"
        keys = ("plant", instance, "shares")
        raise rig_error(settings.files, keys, message, value=first, allowed=owners or "none")
    if table.fmu != settings.rig.plant[first].fmu:
        message = f"plant {instance} shares the FMU of {first} and names another"
        allowed = settings.rig.plant[first].fmu
        keys = ("plant", instance, "fmu")
        raise rig_error(settings.files, keys, message, value=table.fmu, allowed=allowed)
    hint = f"plant {instance} shares the FMU of {first}: set it there"
    if table.start:
        message = f"start values of plant {instance} belong to {first}"
        raise rig_error(settings.files, ("plant", instance, "start"), message, hint=hint)
    for item, located in settings.start.get(instance, []):
        raise located(
            UserError(f"{instance} has no start values", value=item.name, hint=hint), item
        )
    return plant.axes[first].slave


def _add_beside(
    settings: Settings, plant: Plant, instance: str, first: str, roles: Roles, second: str | None
) -> None:
    keys = ("plant", instance, "shares")
    if roles.kind != "axis":
        message = f"plant {instance} shares an FMU and is no axis"
        raise rig_error(settings.files, keys, message, value=roles.kind, allowed="axis")
    others = {
        bound.variable: name
        for name, axis in plant.axes.items()
        if axis.slave is roles.slave
        for bound in axis.roles.bound.values()
        if bound.variable in roles.slave.names("input")
    }
    taken = [b.variable for b in roles.bound.values() if b.variable in others]
    if taken:
        message = f"plant {instance} writes the same input as {others[taken[0]]}"
        hint = "give both a suffix, or a map"
        raise rig_error(settings.files, keys, message, value=taken[0], hint=hint)
    try:
        plant.add_axis_beside(instance, first, roles, second)
    except UserError as error:
        raise error_at(settings.files, keys, error) from error


def _is_needless(settings: Settings, instance: str, note: str) -> bool:
    """Return whether a note is about what a limit or home switch has nothing to do with."""
    keys = [
        key
        for axis in settings.rig.axis.values()
        for key, name in axis.signals.items()
        if name == instance
    ]
    is_switch = bool(keys) and not any(key.startswith("probe") for key in keys)
    return is_switch and note.startswith("no contact_")


def _load(settings: Settings, instance: str, table: PlantTable) -> FmuSlave:
    path = plant_path(settings, instance, table)
    # What this version has built may be used again, see `kept_fmus`
    load = load_fmu if table.fmu.endswith(".fmu") else take_fmu
    try:
        return load(path, instance)
    except UserError as error:
        message = f"{error.message} ({path.name})"
        keys = ("plant", instance, "fmu")
        raise error_at(settings.files, keys, error, message) from error


def _roles(settings: Settings, instance: str, table: PlantTable, slave: FmuSlave) -> Roles:
    """Find out which roles the FMU of a plant fills."""
    sources = _suffixed(slave, table.suffix) if table.suffix else {}
    sources |= {role: _source(entry) for role, entry in table.map.items()}
    kind = table.kind or guess_kind(slave, sources)
    place = ("plant", instance)
    if kind is None:
        raise rig_error(
            settings.files,
            (*place, "fmu"),
            f"{Path(table.fmu).name}: its variables and the map fit neither an axis nor a sensor",
            value=instance,
            hint="give kind and map in the rig: with kind, the message names the roles that "
            "are missing or misspelt; docs/rigs.md names the roles of each",
        )

    def located(error: UserError, role: str) -> UserError:
        keys = (*place, "map", role) if role in table.map else (*place, "fmu")
        return error_at(settings.files, keys, error, f"plant {instance}: {error.message}")

    coordinates = coordinates_of(slave, kind, sources)
    refuse_unknown(kind, table.map, list(table.wire) or coordinates, located)
    if kind == "axis" and table.wire:
        raise rig_error(
            settings.files, (*place, "wire"), f"plant {instance} is an axis: nothing is wired to it"
        )
    if kind != "axis":
        _check_wire(settings, instance, table, coordinates)
    try:
        roles = map_roles(slave, kind, sources, list(table.wire), located)
    except UserError as error:
        raise error if error.file else error_at(settings.files, (*place, "fmu"), error) from error
    if slave.grid_ns is not None and kind != "axis" and roles.has_group("trajectory"):
        raise rig_error(
            settings.files,
            (*place, "fmu"),
            f"plant {instance} reads trajectories but cannot take steps that differ in length",
            hint="let it follow positions: step_time = false and g_position in its map",
        )
    return roles


def _suffixed(slave: FmuSlave, suffix: str) -> dict[str, Source | None]:
    """Return the variables that have the name of a role of an axis with a suffix."""
    names = [role for role in names_of_roles("axis", []) if slave.has(role + suffix)]
    found: dict[str, Source | None] = {name: Source(name + suffix) for name in names}
    if {"force_limit_negative", "force_limit_positive"} <= set(found):
        found["force_limit"] = None
    return found


def _source(entry: str | Literal[False] | MapTable) -> Source | None:
    if isinstance(entry, MapTable):
        return Source(
            entry.variable,
            entry.unit,
            entry.sign,
            FLAG_THRESHOLD if entry.threshold is None else entry.threshold,
            None if entry.lead_mm is None else entry.lead_mm * 1e-3,
        )
    return None if entry is False else Source(entry)


def _empty_plant(settings: Settings) -> Plant:
    """Make a plant whose steps serve every drive: fine where one of them looks up a latch."""
    cycle = settings.rig.cycle
    drives = [drive.facts() for drive in settings.rig.drive.values()]
    return Plant(
        cycle.exchange_us * US,
        cycle.fine_us * US,
        hold_ns=max([0, *(drive.look_ahead_ns for drive in drives)]),
        look_back_ns=max([0, *(drive.look_back_ns for drive in drives)]),
    )


def _check_wire(
    settings: Settings, instance: str, table: PlantTable, coordinates: Sequence[str]
) -> None:
    keys = ("plant", instance, "wire")
    if not table.wire:
        raise rig_error(settings.files, keys, f"plant {instance} is wired to no axis")
    for coordinate in table.wire:
        if coordinate not in coordinates:
            raise rig_error(
                settings.files,
                (*keys, coordinate),
                f"{instance} has no input {coordinate}",
                value=coordinate,
                allowed=coordinates or None,
                hint=f"an own FMU says in its map what reads it: {coordinate}_position = ...",
            )


def _wire(settings: Settings, plant: Plant, instance: str, table: PlantTable, roles: Roles) -> None:
    add = plant.add_probe if roles.kind == "probe" else plant.add_distance
    try:
        add(roles.slave, table.wire, roles)
    except UserError as error:
        raise error_at(settings.files, ("plant", instance, "wire"), error) from error


def check_plants(settings: Settings, plant: Plant) -> None:
    """Check that axes drive axis FMUs and that their inputs are wired to probes.

    Raises UserError with file, line and key of the rig.
    """
    outside = outside_axes(settings)
    check_strokes(settings, plant.probes)
    for variable, entry in settings.rig.plc.items():
        if entry.sensor not in plant.distances:
            raise rig_error(
                settings.files,
                ("plc", variable),
                f"{variable}: sensor must name a distance sensor that is simulated here",
                value=entry.sensor,
                allowed=plant.distances or "none in this rig",
            )
    _check_plc_task(settings, plant)
    for name, axis in settings.rig.axis.items():
        if name in outside:
            continue
        wanted: list[tuple[str, str | None, Mapping[str, object], str]] = [
            ("plant", axis.plant, plant.axes, "an axis plant"),
            *(
                (key, instance, plant.probes, "a probe or a switch")
                for key, instance in axis.signals.items()
            ),
        ]
        if axis.encoder_2 not in (None, LOAD):
            wanted.append(("encoder_2", axis.encoder_2, plant.distances, "a distance sensor"))
        for key, instance, known, kind in wanted:
            if instance is not None and instance not in known:
                raise rig_error(
                    settings.files,
                    ("axis", name, key),
                    f"axis {name}: {key} must name {kind} of this rig",
                    value=instance,
                    allowed=known or "none in this rig",
                )


def _check_plc_task(settings: Settings, plant: Plant) -> None:
    """Check that the terminal and the output of the PLC are wired to probes of this rig."""
    task = settings.rig.plc_task
    if task is None:
        return
    channels = {} if task.terminal is None else task.terminal.inputs
    wired: dict[tuple[str, ...], str] = {
        ("plc", "terminal", f"input_{number}"): name for number, name in channels.items()
    }
    if task.switches is not None:
        wired[("plc", "switches")] = task.switches
    for keys, name in wired.items():
        probe = plant.probes.get(name)
        if probe is None or (keys[-1] == "switches" and not probe.can_be_switched()):
            can = "that can be switched on" if keys[-1] == "switches" else "or a switch"
            raise rig_error(
                settings.files,
                keys,
                f"{'.'.join(keys)} must name a probe {can}, of this rig",
                value=name,
                allowed=plant.probes or "none in this rig",
            )


def _compare_leads(settings: Settings, plant: Plant, name: str) -> None:
    """Note when a model of the library has another screw than its drive.

    Torque becomes force with the lead of the drive, F = 2 pi M/h; the model takes its own for the
    mass of the rotating parts.
    """
    axis = settings.rig.axis[name]
    slave = plant.axes[axis.plant].slave
    lead_mm = settings.rig.drive[axis.drive].facts().lead_mm
    if settings.rig.plant[axis.plant].fmu not in MODELS or not slave.has("screw_lead"):
        return
    screw_mm = float(slave.get("screw_lead")) * 1e3
    if not isclose(screw_mm, lead_mm, rel_tol=1e-9):
        plant.notes[axis.plant].append(
            f"its screw_lead is {screw_mm:g} mm and lead_mm of drive {axis.drive} {lead_mm:g}:"
            " torque limits act with the one of the drive, the rotor weighs with that of the plant"
        )


def check_plant(settings: Settings) -> None:
    """Build, check and start the plants of a rig, and let them go again; no bus is opened.

    Raises UserError as `check_rig`, `build_plant`, `check_plants` and `start_plant` do.
    """
    check_rig(settings)
    plant = build_plant(settings)
    try:
        check_plants(settings, plant)
        start_plant(settings, plant)
    finally:
        close_plant(plant)


def start_plant(settings: Settings, plant: Plant) -> None:
    """Initialise every plant at time 0 and check the positions of its axes.

    Raises UserError with file, line and key of the rig, see `check_places`.
    """
    try:
        plant.initialize(0)
    except PlantError as error:
        words = set(re.findall(r"\w+", error.reason))
        given = settings.start.get(error.instance, [])
        named = tuple(item.name for item, _ in given if item.name in words)
        refusal = UserError(f"{error.instance}: {error.reason}")
        raise blamed_start(settings, error.instance, refusal, named) from error
    check_places(settings, plant)
    for name in settings.rig.axis:
        if name not in outside_axes(settings):
            _compare_leads(settings, plant, name)


def describe_plants(settings: Settings, plant: Plant) -> list[str]:
    """Say what the bench makes of each FMU of the user, and what others lack."""
    lines: list[str] = []
    for instance, table in simulated_plants(settings).items():
        notes = [*plant.notes[instance], *plant.remarks[instance]]
        if not notes and not table.fmu.endswith(".fmu"):
            continue
        slave, kind = _what(plant, instance)
        version = f"{Path(table.fmu).name}, FMI {slave.description.fmiVersion}"
        lines.append(f"plant {instance} ({version}) is {kind}")
        lines += [f"  {note}" for note in notes]
    return lines


def _what(plant: Plant, instance: str) -> tuple[FmuSlave, str]:
    if instance in plant.axes:
        return plant.axes[instance].slave, "an axis"
    if instance in plant.probes:
        return plant.probes[instance].slave, "a probe"
    return plant.distances[instance].slave, "a distance sensor"


def lacking_notes(plant: Plant) -> list[str]:
    """Return what plants lack."""
    return [
        f"plant {instance}: {note}" for instance, notes in plant.notes.items() for note in notes
    ]


def plant_warnings(plant: Plant) -> list[str]:
    """Say, after a run, how well edges are known and what FMUs warned of."""
    lines = []
    for instance, probe in plant.probes.items():
        if probe.edge_uncertainty_ns > 1.0:
            lines.append(f"plant {instance}: edges are known to {probe.edge_uncertainty_ns:g} ns")
    for slave in dict.fromkeys(_what(plant, instance)[0] for instance in plant.notes):
        for message in list(slave.messages)[:WARNINGS_SHOWN_MAX]:
            lines.append(f"plant {slave.name} at {message.time_ns / 1e6:.6f} ms: {message.text}")
        more = len(slave.messages) - WARNINGS_SHOWN_MAX
        if more > 0:
            lines.append(f"plant {slave.name}: {more} more messages")
    return lines
