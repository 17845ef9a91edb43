"""From the plant tables of a rig to initialisable FMUs with start values and wires."""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

from fmpy.model_description import ModelVariable

from bench.plan.assignment import Assignment, parse_assignment, si_unit
from bench.rig.file import PlantTable, rig_error
from bench.rig.settings import Settings
from fmus import MODELS, BuildError, ensure_built
from kernel.clock import US
from kernel.cosim.axis import AXIS_INPUTS
from kernel.cosim.fmu import FmuSlave, PlantError, load_fmu
from kernel.cosim.plant import Plant
from kernel.cosim.probe import TRAJECTORY_INPUTS
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
    sensors: list[tuple[str, PlantTable, FmuSlave]] = []
    try:
        for instance, table in settings.rig.plant.items():
            path = plant_path(settings, instance, table)
            try:
                slave = load_fmu(path, instance)
                if slave.has(*AXIS_INPUTS):
                    plant.add_axis(slave)
            except UserError as error:
                keys = ("plant", instance, "fmu")
                message = f"{error.message} ({path.name})"
                raise rig_error(
                    settings.files,
                    keys,
                    message,
                    value=error.value,
                    allowed=error.allowed,
                    hint=error.hint,
                ) from error
            if instance not in plant.axes:
                sensors.append((instance, table, slave))
            _start_values(settings, instance, table, slave)
        for instance, table, slave in sensors:
            _wire(settings, plant, instance, table, slave)
    except BaseException:
        plant.close()
        raise
    return plant


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


def _wire(
    settings: Settings, plant: Plant, instance: str, table: PlantTable, slave: FmuSlave
) -> None:
    keys = ("plant", instance, "wire")
    if not slave.has("step_time", "step_size"):
        raise rig_error(
            settings.files,
            ("plant", instance, "fmu"),
            f"{Path(table.fmu).name} is neither an axis nor a sensor that reads trajectories",
            value=instance,
            hint="docs/rigs.md names the variables of both",
        )
    if not table.wire:
        raise rig_error(settings.files, keys, f"plant {instance} is wired to no axis")
    for group in table.wire:
        if not slave.has(*(f"{group}_{part}" for part in TRAJECTORY_INPUTS)):
            groups = [
                name[:-6]
                for name in slave.names("input")
                if name.endswith("_start") and not name.endswith("_rate_start")
            ]
            raise rig_error(
                settings.files,
                (*keys, group),
                f"{instance} has no input {group}",
                value=group,
                allowed=groups,
            )
    try:
        plant.add_probe(slave, table.wire)
    except UserError as error:
        raise rig_error(
            settings.files, keys, error.message, value=error.value, allowed=error.allowed
        ) from error


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
