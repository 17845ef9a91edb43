"""The cyclic telegram of a drive: which objects its PDOs carry, and their codecs.

The table `pdo_map.csv` (or one of the same form that a rig names) is what the kernel writes into
the drive at start-up and what it packs and unpacks afterwards, so that both cannot differ.
"""

import csv
import re
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import resources
from pathlib import Path
from typing import Any, Final

from axisrig.kernel.drives.mapped import BitCodec, MappedObject
from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.profiles.canopen.identifiers import ID_MASK, PDO_BASE, RESTRICTED, SYNC_ID
from axisrig.kernel.time.clock import MS, TimeNs

_FORMAT = {(8, False): "B", (8, True): "b", (16, False): "H", (16, True): "h",
           (32, False): "I", (32, True): "i", (64, False): "Q", (64, True): "q"}  # fmt: skip
BITS_MAX: Final = 64  # of a PDO
LATCH, COUNTER, STAMP = "latch", "counter", "stamp"
FROM_LATCH_TO_COUNTER: Final = 0x60D5 - 0x60BA  # 60BA to 60BD, 60D5 to 60D8
FROM_LATCH_TO_STAMP: Final = 0x60D1 - 0x60BA  # 60BA to 60BD, 60D1 to 60D4
_FROM_LATCH: Final = {LATCH: 0, COUNTER: FROM_LATCH_TO_COUNTER, STAMP: FROM_LATCH_TO_STAMP}
NO_FIELD = ""
# What the link works with: field -> whether the kernel sends it. The first five must be mapped; of
# target (607A) and speed (60FF, the CNC closes the position loop) one is enough. The rest is what
# measuring and distance control need; an object without a field is for drive functions.
FIELDS: Final[Mapping[str, bool]] = {
    "controlword": True, "target": True, "speed": True, "statusword": False, "actual": False,
    "probe_function": True, "probe_status": False, "latch": False,
    "latch_count": False, "inputs": False, "second": False,
}  # fmt: skip
DUMMIES: Final = range(0x0001, 0x0008)  # objects that fill a place of an RPDO
# Fields that need not come with every SYNC
AT_THEIR_TIME: Final = ("inputs", "second")
OF_TOUCH_PROBE: Final = ("probe_function", "probe_status", "latch", "latch_count")
NEEDED: Final = ("controlword", "statusword", "actual")
TARGETS: Final = ("target", "speed")
COLUMNS: Final = (
    "pdo", "transmission", "inhibit_100us", "index", "sub", "bits", "signed", "field",
)  # fmt: skip
# A column that a table need not have: greatest time between two event-driven TPDOs, 0 = none
EVENT_TIMER: Final = "event_ms"
EVENT_DRIVEN: Final = (254, 255)
# A column that a table need not have: COB-ID of its own, 0 = of the pre-defined connection set
IDENTIFIER: Final = "cob_id"
_OPTIONAL: Final = (EVENT_TIMER, IDENTIFIER)
NOTE: Final = "note"  # a column of words for who reads the table
_PDO: Final = re.compile(r"[RT]PDO([1-9]\d{0,2})")
PDOS_MAX: Final = 512  # of each direction (CiA 301: 1400 to 15FF, 1800 to 19FF)


