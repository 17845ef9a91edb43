"""Units of the manuals and what they are for people and inside the kernel."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Final

UNITS_PER_MM: Final = 10_000
"""Lengths of lists, of `probing_position` and of positions in the kernel's interface: 0.1 um."""


@dataclass(frozen=True)
class Unit:
    """One row of `units.csv`.

    kernel: the unit of a linear axis inside, of which `divisor` of `name` make one. rotary,
    rotary_kernel: the same two for a rotary axis; the divisor is the same.
    """

    name: str
    kernel: str
    divisor: int
    rotary: str
    rotary_kernel: str

    def of(self, *, is_rotary: bool) -> str:
        """Return the manuals' unit for an axis."""
        return self.rotary if is_rotary else self.name

    def converted(self, value: float, *, is_rotary: bool = False) -> str:
        """Write a value of the manuals in the unit of people: 12345 of 0.1 um is `1.2345 mm`."""
        unit = self.rotary_kernel if is_rotary else self.kernel
        return f"{value / self.divisor:.10g} {unit}"


def _read() -> Mapping[str, Unit]:
    text = resources.files(__package__).joinpath("units.csv").read_text(encoding="utf-8")
    return {
        row["unit"]: Unit(
            row["unit"], row["kernel"], int(row["divisor"]), row["rotary"], row["rotary_kernel"]
        )
        for row in csv.DictReader(text.splitlines())
    }


UNITS = _read()
