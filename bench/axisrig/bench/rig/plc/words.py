"""What the PLC side of a rig does in a run: the language of the columns `plc:`.

A cell holds actions separated by semicolons, each a value and keys:

    plc:Z.torque_limit = 100 at=M50; 50000 at=M51     when the program has M50, and M51
    plc:Z.6065 = 0xFFFFFFFF at=run; 1048575 at=run_end+20ms
    plc:feedhold = at=400ms for=300ms                 0.4 s after the start of the program
    plc:override = 50 at=motion+20ms over=100ms       feed of the path, in percent
    plc:reset = at=M50+20ms
    plc:program_start = at=reset+100ms file=second.nc
    plc:Z.dist_ctrl = ON set_pos=30 at=M50; OFF at=M51
    plc:V.E.READY = 0; 1 at=M50+20ms nth=2            20 ms after the second M50

Objects, moments, what acts on the channel and on one axis are in `objects.csv`, `moments.csv`,
`channel_columns.csv` and `axis_columns.csv`; times have their unit.
"""

import csv
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources

from axisrig.bench.plan.assignment import Assignment, number
from axisrig.bench.rig.plc.axis_words import AxisAction, axis_columns, find_column, read_action
from axisrig.bench.rig.plc.channel_words import (
    ACT_ONCE,
    ChannelAction,
    channel_columns,
    read_channel_action,
)
from axisrig.bench.rig.reading.faults import read_time
from axisrig.bench.rig.reading.plc_task import PLAIN_TASK_KEYS
from axisrig.kernel.drives.functions import type_range
from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.nc.decoder.topics.technology import INTERNAL, NUMBER_MAX, SPINDLE
from axisrig.kernel.time.clock import TimeNs

VARIABLE = "V.E."
PLAIN_KEYS = ("start_ms", "optional_stop", "limit_s", "after_end_ms")
"""Keys with one value: what the operator does (`bench/axisrig/bench/rig/settings.py`)."""
_NTH_MAX = 999
_AT = re.compile(r"(?P<word>.+?)(?:\+(?P<time>[\d.]+[a-z]+))?")
_FUNCTION = re.compile(r"([MHT])(\d{1,9})")
_OBJECT = re.compile(r"(?:0[xX])?([0-9A-Fa-f]{4})(?::0)?")


@dataclass(frozen=True)
class DriveObject:
    """One row of `objects.csv`: an object of a drive that the PLC side may write.

    type: UNS16 or UNS32. unit: of its values, which are those of the drive.
    """

    name: str
    index: int
    type: str
    unit: str
    meaning: str


@dataclass(frozen=True)
class Moment:
    """When an action begins: word of `moments.csv`, value that a V.E. gets, time after it."""

    word: str
    value: float | None = None
    offset_ns: TimeNs = 0

    def fits(self, word: str, value: float | None) -> bool:
        """Return whether this is the moment; value: what a variable got."""
        return word == self.word and (self.value is None or self.value == value)


@dataclass(frozen=True)
class ObjectWrite:
    """An object of the drive of an axis gets a value, in the drive's own unit."""

    axis: str
    object: DriveObject
    value: int


@dataclass(frozen=True)
class VariableWrite:
    """A V.E. variable gets a value; name: after `V.E.`."""

    name: str
    value: float


@dataclass(frozen=True)
class Rule:
    """One action with its moment; nth: which one of it, None = every one.

    column, text: where and how it is written. until: what ends a feedhold without a time.
    """

    column: str
    text: str
    moment: Moment
    nth: int | None
    action: ObjectWrite | VariableWrite | ChannelAction | AxisAction
    until: Moment | None = None


def _rows(name: str) -> list[dict[str, str]]:
    text = resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


@cache
def plc_objects() -> dict[str, DriveObject]:
    """Read `objects.csv`, by name."""
    return {
        row["name"]: DriveObject(
            row["name"], int(row["object"], 16), row["type"], row["unit"], row["meaning"]
        )
        for row in _rows("objects.csv")
    }


