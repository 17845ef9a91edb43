"""From the plant tables of a rig to initialisable FMUs with start values and wires."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Literal

from fmpy.model_description import ModelVariable

from bench.plan.assignment import Assignment, parse_assignment, si_unit
from bench.rig.file import MapTable, PlantTable, rig_error
from bench.rig.settings import Settings
from fmus import MODELS, BuildError, ensure_built
from kernel.clock import US
from kernel.cosim.fmu import FmuSlave, PlantError, load_fmu
from kernel.cosim.plant import Plant
from kernel.cosim.roles import (
    FLAG_THRESHOLD,
    Roles,
    Source,
    coordinates_of,
    guess_kind,
    map_roles,
)
from kernel.errors import UserError, nearest

ENCODER_RANGE = 1 << 31  # INTEGER32 of 6064, increments
_FLAGS = {"true": True, "1": True, "false": False, "0": False}


def plant_path(settings: Settings, instance: str, table: PlantTable) -> Path:
    """Return the FMU of a plant; a model of the library is built when the cache lacks it."""
    if table.fmu.endswith(".fmu"):
        return Path(table.fmu)
    keys = ("plant", instance, "fmu")
    if table.fmu not in MODELS:
        raise rig_error(
            settings.files,
            keys,
            "neither a model of the library nor a path that ends in .fmu",
            value=table.fmu,
            allowed=nearest(table.fmu, MODELS) or MODELS,
        )
    return _built(table.fmu)


@cache
def _built(model: str) -> Path:
    """Look a model of the library up once per process: the hash of its sources costs 3 ms."""
    try:
        return ensure_built(model)
    except BuildError as error:
        raise UserError(f"{model} cannot be built: {error}") from error


def _set_start(slave: FmuSlave, item: Assignment) -> None:
    """Set one start value, converted from the unit that its name ends in."""
    # A variable may itself end in what looks like a unit; its own name wins
    whole = item.column.partition(".")[2]
    plain = replace(item, name=whole, unit="") if slave.has(whole) else item
    if plain.name not in slave.names("parameter"):
        settable = slave.names("parameter")
        known = "start value that can be set" if slave.has(plain.name) else "variable"
        raise UserError(
            f"{slave.name} has no such {known}",
            value=plain.name,
            allowed=nearest(plain.name, settable) or settable,
        )
    variable = slave.variable(plain.name)
    is_flag = str(variable.type) == "Boolean"
    value = _flag(slave, plain) if is_flag else _number(slave, plain, variable)
    try:
        slave.set_start(plain.name, value)
    except PlantError as error:
        message = f"{slave.name} refuses {plain.name}: {error.reason}"
        raise UserError(message, value=item.value) from error


def _flag(slave: FmuSlave, item: Assignment) -> bool:
    if item.value.lower() not in _FLAGS or item.unit:
        raise UserError(
            f"{item.name} of {slave.name} is true or false", value=item.value, allowed="true, false"
        )
    return _FLAGS[item.value.lower()]


def _number(slave: FmuSlave, item: Assignment, variable: ModelVariable) -> float:
    """Return the value in the FMU's unit, an int for an integer variable; check unit and range."""
    value: float = item.si()
    label = f"{item.name} of {slave.name}"
    unit = variable.unit or "1"
    if item.unit and si_unit(item.unit) != unit:
        allowed = "a bare number" if unit == "1" else f"a unit of {unit}"
        raise UserError(f"{label} has another unit", value=item.unit, allowed=allowed)
    low = -math.inf if variable.min is None else float(variable.min)
    high = math.inf if variable.max is None else float(variable.max)
    if not low <= value <= high:
        allowed = f"{low:g} .. {high:g} {'' if unit == '1' else unit}".rstrip()
        raise UserError(f"{label} is out of range", value=item.value, allowed=allowed)
    if str(variable.type) != "Float64":
        if value != int(value):
            raise UserError(f"{label} is a whole number", value=item.value)
        return int(value)
    return value


def _start_values(settings: Settings, instance: str, table: PlantTable, slave: FmuSlave) -> None:
    for key, value in table.start.items():
        try:
            _set_start(slave, parse_assignment(f"plant:{instance}.{key}={str(value).lower()}"))
        except UserError as error:
            raise rig_error(
                settings.files,
                ("plant", instance, "start"),
                f"{key}: {error.message}",
                value=error.value,
                allowed=error.allowed,
            ) from error
    for item, located in settings.start.get(instance, []):
        try:
            _set_start(slave, item)
        except UserError as error:
            raise located(error, item) from error


def build_plant(settings: Settings) -> Plant:
    """Load every plant FMU of a rig, set its start values, wire the sensors to the axes.

    Raises UserError with file, line and key of the rig (or the cell of the plan).
    """
    plant = _empty_plant(settings)
    sensors: list[tuple[str, PlantTable, Roles]] = []
    loaded: list[FmuSlave] = []
    try:
        for instance, table in settings.rig.plant.items():
            slave = _load(settings, instance, table)
            loaded.append(slave)
            roles = _roles(settings, instance, table, slave)
            if roles.kind == "axis":
                plant.add_axis(slave, roles)
            else:
                sensors.append((instance, table, roles))
            _start_values(settings, instance, table, slave)
        for instance, table, roles in sensors:
            _wire(settings, plant, instance, table, roles)
    except BaseException:
        for slave in loaded:
            slave.close()
        raise
    return plant


