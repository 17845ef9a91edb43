"""The language of faults: what a column may contain: `fault:<kind>`, read from its tables.

A cell holds faults separated by semicolons. Each is one or more targets and keys:

    Z.TPDO1                        from the start to the end, every frame
    Z.TPDO1 X.TPDO1 p=0.02         both, two frames in a hundred
    Z.TPDO2 at=1.2s count=5        five frames from 1.2 s after the start of the program
    Z.RPDO1 at=motion+3ms for=10ms from 3 ms after the axis moves, for 10 ms

Kinds, keys and moments: `faults.csv`, `fault_keys.csv` and `fault_moments.csv` of `bench.bus`.
"""

import csv
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from typing import Any

from axisrig.bench.rig.reading.fault_targets import (
    AXIS_TELEGRAMS,
    BUS_TELEGRAMS,
    TERMINAL,
    TERMINAL_TELEGRAMS,
    is_target,
    place_of,
    targets,
)
from axisrig.bench.rig.reading.file import RigFile
from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.time.clock import MS, US, S, TimeNs

_UNITS_NS = {"ns": 1, "us": US, "ms": MS, "s": S}
_TIME = re.compile(r"(\d+(?:\.\d*)?|\.\d+)(ns|us|ms|s)")


@dataclass(frozen=True)
class FaultKind:
    """One row of `faults.csv`: the kind, its room, its targets and its keys.

    room: where it acts. targets: telegram, axis, bus, line, slave, signal, sensor, plc,
    terminal, input.
    defaults: of keys that have one of their own in this kind, as it would do nothing without.
    """

    name: str
    room: str
    targets: tuple[str, ...]
    keys: tuple[str, ...]
    defaults: Mapping[str, str]
    meaning: str


@dataclass(frozen=True)
class FaultKey:
    """One row of `fault_keys.csv`."""

    name: str
    type: str
    default: str
    allowed: str
    meaning: str


@dataclass(frozen=True)
class Moment:
    """When a fault begins: an offset from one of `fault_moments.csv`."""

    name: str
    offset_ns: TimeNs


@dataclass(frozen=True)
class Fault:
    """One fault of one target.

    axis, segment: one of them is set, none where the target is neither. telegram: of AXIS_TELEGRAMS
    or BUS_TELEGRAMS, empty for a kind that is not about one. values: every key of the kind, None
    where it has no value; times in ns, `at` a `Moment`.
    """

    kind: str
    target: str
    axis: str
    segment: str
    telegram: str
    values: Mapping[str, Any] = field(default_factory=dict)


_REACTIONS = ("axisrig.bench.bus.can", "axisrig.bench.bus.ethercat", "axisrig.bench.bus.cyclic")
"""Where the tables of reactions are, `fault_reactions.csv`: those of a carrier."""


def _rows(name: str, package: str = "axisrig.bench.bus.can") -> list[dict[str, str]]:
    text = resources.files(package).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


@cache
def fault_kinds() -> Mapping[str, FaultKind]:
    """Read `faults.csv`, keyed by kind."""
    return {
        row["kind"]: FaultKind(
            row["kind"],
            row["room"],
            tuple(word for word in row["target"].split() if word != "or"),
            tuple(word.partition("=")[0] for word in row["keys"].split()),
            dict(word.split("=") for word in row["keys"].split() if "=" in word),
            row["meaning"],
        )
        for row in _rows("faults.csv")
    }


@cache
def fault_keys() -> Mapping[str, FaultKey]:
    """Read `fault_keys.csv`, keyed by key."""
    return {row["key"]: FaultKey(*row.values()) for row in _rows("fault_keys.csv")}


@cache
def fault_moments() -> Mapping[str, str]:
    """Read `fault_moments.csv`: moment -> meaning."""
    return {row["moment"]: row["meaning"] for row in _rows("fault_moments.csv")}


