"""Start values of plants: from rig and plan, converted to the units of the FMU's variables."""

import math
from collections.abc import Sequence
from dataclasses import replace

from fmpy.model_description import ModelVariable

from axisrig.bench.plan.assignment import (
    Assignment,
    parse_assignment,
    scaled_suffixes,
    si_unit,
    suffixes_of,
)
from axisrig.bench.plan.composition import Mistakes
from axisrig.bench.rig.reading.file import PlantTable, rig_error
from axisrig.bench.rig.settings import Bare, Settings
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.fmi.roles import Roles
from axisrig.kernel.cosim.fmi.units import Unit, find_unit, known_units, unit_name
from axisrig.kernel.errors import Guess, UserError, nearest

_FLAGS = {"true": True, "1": True, "false": False, "0": False}
_REALS = ("Float64", "Float32", "Real")
Start = tuple[str, float | bool | str]
"""A variable and its start value in the unit of the FMU."""


def set_start_values(settings: Settings, instance: str, table: PlantTable, roles: Roles) -> None:
    """Set the start values of the rig, then those of the run.

    Raises UserError with the place of each value that does not fit.
    """
    key = ("start values", instance)
    if settings.is_settled and key in settings.known:
        for name, value in settings.known[key]:
            roles.slave.set_start(name, value)
        return
    found: list[Start] = []
    mistakes = Mistakes()
    for name, value in table.start.items():
        try:
            text = value if isinstance(value, str) else str(value).lower()
            item = parse_assignment(f"plant:{instance}.{name}={text}")
            found.append(_set(roles, item))
            if found[-1][1] != 0.0:
                _note_bare(settings.bare_in_rig, roles, item)
        except UserError as error:
            mistakes.add(
                rig_error(
                    settings.files,
                    ("plant", instance, "start"),
                    f"{name}: {error.message}",
                    value=error.value,
                    allowed=error.allowed,
                    hint=error.hint,
                )
            )
    for item, located in settings.start.get(instance, []):
        try:
            found.append(_set(roles, item))
            if found[-1][1] != 0.0:
                _note_bare(settings.bare, roles, item)
        except UserError as error:
            mistakes.add(located(error, item))
    mistakes.refuse(settings.files[0])
    if settings.is_settled:
        settings.known[key] = found


def _set(roles: Roles, item: Assignment) -> Start:
    """Set one start value, converted from the unit that its name ends in; return what was set."""
    slave = roles.slave
    # A variable may itself end in what looks like a unit; its own name wins
    whole = item.column.partition(".")[2]
    plain = replace(item, name=whole, unit="") if slave.has(whole) else item
    settable = [*slave.names("parameter"), *roles.spare_inputs()]
    if plain.name not in settable:
        known = "start value that can be set" if slave.has(plain.name) else "variable"
        raise _unknown(roles, plain, known, settable)
    variable = slave.variable(plain.name)
    value: float | bool | str = plain.value
    if variable.type == "Boolean":
        value = _flag(roles, plain)
    elif variable.type == "Enumeration" and not plain.value.lstrip("-").isdecimal():
        value = _word(roles, plain, variable)
    elif variable.type != "String":
        value = _number(roles, plain, variable)
    try:
        slave.set_start(plain.name, value)
    except PlantError as error:
        message = f"{slave.name} refuses {plain.name}: {error.reason}"
        raise UserError(message, value=item.value) from error
    return plain.name, value


def _unknown(roles: Roles, item: Assignment, known: str, settable: Sequence[str]) -> UserError:
    """Make the error of a name that cannot be set: names near it, with their units.

    known: what it is not.
    """
    name, unit = item.name, item.unit
    head = next((head for head in settable if name.startswith(f"{head}_")), "")
    if head and not unit and (suffixes := _suffixes(roles, head)):
        written = name.removeprefix(f"{head}_")
        allowed = [f"{head}_{suffix}" for suffix in suffixes]
        return UserError(f"{written} is no unit of {head}", value=name, allowed=allowed)
    near = Guess()
    for meant in nearest(name, settable):
        suffixes = _suffixes(roles, meant)
        fitting = [unit] if unit in suffixes else suffixes
        near += [f"{meant}_{suffix}" for suffix in fitting] or [meant]
    message = f"{roles.slave.name} has no such {known}"
    return UserError(message, value=f"{name}_{unit}" if unit else name, allowed=near or settable)


