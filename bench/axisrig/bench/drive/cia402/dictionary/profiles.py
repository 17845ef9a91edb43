"""Named sets of drive habits: `profiles.csv`, one row for each key of a rig's `[drive.D]`.

The names that end in `-like` are models made from public documents (docs/touch-probe.md), not the
products of these vendors. An empty cell means: as `generic`.
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from importlib import resources

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.errors import UserError

DEFAULT_PROFILE = "generic"
_KEY_COLUMNS = ("key", "field", "type", "low", "high", "unit", "meaning")
_WORDS = {"yes": True, "no": False, "true": True, "false": False, "1": True, "0": False}
Value = bool | int | float | str


@dataclass(frozen=True)
class Habit:
    """A row of `profiles.csv`.

    key: of the rig. field: of `DriveProfile`. type: whole, number, flag, text, or words that
    are allowed (`a|b`). low, high: limits of a number. values: what each profile says.
    """

    key: str
    field: str
    type: str
    low: float | None
    high: float | None
    unit: str
    meaning: str
    values: Mapping[str, Value]

    @property
    def words(self) -> tuple[str, ...]:
        """What a word may be; empty for the other types."""
        return tuple(self.type.split("|")) if "|" in self.type else ()

    def in_profile(self, value: Value) -> Value:
        """Return a value of the rig in the unit of the profile: us become ns, mm become um."""
        if self.field.endswith(("_ns", "_um")):
            return round(float(value) * 1000)
        return value


@cache
def habits() -> Mapping[str, Habit]:
    """Read the table; by key, in its order."""
    text = resources.files(__package__).joinpath("profiles.csv").read_text(encoding="utf-8")
    return {row["key"]: _habit(row) for row in csv.DictReader(text.splitlines())}


def _habit(row: dict[str, str]) -> Habit:
    names = [name for name in row if name not in _KEY_COLUMNS]
    return Habit(
        row["key"],
        row["field"],
        row["type"],
        float(row["low"]) if row["low"] else None,
        float(row["high"]) if row["high"] else None,
        row["unit"],
        row["meaning"],
        {name: _value(row["type"], row[name] or row[DEFAULT_PROFILE]) for name in names},
    )


def _value(kind: str, text: str) -> Value:
    if kind == "whole":
        return int(text)
    if kind == "number":
        return float(text)
    return _WORDS[text] if kind == "flag" else text


def value_of(key: str, text: str) -> Value:
    """Read the cell of a plan for a key of a rig's drive; a text that fits nothing stays one."""
    habit = habits().get(key)
    if habit is not None and habit.type in ("text", "flag"):
        return _WORDS.get(text.lower(), text) if habit.type == "flag" else text
    for read in (int, float):
        try:
            return read(text)
        except ValueError:
            continue
    return _WORDS.get(text.lower(), text) if habit is None else text


@cache
def profile_names() -> tuple[str, ...]:
    """Return the names of all profiles in the order of the table."""
    return tuple(next(iter(habits().values())).values)


def profile_keys(name: str) -> dict[str, Value]:
    """Return what a profile says for every key of a rig; KeyError for an unknown name."""
    return {key: habit.values[name] for key, habit in habits().items()}


def make_profile(values: Mapping[str, Value]) -> DriveProfile:
    """Make the profile of a drive from values by the keys of a rig.

    Raises UserError for a value that cannot be.
    """
    known = habits()
    return DriveProfile(
        **{known[key].field: known[key].in_profile(value) for key, value in values.items()}  # type: ignore[arg-type]
    )


def in_lengths(profile: DriveProfile, unit_um: float) -> DriveProfile:
    """Return the profile with positions on the bus in a length, so that 6092 is the lead.

    Raises UserError when the lead is no whole number of units.
    """
    units = profile.lead_um / Fraction(str(unit_um))
    if units.denominator != 1:
        raise UserError(
            "position_unit_um: the lead is no whole number of position units (6092)",
            value=unit_um,
            allowed=f"a length that lead_mm = {profile.lead_um / 1000:g} is a multiple of",
        )
    return replace(profile, position_factor=units / profile.encoder_increments)


def named_profile(name: str) -> DriveProfile:
    """Return the drive profile of this name; KeyError when there is none."""
    return make_profile(profile_keys(name))


def profile_listing(name: str | None) -> str:
    """Show every profile with what is not as in `generic`, or every key of one with its meaning.

    Raises UserError for an unknown name.
    """
    if name is None:
        usual = profile_keys(DEFAULT_PROFILE)
        lines = []
        for other in profile_names():
            own = {k: v for k, v in profile_keys(other).items() if v != usual[k]}
            lines.append(f"{other:<20}{', '.join(f'{k} = {v}' for k, v in own.items())}".rstrip())
        return "\n".join(lines)
    if name not in profile_names():
        raise UserError("no such drive profile", value=name, allowed=profile_names())
    usual = profile_keys(DEFAULT_PROFILE)
    lines = [f"{name}; * = not as in {DEFAULT_PROFILE}, with what that has in brackets"]
    for key, value in profile_keys(name).items():
        mark, unit = " " if value == usual[key] else "*", habits()[key].unit
        other = "" if value == usual[key] else f"  ({_shown(usual[key])})"
        lines.append(f"{mark} {key} = {_shown(value)}{f' {unit}' if unit else ''}{other}")
        lines.append(f"      {habits()[key].meaning}")
    return "\n".join(lines)


def _shown(value: Value) -> str:
    return '""' if value == "" else str(value)