def read_faults(kind: str, text: str, rig: RigFile) -> list[Fault]:
    """Read the cell of a column `fault:<kind>`.

    Raises UserError for an unknown kind, target, key, or a value that cannot be.
    """
    known = fault_kinds()
    if kind not in known:
        raise UserError(
            "unknown kind of fault", value=kind, allowed=nearest(kind, known) or list(known)
        )
    faults = []
    for part in text.split(";"):
        words = part.split()
        if not words:
            raise UserError("a fault is missing between the semicolons", value=text)
        named = [word for word in words if "=" not in word]
        if not named:
            allowed = targets(known[kind].targets, rig)
            raise UserError("a fault has no target", value=part, allowed=allowed)
        values = _read_values(known[kind], [word for word in words if "=" in word])
        faults += [_fault(known[kind], target, values, rig) for target in named]
    return faults


def misses_heartbeats(kind: str, axis: str, rig: RigFile) -> bool:
    """Whether a fault of a kind would lose heartbeats that the drive of an axis does not send."""
    table = rig.axis[axis]
    segment = rig.segment.get(table.segment)
    is_line = segment is not None and segment.is_line  # has no such faults at all
    return kind == "heartbeat_loss" and not is_line and not rig.drive[table.drive].shows_life


def needs_heartbeats(faults: list[Fault], rig: RigFile) -> None:
    """Refuse to lose heartbeats that nobody sends: such a fault does nothing.

    Raises UserError with the drive.
    """
    for fault in faults:
        if fault.axis and misses_heartbeats(fault.kind, fault.axis, rig):
            name = rig.axis[fault.axis].drive
            raise UserError(
                f"drive {name} sends no heartbeats that could be lost",
                value=fault.target,
                hint=f"drive:{name}.heartbeat_ms=20 lets it send them",
            )


def _fault(kind: FaultKind, target: str, values: Mapping[str, Any], rig: RigFile) -> Fault:
    allowed = targets(kind.targets, rig)
    if not is_target(target, kind.targets, rig):
        what = "no such telegram" if kind.targets == ("telegram",) else "no such place of a fault"
        place = target.partition(".")[0]
        same_place = [name for name in allowed if name.startswith(f"{place}.")]
        if not allowed:
            what = f"{what}: the rig has no {' and no '.join(kind.targets)}"
            raise UserError(what, value=target, hint=f"axisrig faults {kind.name}")
        raise UserError(what, value=target, allowed=same_place or allowed)
    return Fault(kind.name, target, *place_of(target, kind.targets, rig), values)


def _read_values(kind: FaultKind, words: list[str]) -> dict[str, Any]:
    written: dict[str, str] = {}
    for word in words:
        key, _, value = word.partition("=")
        if key not in kind.keys:
            raise UserError(
                f"a fault of kind {kind.name} has no such key", value=key, allowed=kind.keys
            )
        if key in written:
            raise UserError(f"the key {key} is given twice", value=word)
        written[key] = value
    values = {}
    for name in kind.keys:
        text = written.get(name, kind.defaults.get(name, fault_keys()[name].default))
        values[name] = _read_value(fault_keys()[name], text) if text or name in written else None
        if name in kind.defaults and not values[name]:
            raise UserError(
                f"{name}: a fault of kind {kind.name} does nothing like this",
                value=text,
                allowed=f"more than 0; {kind.defaults[name]} without it",
            )
    return values


def _read_value(key: FaultKey, text: str) -> Any:
    try:
        readers: dict[str, Callable[[str], Any]] = {
            "time": read_time,
            "number": _integer,
            "share": lambda word: float(_plain(word)),
            "real": lambda word: float(_plain(word)),
            "moment": _read_moment,
            "data": _read_data,
            "word": str,
        }
        value = readers[key.type](text)
    except (ValueError, KeyError):
        value = None
    if value is None or not _is_allowed(key, value):
        allowed = key.allowed
        if key.type == "moment":
            allowed = f"a time after the start of the program, {', '.join(fault_moments())}"
            allowed += ", or one of them and a time: motion+2ms"
        raise UserError(f"{key.name}: {_FORMS[key.type]}", value=text, allowed=allowed)
    return value