def _suffixes(roles: Roles, name: str) -> list[str]:
    """Return the units that the name of a start value may end in; none where it counts bare."""
    unit = _unit_of(roles, name)
    if unit is None:
        return []
    return scaled_suffixes(n for n, u in known_units().items() if u.exponents == unit.exponents)


def _unit_of(roles: Roles, name: str) -> Unit | None:
    """Return the unit of a variable, None where it has none that is defined."""
    named = unit_name(roles.slave.variable(name))
    unit = find_unit(roles.slave.description, named) if named else None
    return unit if unit is not None and unit.exponents else None


def _note_bare(bare: Bare, roles: Roles, item: Assignment) -> None:
    """Note a value whose column names no unit where it could have had one of several sizes."""
    head, _, whole = item.column.partition(".")
    if item.unit and not roles.slave.has(whole):
        return
    unit = _unit_of(roles, whole)
    if unit is not None and (suffixes := _suffixes(roles, whole)):
        bare[item.column] = unit.name, [f"{head}.{whole}_{end}" for end in suffixes]


def _flag(roles: Roles, item: Assignment) -> bool:
    if item.value.lower() not in _FLAGS or item.unit:
        raise UserError(
            f"{item.name} of {roles.slave.name} is true or false",
            value=item.value,
            allowed="true, false",
        )
    return _FLAGS[item.value.lower()]


def _word(roles: Roles, item: Assignment, variable: ModelVariable) -> int:
    """Return the number of an item of an enumeration."""
    declared = variable.declaredType
    words = {i.name: int(i.value) for i in declared.items} if declared is not None else {}
    if item.value not in words:
        raise UserError(
            f"{item.name} of {roles.slave.name} has no such item",
            value=item.value,
            allowed=nearest(item.value, words) or words or "whole numbers",
        )
    return words[item.value]


def _number(roles: Roles, item: Assignment, variable: ModelVariable) -> float:
    """Return the value in the FMU's unit, an int for an integer variable; check unit and range."""
    label = f"{item.name} of {roles.slave.name}"
    name = unit_name(variable) or "1"
    unit = find_unit(roles.slave.description, name) or Unit(name, ())
    value = _in_unit(label, item, unit) if unit.exponents else _in_own_unit(label, item, unit)
    low = -math.inf if variable.min is None else float(variable.min)
    high = math.inf if variable.max is None else float(variable.max)
    if not low <= value <= high:
        allowed = f"{low:g} .. {high:g} {'' if unit.name == '1' else unit.name}".rstrip()
        raise UserError(f"{label} is out of range", value=item.value, allowed=allowed)
    if str(variable.type) not in _REALS:
        if value != int(value):
            raise UserError(f"{label} is a whole number", value=item.value)
        return int(value)
    return value


def _in_own_unit(label: str, item: Assignment, unit: Unit) -> float:
    """Return a value for a variable whose unit the FMU names without defining it."""
    if item.unit:
        raise UserError(
            f"{label} is in {unit.name}, which the FMU does not define",
            value=item.unit,
            allowed="a bare number in that unit",
        )
    return item.si()


def _in_unit(label: str, item: Assignment, unit: Unit) -> float:
    """Convert a value to a unit. Raises UserError when that does not go, or would be a guess."""
    value = item.si()
    suffixes = suffixes_of(
        name for name, known in known_units().items() if known.exponents == unit.exponents
    )
    wanted = ", ".join(f"{item.name}_{suffix}" for suffix in suffixes)
    if item.unit and known_units()[si_unit(item.unit)].exponents != unit.exponents:
        allowed = "a bare number" if unit.name == "1" else f"a unit of {unit.name}"
        raise UserError(f"{label} has another unit", value=item.unit, allowed=allowed)
    if not item.unit and not unit.is_si:
        raise UserError(
            f"{label} is in {unit.name}; a number without unit would be a guess",
            value=item.value,
            allowed=wanted or None,
        )
    return unit.from_si(value) if item.unit else value