@cache
def plc_moments() -> dict[str, str]:
    """Read `moments.csv`: moment -> meaning."""
    return {row["moment"]: row["meaning"] for row in _rows("moments.csv")}


def read_rules(item: Assignment, axes: Collection[str]) -> tuple[float | None, list[Rule]]:
    """Read a cell of `plc:<column>`, `plc:V.E.<NAME>` or `plc:<axis>.<object>`.

    Returns the first value of a variable (None for the others) and the rules. Raises UserError
    for a column or a cell that cannot be.
    """
    parts = [part.strip() for part in item.value.split(";")]
    if "" in parts:
        raise UserError("an action is missing between the semicolons", value=item.value)
    if item.name.startswith(VARIABLE):
        if item.name == VARIABLE:
            raise UserError("the external variable has no name", value=item.name)
        if "=" in parts[0]:
            raise UserError(
                "an external variable has a first value", value=parts[0], allowed="0; 1 at=M50+20ms"
            )
        first = number(item.column, parts[0])
        return first, [_rule(item, part, axes, needs_at=True) for part in parts[1:]]
    if item.name not in channel_columns():
        _target_of(item.name, axes)
    return None, [_rule(item, part, axes) for part in parts]


def needs_variables(rules: Sequence[Rule], column: str, external: Collection[str]) -> None:
    """Refuse a moment that cannot come: a V.E. variable that the run does not have."""
    known = {name.upper() for name in external}
    for rule in rules:
        moments = [rule.moment, *([rule.until] if rule.until else [])]
        for word in [moment.word for moment in moments if rule.column == column]:
            name = word.removeprefix(VARIABLE)
            if name != word and name not in known:
                raise UserError(
                    "at: the run has no such variable",
                    value=word,
                    allowed=[f"{VARIABLE}{other}" for other in external] or "none",
                    hint=f"plc:{word}=0 gives it its first value",
                )


def _rule(item: Assignment, text: str, axes: Collection[str], *, needs_at: bool = False) -> Rule:
    values = [word for word in text.split() if not re.match(r"\w+=", word)]
    keys = dict(word.split("=", 1) for word in text.split() if word not in values)
    for key in keys:
        if key not in _keys(item):
            raise UserError(f"plc:{item.name} has no such key", value=key, allowed=_keys(item))
    if len(keys) + len(values) < len(text.split()):
        raise UserError("a key is given twice", value=text)
    if needs_at and "at" not in keys:
        raise UserError("a further value needs its moment", value=text, allowed="1 at=M50+20ms")
    moment = _moment(keys.get("at", "start"))
    until = _moment(keys["until"], "until") if "until" in keys else None
    action = _action(item, values, keys, axes)
    nth = _nth(keys, moment) or (1 if item.name in ACT_ONCE else None)
    return Rule(item.column, text, moment, nth, action, until)


def _keys(item: Assignment) -> Sequence[str]:
    """Return the keys that an action of this column may have."""
    if item.name in channel_columns():
        return channel_columns()[item.name].keys
    column = find_column(item.name.partition(".")[2])
    is_plain = column is None or item.name.startswith(VARIABLE)
    return ("at", "nth") if is_plain or column is None else column.keys


def _action(
    item: Assignment, values: Sequence[str], keys: dict[str, str], axes: Collection[str]
) -> ObjectWrite | VariableWrite | ChannelAction | AxisAction:
    name = item.name
    if name in channel_columns():
        return read_channel_action(name, item.column, values, keys)
    target = None if name.startswith(VARIABLE) else _target_of(name, axes)
    if target is not None and not isinstance(target[1], DriveObject):
        return read_action(target[0], target[1], item.column, values, keys)
    if len(values) != 1:
        raise UserError(
            "one value and its keys", value=" ".join(values) or item.value, allowed="100 at=M50"
        )
    if target is None:
        return VariableWrite(name.removeprefix(VARIABLE), number(item.column, values[0]))
    axis, found = target
    assert isinstance(found, DriveObject)
    return ObjectWrite(axis, found, _value(found, values[0]))


