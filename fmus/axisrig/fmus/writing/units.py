"""Unit expressions of Modelica as products of SI base units, which FMI asks for.

Source: Modelica language specification 3.6, chapter 19 (unit expressions); SI brochure, 9th
edition.
"""

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

UNITS_FILE = Path(__file__).parent / "units.csv"
BASE: tuple[str, ...] = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
# SI prefixes as powers of ten.
PREFIXES: Mapping[str, int] = {
    "Y": 24, "Z": 21, "E": 18, "P": 15, "T": 12, "G": 9, "M": 6, "k": 3, "h": 2, "da": 1,
    "d": -1, "c": -2, "m": -3, "u": -6, "n": -9, "p": -12, "f": -15, "a": -18, "z": -21, "y": -24,
}  # fmt: skip
_FACTOR = re.compile(r"(?P<symbol>1|%|[A-Za-z]+)(?P<power>[+-]?\d+)?")


class UnitError(Exception):
    """A text that is no unit known here."""


@dataclass(frozen=True)
class Unit:
    """A unit: value in SI base units = factor*value + offset.

    exponents: of the base units, in the order of `BASE`.
    """

    factor: float
    offset: float
    exponents: tuple[int, ...]


@dataclass(frozen=True)
class _Symbol:
    unit: Unit
    takes_prefix: bool


@cache
def _symbols() -> dict[str, _Symbol]:
    with UNITS_FILE.open(encoding="utf-8", newline="") as file:
        return {
            row["symbol"]: _Symbol(
                Unit(
                    float(row["factor"]),
                    float(row["offset"]),
                    tuple(int(row[name]) for name in BASE),
                ),
                row["prefix"] == "1",
            )
            for row in csv.DictReader(file)
        }


def read_unit(text: str) -> Unit:
    """Read a unit expression such as `kg.m2`, `N/(m.s)` or `mm`.

    Raises UnitError for a symbol that `units.csv` does not hold and for anything else that is no
    unit expression.
    """
    above, *below = re.split(r"/(?![^(]*\))", text.strip())
    powers = _product(above)
    for part in below:
        powers += [(unit, ten, -power) for unit, ten, power in _product(part)]
    if len(powers) == 1 and powers[0][0].offset and powers[0][2] == 1:
        return powers[0][0]
    factor, tens, exponents = 1.0, 0, [0] * len(BASE)
    for unit, ten, power in powers:
        factor *= unit.factor**power
        tens += ten * power
        exponents = [e + power * x for e, x in zip(exponents, unit.exponents, strict=True)]
    return Unit(_scaled(factor, tens), 0.0, tuple(exponents))


def _scaled(factor: float, tens: int) -> float:
    """factor * 10**tens, rounded once for the usual exact cases."""
    return factor * 10.0**tens if tens >= 0 else factor / 10.0**-tens


def _product(text: str) -> list[tuple[Unit, int, int]]:
    """Unit, power of ten of its prefix, and exponent of each factor."""
    inner = text.strip()
    if inner.startswith("(") and inner.endswith(")"):
        inner = inner[1:-1]
    factors = []
    for word in inner.split("."):
        found = _FACTOR.fullmatch(word.strip())
        if found is None:
            raise UnitError(text)
        unit, ten = _named(found["symbol"])
        factors.append((unit, ten, int(found["power"] or 1)))
    return factors


def _named(symbol: str) -> tuple[Unit, int]:
    """The unit of a symbol and the power of ten of its prefix."""
    symbols = _symbols()
    if symbol in symbols:
        unit = symbols[symbol].unit
        # The gram is the only unit whose base has a prefix: keep the factors whole numbers.
        return (unit, 0) if symbol != "g" else (_gram(unit), -3)
    for length in (2, 1):
        prefix, rest = symbol[:length], symbol[length:]
        if prefix in PREFIXES and rest in symbols and symbols[rest].takes_prefix:
            unit, ten = symbols[rest].unit, PREFIXES[prefix]
            return (unit, ten) if rest != "g" else (_gram(unit), ten - 3)
    raise UnitError(symbol)


def _gram(unit: Unit) -> Unit:
    return Unit(1.0, 0.0, unit.exponents)
