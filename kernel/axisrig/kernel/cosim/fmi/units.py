"""Units of FMU variables: what the FMU says about them, and the way to SI and back.

An FMU defines a unit by the exponents of its base units, a factor and an offset:
SI = factor * value + offset (FMI 3.0, 2.4.4; FMI 2.0.4, 2.2.2). Display units say how a tool shows
a value; they are not looked at. A unit that the FMU names without defining it is looked up in
`units.csv`.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources

from fmpy.model_description import ModelDescription, ModelVariable

from axisrig.kernel.errors import UserError, nearest

_BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
Exponents = tuple[int, ...]


@dataclass(frozen=True)
class Unit:
    """A unit: SI = factor * value + offset; exponents of kg, m, s, A, K, mol, cd, rad."""

    name: str
    exponents: Exponents
    factor: float = 1.0
    offset: float = 0.0

    def to_si(self, value: float) -> float:
        """Convert a value of this unit to SI."""
        return self.factor * value + self.offset

    def from_si(self, value: float) -> float:
        """Convert a value in SI to this unit."""
        return (value - self.offset) / self.factor

    @property
    def is_si(self) -> bool:
        """Whether numbers in this unit are numbers in SI."""
        return self.factor == 1.0 and self.offset == 0.0


@cache
def known_units() -> Mapping[str, Unit]:
    """Read `units.csv`: the units that may be written where an FMU defines none."""
    text = resources.files(__package__).joinpath("units.csv").read_text(encoding="utf-8")
    rows = csv.DictReader(text.splitlines())
    return {
        row["unit"]: Unit(
            row["unit"], tuple(int(row.get(base) or 0) for base in _BASES), float(row["factor"])
        )
        for row in rows
    }


def unit_name(variable: ModelVariable) -> str | None:
    """Return the unit that the FMU gives a variable, its own or that of its type."""
    declared = variable.declaredType
    name = variable.unit or (declared.unit if declared is not None else None)
    return str(name) if name else None


def find_unit(description: ModelDescription, name: str) -> Unit | None:
    """Return the unit `name` as the FMU defines it, else as `units.csv` does, else None."""
    for defined in description.unitDefinitions:
        base = defined.baseUnit
        if defined.name == name and base is not None:
            exponents = tuple(int(getattr(base, b) or 0) for b in _BASES)
            return Unit(name, exponents, float(base.factor), float(base.offset))
    return known_units().get(name)


def unit_of(
    description: ModelDescription, variable: ModelVariable, written: str | None = None
) -> Unit | None:
    """Return the unit of a variable; None when neither the FMU nor `written` names one.

    written: the unit that the user writes. Raises UserError for a unit that nobody defines, and for
    one that is not the FMU's.
    """
    own = unit_name(variable)
    units = {name: find_unit(description, name) for name in (own, written) if name}
    for name, unit in units.items():
        if unit is None and (name == written or written is None):
            raise UserError(
                f"{variable.name}: the unit is not given"
                if name == own
                else f"{variable.name}: unknown unit",
                value=name,
                allowed=nearest(name, known_units()) or known_units(),
                hint='say it in the map: { variable = "...", unit = "..." }'
                if not written
                else None,
            )
    first, second = units.get(own or ""), units.get(written or "")
    if (
        first
        and second
        and (first.exponents, first.factor, first.offset)
        != (
            second.exponents,
            second.factor,
            second.offset,
        )
    ):
        raise UserError(
            f"{variable.name}: the FMU says {own}", value=written, allowed=f"{own}, or no unit"
        )
    return second or first