def _target_of(column: str, axes: Collection[str]) -> tuple[str, DriveObject | str]:
    """Take `Z.torque_limit`, `Z.6072` or `Z.dist_ctrl` apart; the last stays a name."""
    axis, dot, name = column.partition(".")
    if not dot:
        forms = [*PLAIN_KEYS, *PLAIN_TASK_KEYS, *channel_columns(), "V.E.<NAME>", "<axis>.<object>"]
        forms += [f"<axis>.{name}" for name in axis_columns()]
        raise UserError("the PLC side has no such key", value=column, allowed=forms)
    if axis not in axes:
        raise UserError("the rig has no such axis", value=axis, allowed=axes)
    if find_column(name) is not None:
        return axis, name
    known = plc_objects()
    if name in known:
        return axis, known[name]
    match = _OBJECT.fullmatch(name)
    for row in known.values():
        if match is not None and int(match[1], 16) == row.index:
            return axis, row
    raise UserError(
        "the PLC side writes no such object",
        value=name,
        allowed=nearest(name, [*known, *axis_columns()])
        or [*(f"{o.name} ({o.index:04X})" for o in known.values()), *axis_columns()],
    )


def _value(target: DriveObject, text: str) -> int:
    low, high = type_range(target.type)
    try:
        value = int(text, 0) if text.isascii() and "_" not in text else None
    except ValueError:
        value = None
    if value is None or not low <= value <= high:
        allowed = f"a whole number from {low} to {high}, {target.unit}"
        raise UserError(f"{target.name}: not a value of it", value=text, allowed=allowed)
    return value


def _nth(keys: dict[str, str], moment: Moment) -> int | None:
    text = keys.get("nth")
    if text is None:
        return None
    highest = 1 if moment.word == "start" else _NTH_MAX
    if not (text.isascii() and text.isdecimal() and 1 <= int(text[:9]) <= highest):
        allowed = f"1 to {highest}" if highest > 1 else "1: it comes once"
        raise UserError("nth: which one of the moment", value=text, allowed=allowed)
    return int(text)


def _moment(text: str, key: str = "at") -> Moment:
    try:
        return Moment("start", None, read_time(text))
    except ValueError:
        pass
    match = _AT.fullmatch(text)
    word = match["word"] if match else ""
    try:
        offset_ns = read_time(match["time"]) if match and match["time"] else 0
    except ValueError:
        word, offset_ns = "", 0
    if word.isidentifier() and word in plc_moments():
        return Moment(word, None, offset_ns)
    if word.upper().startswith(VARIABLE) and len(word) > len(VARIABLE):
        name, equals, value = word.partition("=")
        if name[len(VARIABLE) :]:
            return Moment(name.upper(), number(key, value) if equals else None, offset_ns)
    function = _FUNCTION.fullmatch(word.upper())
    if function is None:
        raise UserError(
            f"{key}: no moment of a run",
            value=text,
            allowed="a time after the start of the program with its unit (400ms), "
            + ", ".join(plc_moments())
            + ", or one of them and a time: M50+20ms",
        )
    return Moment(_function_code(function[1], int(function[2]), text), None, offset_ns)


def _function_code(letter: str, code: int, text: str) -> str:
    """Return a function as the program has it; refuse those that no PLC side receives."""
    word = f"{letter}{code}"
    if word in (*INTERNAL, *SPINDLE) or (letter != "T" and code > NUMBER_MAX):
        raise UserError(
            "at: the PLC side never receives this function",
            value=text,
            allowed=f"M and H from 0 to {NUMBER_MAX} without {' '.join((*INTERNAL, *SPINDLE))}",
        )
    return word