def _load(settings: Settings, instance: str, table: PlantTable) -> FmuSlave:
    path = plant_path(settings, instance, table)
    try:
        return load_fmu(path, instance)
    except UserError as error:
        message = f"{error.message} ({path.name})"
        keys = ("plant", instance, "fmu")
        raise _at(settings, keys, error, message) from error


def _at(
    settings: Settings, keys: tuple[str, ...], error: UserError, message: str | None = None
) -> UserError:
    """Give an error the place of a key of the rig."""
    return rig_error(
        settings.files,
        keys,
        message or error.message,
        value=error.value,
        allowed=error.allowed,
        hint=error.hint,
    )


def _roles(settings: Settings, instance: str, table: PlantTable, slave: FmuSlave) -> Roles:
    """Find out which roles the FMU of a plant fills."""
    sources = {role: _source(entry) for role, entry in table.map.items()}
    kind = table.kind or guess_kind(slave, sources)
    place = ("plant", instance)
    if kind is None:
        raise rig_error(
            settings.files,
            (*place, "fmu"),
            f"{Path(table.fmu).name}: its variables and the map tell neither an axis nor a sensor",
            value=instance,
            hint="say kind and map in the rig; docs/rigs.md names the roles of both",
        )
    if kind != "axis":
        _check_wire(settings, instance, table, coordinates_of(slave, kind, sources))

    def located(error: UserError, role: str) -> UserError:
        keys = (*place, "map", role) if role in table.map else (*place, "fmu")
        return _at(settings, keys, error, f"plant {instance}: {error.message}")

    try:
        return map_roles(slave, kind, sources, list(table.wire), located)
    except UserError as error:
        raise error if error.file else _at(settings, (*place, "fmu"), error) from error


def _source(entry: str | Literal[False] | MapTable) -> Source | None:
    if isinstance(entry, MapTable):
        return Source(
            entry.variable,
            entry.unit,
            entry.sign,
            FLAG_THRESHOLD if entry.threshold is None else entry.threshold,
            None if entry.lead_mm is None else entry.lead_mm * 1e-3,
        )
    return Source(entry) if entry else None


def _empty_plant(settings: Settings) -> Plant:
    """Make a plant whose steps serve every drive: fine where one of them looks up a latch."""
    cycle, drives = settings.rig.cycle, settings.rig.drive.values()
    delays_us = [drive.input_delay_us + drive.input_filter_us for drive in drives]
    grids_us = [drive.sample_us if drive.latch == "sampled" else 0.0 for drive in drives]
    looks_us = [grid - delay for grid, delay in zip(grids_us, delays_us, strict=True)]
    return Plant(
        cycle.exchange_us * US,
        cycle.fine_us * US,
        hold_ns=round(max(delays_us, default=0.0) * US),
        look_back_ns=round(max([0.0, *looks_us]) * US),
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
                allowed=coordinates,
            )


def _wire(settings: Settings, plant: Plant, instance: str, table: PlantTable, roles: Roles) -> None:
    try:
        plant.add_probe(roles.slave, table.wire, roles)
    except UserError as error:
        raise _at(settings, ("plant", instance, "wire"), error) from error


def check_plants(settings: Settings, plant: Plant) -> None:
    """Check that axes drive axis FMUs and that their inputs are wired to probes.

    Raises UserError with file, line and key of the rig.
    """
    for name, axis in settings.rig.axis.items():
        wanted: list[tuple[str, str | None, Mapping[str, object], str]] = [
            ("plant", axis.plant, plant.axes, "an axis plant"),
            ("probe_1", axis.probe_1, plant.probes, "a probe"),
            ("probe_2", axis.probe_2, plant.probes, "a probe"),
        ]
        for key, instance, known, kind in wanted:
            if instance is not None and instance not in known:
                raise rig_error(
                    settings.files,
                    ("axis", name, key),
                    f"axis {name}: {key} must name {kind} of this rig",
                    value=instance,
                    allowed=known or "none in this rig",
                )


def start_plant(settings: Settings, plant: Plant) -> None:
    """Initialise every plant at time 0 and check that the axes stand where their encoders reach.

    Raises UserError with file, line and key of the rig.
    """
    try:
        plant.initialize(0)
    except PlantError as error:
        raise rig_error(
            settings.files, ("plant", error.instance), f"{error.instance}: {error.reason}"
        ) from error
    for name, axis in settings.rig.axis.items():
        drive = settings.rig.drive[axis.drive]
        limit_mm = ENCODER_RANGE / drive.encoder_increments * drive.lead_mm
        position_mm = plant.axes[axis.plant].position_m() * 1e3
        if abs(position_mm) >= limit_mm:
            message = f"axis {name} starts outside the 32 bits of its encoder"
            value, allowed = f"{position_mm:g} mm", f"-{limit_mm:g} .. {limit_mm:g} mm, ends out"
            for item, located in settings.start.get(axis.plant, []):
                if item.name == "position_start":
                    raise located(UserError(message, value=value, allowed=allowed), item)
            keys = ("plant", axis.plant, "start")
            raise rig_error(settings.files, keys, message, value=value, allowed=allowed)
