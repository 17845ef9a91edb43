"""Profiles of SERCOS drives (`profiles.csv`): where two drives differ that say the same words.

They are models made from public documents, not the products of any maker.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from importlib import resources
from typing import Final, Literal

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.sercos.service import ident_number

LINEAR, ROTARY = 0x09, 0x0A
"""S-0-0076: by the parameters S-0-0077 and 78, or S-0-0079; without them it is preferred."""
KIND_MASK: Final = 0x07
BY_PARAMETER: Final = 0x08
PREFERRED_LINEAR_M: Final = Fraction(1, 10**7)
PREFERRED_ROTARY: Final = 3_600_000
NAMES: Final = ("one_probe", "two_probes")


@dataclass(frozen=True)
class SercosProfile:
    """One drive. drive: its axis, inputs and encoder.

    scaling, resolution, linear_factor, linear_exponent: of positions at power on, S-0-0076 to 79.
    select: bits of S-0-0169. status_bits, control_bits: idents that real-time bits take, None =
    any. The other fields are those of the table.
    """

    drive: DriveProfile
    product: int
    probes: int
    select: int
    status_bits: frozenset[int] | None
    control_bits: frozenset[int] | None
    needs_input: bool
    locks_control: bool
    locks_select: bool
    scaling: int = ROTARY
    resolution: int = 1 << 20
    linear_factor: int = 1
    linear_exponent: int = -7


@cache
def rows() -> Mapping[str, Mapping[str, str]]:
    """Return the table by key."""
    text = resources.files(__package__).joinpath("profiles.csv").read_text(encoding="utf-8")
    return {row["key"]: row for row in csv.DictReader(text.splitlines())}


def value_of(name: str, key: str) -> str:
    """Return what a profile has for a key."""
    return rows()[key][name]


def make_profile(
    name: str, drive: DriveProfile, kind: Literal["rotary", "linear"], resolution: int
) -> SercosProfile:
    """Make a drive. resolution: increments of its positions per turn, where they are rotary."""

    def idents(key: str) -> frozenset[int] | None:
        words = value_of(name, key).split()
        if words == ["any"]:
            return None
        return frozenset(ident_number(f"S-0-{int(word):04}") for word in words)

    def is_so(key: str) -> bool:
        return value_of(name, key) == "yes"

    return SercosProfile(
        drive,
        int(value_of(name, "product")),
        int(value_of(name, "probes")),
        int(value_of(name, "select"), 0),
        idents("status_bits"),
        idents("control_bits"),
        is_so("needs_input"),
        is_so("locks_control"),
        is_so("locks_select"),
        LINEAR if kind == "linear" else ROTARY,
        resolution,
    )


def units_per_turn(
    kind: int, factor: int, exponent: int, resolution: int, lead_um: int
) -> Fraction | None:
    """Return position units per turn of the motor by S-0-0076 to 79, None where they say none."""
    by_parameter = bool(kind & BY_PARAMETER)
    if kind & KIND_MASK == LINEAR & KIND_MASK:
        unit_m = factor * Fraction(10) ** exponent if by_parameter else PREFERRED_LINEAR_M
        return Fraction(lead_um, 10**6) / unit_m
    if kind & KIND_MASK == ROTARY & KIND_MASK:
        return Fraction(resolution if by_parameter else PREFERRED_ROTARY)
    return None
