"""The parameters of FMUs that closed forms need, by `record/plant_values.csv`."""

import csv
from collections.abc import Sequence
from functools import cache
from importlib import resources
from weakref import WeakKeyDictionary

from axisrig.bench.record.axes import PlantRecord, PlantValue
from axisrig.kernel.cosim.fmi.slave import Exchange, FmuSlave
from axisrig.kernel.cosim.fmi.units import Unit, find_unit, unit_name
from axisrig.kernel.cosim.plant.axis import PlantAxis


@cache
def value_names() -> tuple[str, ...]:
    """Read the names of `plant_values.csv`."""
    folder = resources.files("axisrig.bench.record")
    text = folder.joinpath("plant_values.csv").read_text(encoding="utf-8")
    return tuple(row["name"] for row in csv.DictReader(text.splitlines()))


def plant_record(plant: PlantAxis) -> PlantRecord:
    """Return what closed forms need of the FMU of an axis.

    An FMU of two axes (`position_1`, `position_2`) names what belongs to one with the same ending.
    """
    bound = plant.roles.bound.get("position")
    variable = bound.variable if bound is not None else ""
    ending = variable.removeprefix("position") if "position_" in variable else ""
    slave, values = plant.slave, {}
    of_slave = _FOUND.setdefault(slave, {})
    found = of_slave.get(ending)
    if found is None:
        found = of_slave[ending] = _find(slave, ending)
    given = _read(slave, [whole for whole, _ in found.values()])
    for name, (whole, unit) in found.items():
        value = given[whole]
        if unit is None:
            values[name] = PlantValue(value)
        else:
            kg, m, s, ampere, kelvin, mol, cd, rad = unit.exponents
            values[name] = PlantValue(unit.to_si(value), (kg, m, s, ampere, kelvin, mol, cd, rad))
    return PlantRecord(values, plant.kv_per_s or None)


# Instance -> ending of the names of an axis -> name -> variable with its unit
_FOUND: "WeakKeyDictionary[FmuSlave, dict[str, dict[str, tuple[str, Unit | None]]]]" = (
    WeakKeyDictionary()
)


def _read(slave: FmuSlave, names: Sequence[str]) -> dict[str, float]:
    """Read variables now, in the units of the FMU: those of one type at once."""
    of_types: dict[str, list[str]] = {}
    for name in names:
        of_types.setdefault(str(slave.variable(name).type), []).append(name)
    values: dict[str, float] = {}
    for of_type in of_types.values():
        if any(slave.variable(name).shape for name in of_type):
            values |= {name: slave.get(name) for name in of_type}
            continue
        exchange = Exchange(slave, of_type)
        exchange.read()
        values |= zip(of_type, map(float, exchange.values), strict=True)
    return values


def _find(slave: FmuSlave, ending: str) -> dict[str, tuple[str, Unit | None]]:
    """Return the variables of an FMU that have values for closed forms, with their units."""
    found = {}
    for name in value_names():
        for whole in dict.fromkeys((name + ending, name)):
            if slave.has(whole):
                known = unit_name(slave.variable(whole))
                unit = find_unit(slave.description, known) if known else None
                found[name] = (whole, unit)
                break
    return found
