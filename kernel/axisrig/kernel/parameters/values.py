"""The parameters of one axis or of the channel: what was set, and the tables for the rest.

The surface keeps the manuals' units, `mm`, `mm_s`, `mm_s2` and `ns` convert for the inside of the
kernel. For a rotary axis mm reads degrees: the divisors are the same.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.parameters.origin import Origin
from axisrig.kernel.parameters.table import KINDS, NUMBER, Kind, Parameter, indices_of, table
from axisrig.kernel.parameters.types import Value
from axisrig.kernel.parameters.units import UNITS
from axisrig.kernel.time.clock import US, TimeNs

ROTARY = ("ACHSTYP_ROTATOR", "ACHSTYP_SPINDEL", "2", "4", "0x0002", "0x0004")


@dataclass(frozen=True)
class Resolved:
    """An effective value: key is the path that decided it, origin where that was set.

    key is the path asked for where its own value or default counts; origin is None for a default.
    """

    value: Value
    key: str
    parameter: Parameter
    origin: Origin | None


@dataclass(frozen=True)
class Corrected:
    """A value out of its range that the control corrects (or only warns of)."""

    parameter: Parameter
    key: str
    alarm_id: int
    wrong: Value
    corrected: Value
    origin: Origin


class ParameterSet:
    """The parameters of one axis or of the channel: what was set, and the table for the rest."""

    def __init__(self, kind: Kind) -> None:
        self.kind = kind
        self._table = table(kind)
        self._values: dict[str, Value] = {}
        self._origins: dict[str, Origin] = {}
        self._written: dict[str, str] = {}
        self._corrected: dict[str, Corrected] = {}
        # What was resolved since the last setting: every run of a case asks for the same
        self._resolved: dict[str, Resolved] = {}

    def copied(self) -> "ParameterSet":
        """Return the same parameters, to be set further without changing these."""
        copy = ParameterSet(self.kind)
        copy._values, copy._origins = dict(self._values), dict(self._origins)
        copy._written, copy._corrected = dict(self._written), dict(self._corrected)
        copy._resolved = dict(self._resolved)
        return copy

    def set(self, path: str, text: str, origin: Origin | str) -> None:
        """Set one parameter from its written value; a later setting replaces an earlier one.

        path: as in a list, for instance `kenngr.measure.edge`. origin: where the text is.
        Raises UserError for an unknown path, a value of the wrong type or outside its range, and
        for a value that is known to the manuals but has no effect yet.
        """
        place = origin if isinstance(origin, Origin) else Origin(origin)
        parameter, key = self.find(path, place)
        value = parameter.convert(text, place)
        if not parameter.has_effect(indices_of(key), value):
            parameter.accept(text, place)
            message = f"{key} = {text} is known to the manuals, does not act yet"
            hint = "remove the cell; a list may hold it"
            raise place.error(message, allowed=parameter.acting, hint=hint)
        self._store(path, parameter, key, text, place)

    def load(self, path: str, text: str, origin: Origin) -> str:
        """Set one parameter as a list does, and return its present path.

        A list may hold what does not act yet, `inert` reports it. Raises UserError as `set` does
        for everything else.
        """
        parameter, key = self.find(path, origin)
        self._store(path, parameter, key, text, origin)
        return key

    def find(self, path: str, origin: Origin) -> tuple[Parameter, str]:
        """Find row and present path of what a user wrote.

        Raises UserError with the nearest names if there is none.
        """
        try:
            return self._table.find(path)
        except KeyError as error:
            raise self._unknown(path, origin) from error

    def _unknown(self, path: str, origin: Origin) -> UserError:
        row = self._table.row(path)
        if row is not None:
            limits = ", ".join(f"0 .. {limit}" for limit in row.index_max) or "a number"
            return origin.error(
                f"{row.label} has no such index", value=path, allowed=f"index {limits}"
            )
        others = [kind for kind in KINDS if kind != self.kind and table(kind).row(path)]
        close = nearest(path, self._table.paths())
        if others:
            hint = f"it is a parameter of {_LISTS[others[0]]}"
        elif NUMBER.fullmatch(path):
            hint = _numbered(path, self.kind)
        elif close:
            hint = "nearest names: " + ", ".join(close)
        else:
            hint = "no name is near it; `axisrig params WORD` finds names by what they mean"
        return origin.error(f"unknown {self.kind} parameter", value=path, hint=hint)

    def _store(self, path: str, parameter: Parameter, key: str, text: str, origin: Origin) -> None:
        value = parameter.convert(text, origin)
        self._corrected.pop(key, None)
        if not parameter.is_within(value):
            how, corrected = parameter.correction, parameter.corrected(value)
            if how is None or corrected is None:
                raise parameter.out_of_range(text, origin)
            has_index = "[" in path or "[" not in key
            alarm_id = how.alarm_id if has_index or how.older_id is None else how.older_id
            self._corrected[key] = Corrected(parameter, key, alarm_id, value, corrected, origin)
            value = corrected
        self._values[key], self._origins[key] = value, origin
        self._written[key] = path
        self._resolved.clear()

    def correct(self, path: str, value: Value) -> None:
        """Replace a value as the control does at start-up; the place of the setting stays."""
        _, key = self._table.find(path)
        self._values[key] = value
        self._resolved.clear()

    def corrected(self) -> list[Corrected]:
        """Return the settings that were out of range, in the order of their keys."""
        return [self._corrected[key] for key in sorted(self._corrected)]

    def is_written_as(self, beginning: str) -> bool:
        """Whether a list or the plan named any parameter so: older and present names differ."""
        return any(path.startswith(beginning) for path in self._written.values())

    def list_name(self, key: str) -> str:
        """Return how a list names what was set: the present path.

        Distance control keeps its older structure `kenngr.distc.`: it chooses the family of IDs.
        """
        written = self._written.get(key, key)
        return written if written.startswith("kenngr.distc.") else key

    def is_set(self, path: str) -> bool:
        """Whether a list or the plan set this parameter, be it to its default."""
        return self._table.find(path)[1] in self._values

    def origin(self, path: str) -> Origin | None:
        """Return where a parameter was set."""
        return self._origins.get(self._table.find(path)[1])

    @property
    def is_rotary(self) -> bool:
        """Whether the axis is a rotary one or a spindle (P-AXIS-00018)."""
        return self.kind == "axis" and self.get("kenngr.achs_typ") in ROTARY

    def resolve(self, path: str) -> Resolved:
        """Return the effective value in the manual's unit and what decided it.

        Raises KeyError for a path that the table does not hold.
        """
        found = self._resolved.get(path)
        if found is None:
            found = self._resolved[path] = self._resolve(path)
        return found

    def _resolve(self, path: str) -> Resolved:
        parameter, key = self._table.find(path)
        value = self._values.get(key, parameter.default)
        own = Resolved(value, key, parameter, self._origins.get(key))
        if not parameter.fallback or not parameter.is_unset(value):
            return own
        chosen = self._fallback(parameter, key)
        if parameter.otherwise is None:
            return chosen or own
        if chosen is None or parameter.is_unset(chosen.value):
            return Resolved(parameter.otherwise, key, parameter, None)
        return chosen

    def _fallback(self, parameter: Parameter, key: str) -> Resolved | None:
        """Return what the fallback of a parameter says, None if none of its switches is set."""
        indices = indices_of(key)
        numbers = []
        for other in parameter.fallback:
            if other.index is not None and other.index not in indices:
                continue
            path = other.path
            for index in indices:
                path = path.replace("[i]", f"[{index}]", 1)
            found = self.resolve(path)
            if other.word is None:
                numbers.append(found)
            elif found.value:
                return Resolved(other.word, found.key, found.parameter, found.origin)
        return min(numbers, key=lambda item: float(item.value), default=None)

    def get(self, path: str) -> Value:
        """Return the value in the manual's unit, resolved through the fallback chain.

        Raises KeyError for a path that the table does not hold.
        """
        return self.resolve(path).value

    def flag(self, path: str) -> bool:
        """Return a BOOL."""
        return bool(self._number(path))

    def integer(self, path: str) -> int:
        """Return a whole number in the manual's unit."""
        return int(self._number(path))

    def word(self, path: str) -> str:
        """Return a STRING."""
        return str(self.get(path))

    def mm(self, path: str) -> float:
        """Return a length in mm."""
        return self._converted(path, "mm")

    def mm_s(self, path: str) -> float:
        """Return a speed in mm/s."""
        return self._converted(path, "mm/s")

    def mm_s2(self, path: str) -> float:
        """Return an acceleration in mm/s²."""
        return self._converted(path, "mm/s2")

    def ns(self, path: str, cycle_ns: TimeNs | None = None) -> TimeNs:
        """Return a duration in nanoseconds.

        cycle_ns: period of the position control, for chains that end in a number of cycles.
        """
        found = self.resolve(path)
        unit = found.parameter.unit
        if unit == "us":
            return int(found.value) * US
        if unit == "cycles" and cycle_ns is not None:
            return int(found.value) * cycle_ns
        raise TypeError(f"{path} is given in {unit or 'no unit'}, which is no duration")

    def items(self) -> Iterator[tuple[str, Value]]:
        """Give path and value of everything that was set, in the order of the table.

        What has the same first index is together: one drive function after the other.
        """
        place = self._table.place
        yield from sorted(self._values.items(), key=lambda item: place(item[0]))

    def words(self) -> Iterator[str]:
        """Give every value that is a STRING and was set, in no order."""
        return (value for value in self._values.values() if isinstance(value, str))

    def inert(self) -> list[tuple[str, Value]]:
        """Return what was set, differs from its default, and does not act yet."""
        return [
            (key, value)
            for key, value in self.items()
            if not self._table.find(key)[0].has_effect(indices_of(key), value)
        ]

    def unasked(self) -> list[tuple[str, str]]:
        """Return what was set and is never asked, each with what decides by its default."""
        unset = [row for row in self._table.parameters if row.fallback and "[" not in row.path]
        return [
            (other.path, row.path)
            for row in unset
            if row.path not in self._values and not row.is_unset(row.default)
            for other in row.fallback
            if other.word is None and "[" not in other.path and self.is_set(other.path)
        ]

    def _number(self, path: str) -> float:
        value = self.get(path)
        if isinstance(value, str):
            raise TypeError(f"{path} is no number")
        return value

    def _converted(self, path: str, unit: str) -> float:
        """Convert to a unit of the kernel; one division, so that round values stay exact."""
        known = UNITS.get(self.resolve(path).parameter.unit)
        if known is None or known.kernel != unit:
            raise TypeError(f"{path} is not convertible to {unit}")
        return self._number(path) / known.divisor


def _numbered(number: str, asked: Kind) -> str:
    """Return the name that a number means."""
    for kind in (asked, *KINDS):
        row = table(kind).numbered(number)
        if row is not None:
            of = "" if kind == asked else f", a parameter of {_LISTS[kind]}"
            return f"it is the number of `{row.path}`{of}; lists and plans take the name"
    return "no parameter of this number is known; `axisrig params` lists them"


_LISTS = {
    "axis": "the axis",
    "channel": "the channel",
    "external": "the list of external variables",
    "startup": "the start-up list",
}