_FORMS = {
    "time": "not a time with its unit (ns, us, ms, s) in the range",
    "number": "not a whole number in the range",
    "share": "not a probability",
    "real": "not a number in the range",
    "moment": "no moment of a run",
    "data": "no data of a frame",
    "word": "unknown word",
}


def _plain(text: str) -> str:
    """Refuse what Python takes for part of a number and no engineer does."""
    if not text.isascii() or "_" in text or text != text.strip():
        raise ValueError(text)
    return text


def _is_allowed(key: FaultKey, value: Any) -> bool:
    """Whether a value is within the column `allowed`: `low to high`, or words."""
    low, is_range, high = key.allowed.partition(" to ")
    if key.type == "word":
        return str(value) in key.allowed.split()
    if not is_range or key.type == "data":
        return True
    numbers: dict[str, Callable[[str], float]] = {"time": read_time, "share": float, "real": float}
    number = numbers.get(key.type, _integer)
    return bool(number(low) <= value <= number(high))


def _integer(text: str) -> int:
    return int(_plain(text), 0)


def read_time(text: str) -> TimeNs:
    """Read a time with its unit, `300ms`; raises ValueError for anything else."""
    match = _TIME.fullmatch(_plain(text))
    if match is None:
        raise ValueError(text)
    whole, _, part = match[1].partition(".")
    unit = _UNITS_NS[match[2]]
    # In whole numbers: 1.2 ms are 1200000 ns, not 1199999.9999
    return int(whole or "0") * unit + int((part or "0").ljust(9, "0")[:9]) * unit // 10**9


def _read_moment(text: str) -> Moment:
    name, plus, offset = text.partition("+")
    if not plus and name not in fault_moments():
        return Moment("start", read_time(text))
    if name not in fault_moments():
        raise ValueError(text)
    return Moment(name, read_time(offset) if plus else 0)


def _read_data(text: str) -> str | bytes:
    if text in ("last", "random"):
        return text
    data = bytes.fromhex(text)
    if len(data) > 8:
        raise ValueError(text)
    return data


def faults_table(kind: str | None = None) -> str:
    """Describe kinds, keys and moments for the command line, or the reactions to one kind.

    Raises UserError for an unknown kind.
    """
    if kind is not None:
        return _reactions(kind)
    lines = [
        "A column fault:<kind> of a plan injects faults: targets, then keys; several with ;",
        "A key with a value has it by default in this kind.",
        "",
    ]
    for known in fault_kinds().values():
        keys = [f"{k}={known.defaults[k]}" if k in known.defaults else k for k in known.keys]
        lines.append(f"{known.name}  ({' or '.join(known.targets)})  {' '.join(keys)}")
        lines.append(f"    {known.meaning}")
    width = 2 + max(map(len, (*fault_keys(), *fault_moments())))
    lines += ["", "Keys"]
    for key in fault_keys().values():
        default = f", default {key.default}" if key.default else ""
        allowed = f" ({key.allowed}{default})" if key.allowed else ""
        lines.append(f"  {key.name:<{width}}{key.meaning}{allowed}")
    lines += ["", "Moments of at"]
    lines += [f"  {name:<{width}}{meaning}" for name, meaning in fault_moments().items()]
    lines += ["", "Telegrams: " + " ".join(f"AXIS.{name}" for name in AXIS_TELEGRAMS)]
    lines += ["           " + " ".join(f"BUS.{name}" for name in BUS_TELEGRAMS)]
    lines += ["           " + " ".join(f"{TERMINAL}.{name}" for name in TERMINAL_TELEGRAMS)]
    return "\n".join(lines)


def _reactions(kind: str) -> str:
    known = fault_kinds()
    if kind not in known:
        raise UserError(
            "unknown kind of fault", value=kind, allowed=nearest(kind, known) or list(known)
        )
    lines = [f"{kind}: {known[kind].meaning}"]
    for row in (row for package in _REACTIONS for row in _rows("fault_reactions.csv", package)):
        if row["kind"] == kind:
            lines += ["", f"fault:{kind} = {row['example']}"]
            lines += [f"  {name:<7} {row[name]}" for name in list(row)[2:]]
    return "\n".join(lines)