@dataclass(frozen=True)
class Telegram:
    """One PDO: name, transmission type, inhibit time (100 us) and what it carries.

    event_ms: event timer of an event-driven TPDO, 0 = none. identifier: of its own, 0 = that of the
    pre-defined connection set.
    """

    name: str
    transmission: int
    inhibit_100us: int
    objects: tuple[MappedObject, ...]
    event_ms: int = 0
    identifier: int = 0

    @property
    def is_received(self) -> bool:
        """Whether the drive receives it (RPDO)."""
        return self.name.startswith("R")

    @property
    def is_cyclic(self) -> bool:
        """Whether the PDO is sent or taken at every SYNC (CiA 301 transmission types 1 to 240)."""
        return 1 <= self.transmission <= 240

    def promised_ns(self, cycle_ns: TimeNs) -> TimeNs | None:
        """Return the longest time from one telegram to the next, None where nothing promises one.

        Type n is sent with every n-th SYNC; an event-driven TPDO promises a time only with its
        event timer (CiA 301 section 7.5.2.37, sub-index 5).
        """
        if self.is_cyclic:
            return self.transmission * cycle_ns
        return self.event_ms * MS or None

    @property
    def length(self) -> int:
        """Payload in bytes."""
        return -(-sum(o.bits for o in self.objects) // 8)

    @cached_property
    def codec(self) -> Any:
        """The codec of the payload: little endian, no padding (CiA 301); a `struct.Struct`."""
        formats = [_FORMAT.get((o.bits, o.signed)) for o in self.objects]
        if None in formats:
            return BitCodec(self.objects)
        return struct.Struct("<" + "".join(str(f) for f in formats))

    @property
    def communication_index(self) -> int:
        """Index of the communication parameter; the mapping is 0x200 after it."""
        return (0x1400 if self.is_received else 0x1800) + int(self.name[4:]) - 1

    def cob_id(self, node_id: int) -> int:
        """Return its own COB-ID, else that of the pre-defined connection set."""
        return self.identifier or PDO_BASE[self.name] + node_id


def telegrams(
    latch_object: int,
    table: str | None = None,
    *,
    counter: bool = False,
    inputs: bool = True,
    second: bool = False,
    speed: bool = False,
    probe: bool = True,
) -> dict[str, Telegram]:
    """Return the PDOs of a drive whose latch object in use is `latch_object` (0x60BA to 0x60BD).

    table: path of a mapping table; without one the kernel's own. counter, inputs, second: whether
    the kernel's own has the counter of the latch (60D5 to 60D8), the digital inputs (60FD) and the
    position of the second encoder (60E4:1). speed: of a table with set position and set speed
    (60FF), as the kernel's own is, the speed counts, else the position. probe: whether the kernel's
    own has the words of the touch probe and the latch.
    Read once for each content of the table, which may be another one for the next machine.
    Raises UserError, with file and line, for a table that is none.
    """
    choice = counter, inputs, second, speed, probe
    return _telegrams(latch_object, table, _text(table), *choice)


@cache
def _telegrams(
    latch_object: int,
    table: str | None,
    text: str,
    counter: bool,
    inputs: bool,
    second: bool,
    speed: bool,
    probe: bool,
) -> dict[str, Telegram]:
    grouped: dict[str, list[dict[str, str]]] = {}
    places: dict[str, int] = {}
    listed = _rows(table, text)
    has_both = {row["field"] for _, row in listed} >= set(TARGETS)
    for line, row in listed:
        is_left_out = (
            (row["index"] == COUNTER and not counter)
            or (row["field"] == "inputs" and not inputs)
            or (row["field"] == "second" and not second)
            or (row["field"] in OF_TOUCH_PROBE and not probe)
        )
        if table is None and is_left_out:
            continue
        if has_both and row["field"] == TARGETS[not speed]:
            continue
        grouped.setdefault(row["pdo"], []).append(row)
        places[row["pdo"]] = line
    found = {
        name: Telegram(
            name=name,
            transmission=int(rows[0]["transmission"], 0),
            inhibit_100us=int(rows[0]["inhibit_100us"], 0),
            objects=tuple(
                MappedObject(
                    index=_index(row["index"], latch_object),
                    sub=int(row["sub"], 0),
                    bits=int(row["bits"], 0),
                    signed=row["signed"] == "yes",
                    field=row["field"],
                )
                for row in rows
            ),
            event_ms=int(rows[0][EVENT_TIMER], 0),
            identifier=int(rows[0][IDENTIFIER], 0),
        )
        for name, rows in grouped.items()
    }
    _check_whole(found, places, table)
    return found


def _index(text: str, latch_object: int) -> int:
    from_latch = _FROM_LATCH.get(text)
    return int(text, 16) if from_latch is None else latch_object + from_latch


@cache
def _own_text() -> str:
    return resources.files(__package__).joinpath("pdo_map.csv").read_text(encoding="utf-8")


def _text(table: str | None) -> str:
    if table is None:
        return _own_text()
    try:
        return Path(table).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise UserError("the mapping table cannot be read", file=table) from error


def _rows(table: str | None, text: str) -> list[tuple[int, dict[str, str]]]:
    reader = csv.DictReader(text.splitlines())
    missing = [name for name in COLUMNS if name not in (reader.fieldnames or ())]
    if missing:
        raise UserError(
            "the mapping table lacks columns", file=table, line=1, value=" ".join(missing),
            allowed=" ".join(COLUMNS),
        )  # fmt: skip
    _check_columns(reader.fieldnames or (), table)
    rows = [
        (
            reader.line_num,
            {name: (row.get(name) or "").strip() for name in COLUMNS}
            | {name: (row.get(name) or "").strip() or "0" for name in _OPTIONAL},
        )
        for row in reader
    ]
    for line, row in rows:
        _check_row(row, table, line)
    _check_once(rows, table)
    return rows


def _check_columns(names: Sequence[str], table: str | None) -> None:
    """Raise UserError for a column that nothing reads, or one that is there twice."""
    known = (*COLUMNS, *_OPTIONAL, NOTE)
    named = [name for name in names if name]
    for place, name in enumerate(named):
        if name not in known:
            raise UserError(
                "the mapping table has a column that it does not know", file=table, line=1,
                value=name, allowed=nearest(name, known) or " ".join(known),
                hint=f"words of your own go into the column {NOTE}",
            )  # fmt: skip
        if name in named[:place]:
            raise UserError(
                "the mapping table has a column twice", file=table, line=1, value=name,
                allowed="each column once",
            )  # fmt: skip


def _check_row(row: Mapping[str, str], table: str | None, line: int) -> None:
    """Raise UserError for a cell that cannot be."""

    def wrong(column: str, allowed: str) -> UserError:
        return UserError(
            f"{column} of the mapping table cannot be that",
            file=table, line=line, value=row[column], allowed=allowed,
        )  # fmt: skip

    pdo = _PDO.fullmatch(row["pdo"])
    if pdo is None or int(pdo[1]) > PDOS_MAX:
        raise wrong("pdo", f"RPDO1 to RPDO{PDOS_MAX}, TPDO1 to TPDO{PDOS_MAX}")
    for column, low, high in (
        ("transmission", 0, 255), ("inhibit_100us", 0, 65535), ("sub", 0, 255), ("bits", 1, 64),
        (EVENT_TIMER, 0, 65535), (IDENTIFIER, 0, ID_MASK),
    ):  # fmt: skip
        try:
            fits = low <= int(row[column], 0) <= high
        except ValueError:
            fits = False
        if not fits:
            raise wrong(column, f"{low} .. {high}")
    if row["index"] not in _FROM_LATCH:
        try:
            int(row["index"], 16)
        except ValueError:
            raise wrong("index", "an index such as 0x6064, `latch`, `counter` or `stamp`") from None
    is_event = not row["pdo"].startswith("R") and int(row["transmission"], 0) in EVENT_DRIVEN
    if int(row[EVENT_TIMER], 0) and not is_event:
        raise wrong(EVENT_TIMER, "0, or a TPDO of type 254 or 255: its event timer, ms")
    _check_identifier(row, wrong)
    if row["signed"] not in ("yes", "no"):
        raise wrong("signed", "yes or no")
    if row["field"] not in (NO_FIELD, *FIELDS):
        raise wrong("field", f"{' '.join(FIELDS)}, or nothing")
    sends = FIELDS.get(row["field"])
    if sends is not None and sends is not row["pdo"].startswith("R"):
        raise wrong("pdo", f"{'an RPDO' if sends else 'a TPDO'} for {row['field']}")


def _check_identifier(row: Mapping[str, str], wrong: Callable[[str, str], UserError]) -> None:
    """Raise UserError for an identifier that no PDO may have, or that is missing."""
    identifier = int(row[IDENTIFIER], 0)
    if identifier and any(identifier in taken for taken in (*RESTRICTED, (SYNC_ID,))):
        raise wrong(IDENTIFIER, "an identifier that CiA 301 leaves to PDOs, such as 0x1C1")
    if not identifier and row["pdo"] not in PDO_BASE:
        raise wrong(
            IDENTIFIER,
            f"an identifier such as 0x1C1: the pre-defined set has none for {row['pdo']}",
        )


def _check_once(rows: Sequence[tuple[int, Mapping[str, str]]], table: str | None) -> None:
    """Raise UserError for an object that two places of RPDOs carry, since both would set it.

    Data types as dummy entries (CiA 301, 0001 to 0007) set nothing.
    """
    seen: dict[tuple[int, int], tuple[int, str]] = {}
    for line, row in rows:
        if not row["pdo"].startswith("R") or row["index"] in _FROM_LATCH:
            continue
        place = int(row["index"], 16), int(row["sub"], 0)
        first_line, first = seen.setdefault(place, (line, row["pdo"]))
        if first_line != line and place[0] not in DUMMIES:
            raise UserError(
                f"{row['pdo']} carries an object that {first} carries already in line {first_line}:"
                " the drive would get two values of it",
                file=table, line=line, value=f"0x{place[0]:04X}:{place[1]}",
                allowed="each object in one place of the RPDOs",
                hint=f"take it out of line {first_line} or of line {line}",
            )  # fmt: skip


def _check_whole(
    found: Mapping[str, Telegram], places: Mapping[str, int], table: str | None
) -> None:
    """Check length, fields and transmission of a whole table."""
    fields: dict[str, Telegram] = {}
    for telegram in found.values():
        bits = sum(o.bits for o in telegram.objects)
        if bits > BITS_MAX:
            raise UserError(
                f"{telegram.name} is longer than a PDO", file=table, line=places[telegram.name],
                value=f"{bits} bits", allowed=f"{BITS_MAX} bits",
            )  # fmt: skip
        for mapped in telegram.objects:
            if mapped.field in fields:
                raise UserError(
                    f"the field {mapped.field} is twice in the mapping table",
                    file=table, line=places[telegram.name],
                )  # fmt: skip
            if mapped.field:
                fields[mapped.field] = telegram
    for name in NEEDED:
        if name not in fields:
            raise UserError("the mapping table lacks a field", file=table, value=name)
    if not any(name in fields for name in TARGETS):
        raise UserError(
            "the mapping table lacks a field: a set position leaves the position loop to the drive,"
            " a set speed to the CNC; of both the mode of the drive decides",
            file=table, value=" ".join(TARGETS), allowed="one of them, or both",
        )  # fmt: skip
    for name, telegram in fields.items():
        if name in AT_THEIR_TIME:
            _check_own_time(name, telegram, table, places[telegram.name])
        elif telegram.transmission != 1:
            raise UserError(
                f"{telegram.name} carries {name} and must come with every SYNC",
                file=table, line=places[telegram.name], value=telegram.transmission, allowed="1",
            )  # fmt: skip


def _check_own_time(name: str, telegram: Telegram, table: str | None, line: int) -> None:
    """Raise UserError for what nobody sends by itself, or would not be a position."""
    if name != "second":
        return
    if not telegram.is_cyclic and telegram.transmission not in EVENT_DRIVEN:
        raise UserError(
            f"{telegram.name} carries second and must come by itself",
            file=table, line=line, value=telegram.transmission, allowed="1 .. 240, 254, 255",
        )  # fmt: skip
    (mapped,) = (mapped for mapped in telegram.objects if mapped.field == name)
    if (mapped.bits, mapped.signed) != (32, True):
        raise UserError(
            "the field second is a signed position of 32 bits", file=table, line=line,
            value=f"{mapped.bits} bits, signed {'yes' if mapped.signed else 'no'}",
        )  # fmt: skip
