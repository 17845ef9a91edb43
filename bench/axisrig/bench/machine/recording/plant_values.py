"""The parameters of FMUs that closed forms need, by `record/plant_values.csv`."""

import csv
from functools import cache
from importlib import resources

from axisrig.bench.record.axes import PlantRecord, PlantValue
from axisrig.kernel.cosim.fmi.slave import FmuSlave
from axisrig.kernel.cosim.fmi.units import find_unit, unit_name
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
    values = {}
    for name in value_names():
        for whole in dict.fromkeys((name + ending, name)):
            if plant.slave.has(whole):
                values[name] = _value(plant.slave, whole)
                break
    return PlantRecord(values, plant.kv_per_s or None)


def _value(slave: FmuSlave, name: str) -> PlantValue:
    value = slave.get(name)
    known = unit_name(slave.variable(name))
    unit = find_unit(slave.description, known) if known else None
    if unit is None:
        return PlantValue(value)
    kg, m, s, ampere, kelvin, mol, cd, rad = unit.exponents
    return PlantValue(unit.to_si(value), (kg, m, s, ampere, kelvin, mol, cd, rad))
