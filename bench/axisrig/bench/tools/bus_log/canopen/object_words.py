"""Values of objects in words: bits, commands, states, modes, positions, entries of mappings.

`object_bits.csv` has the bits and modes: a row holds where `value & mask` is its value. Sources:
CiA 301 (1001, mappings), CiA 402-2 (6040, 6041, 6060, 60B8, 60B9, 60FD).
"""

import csv
from fractions import Fraction
from functools import cache
from importlib import resources

from canopen.objectdictionary import ObjectDictionary, ODVariable

from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.bench.drive.cia402.functions.transitions import command_of
from axisrig.kernel.drives.canopen.dictionary import is_signed, variable
from axisrig.kernel.drives.cia402.objects import object_name
from axisrig.kernel.drives.cia402.words import find_state
from axisrig.kernel.errors import printable
from axisrig.kernel.profiles.canopen.emergency import Emergency

CONTROLWORD, STATUSWORD, ERROR_CODE = 0x6040, 0x6041, 0x603F
_NUMBERS = (0x6060, 0x6061)
"""Objects of the table that are numbers, not words of bits."""

_POSITION = "position unit"
_MAPPINGS = (range(0x1600, 0x1800), range(0x1A00, 0x1C00))


@cache
def _bits() -> dict[int, list[tuple[int, int, str]]]:
    text = resources.files(__package__).joinpath("object_bits.csv").read_text(encoding="utf-8")
    found: dict[int, list[tuple[int, int, str]]] = {}
    for row in csv.DictReader(text.splitlines()):
        item = (int(row["mask"], 0), int(row["value"], 0), row["words"])
        found.setdefault(int(row["index"], 16), []).append(item)
    return found


def bits_words(index: int, value: int) -> str:
    """Say what the value of an object means beside its number, "" where the tables have nothing.

    A controlword is taken alone: whether bit 7 has risen shows in the frame before.
    """
    words = [words for mask, part, words in _bits().get(index, ()) if value & mask == part]
    if index == STATUSWORD:
        state = find_state(value)
        words.insert(0, state.name.lower().replace("_", " ") if state else "no state")
    elif index == CONTROLWORD:
        command = command_of(value, 0)
        if command is not None:
            words.insert(0, command.name.lower().replace("_", " "))
    elif index == ERROR_CODE:
        row = Emergency(value, 0, b"").row
        words = [row.meaning] if row else []
    return ", ".join(words)


def name_of(index: int, sub: int, od: ObjectDictionary | None = None) -> str:
    """Return the name of an object, its index where neither the drives here nor `od` have it."""
    row = variables().get((index, sub))
    if row is not None:
        return row.name
    found = variable(od, index, sub) if od is not None else None
    if od is None or found is None:
        return object_name(index, sub)
    whole = od[index]
    name = found.name if isinstance(whole, ODVariable) else f"{whole.name}, {found.name}"
    return printable(name)


def value_words(
    index: int, sub: int, bits: int, value: int, per_mm: Fraction | None, *, hexadecimal: bool
) -> str:
    """Say a value: number, and in brackets what it means. per_mm: position units, if known.

    hexadecimal: also where the tables have nothing, as SDO values are shown.
    """
    plain = value & ((1 << bits) - 1)
    digits = f"0x{plain:0{bits // 4}X}"
    if sub and any(index in mappings for mappings in _MAPPINGS):
        entry = f"{plain >> 16:04X}:{plain >> 8 & 0xFF:X}, {plain & 0xFF} bit"
        return f"{digits} ({entry if plain else 'nothing'})"
    words = bits_words(index, plain)
    if index in (ERROR_CODE, *_bits()) and index not in _NUMBERS:
        return f"{digits} ({words})" if words else digits
    row = variables().get((index, sub))
    if per_mm is not None and row is not None and row.unit == _POSITION:
        words = f"{float(value / per_mm):.6f} mm"
    more = "; ".join(part for part in (digits if hexadecimal else "", words) if part)
    return f"{value} ({more})" if more else str(value)


def number_of(index: int, sub: int, data: bytes, od: ObjectDictionary | None = None) -> int:
    """Return the number in the data of an SDO, signed where the object is."""
    row = variables().get((index, sub))
    has_sign = row is not None and row.type.startswith("I") and row.type[1:] == str(8 * len(data))
    found = variable(od, index, sub) if od is not None and row is None else None
    if found is not None:
        has_sign = is_signed(found) and len(found) == 8 * len(data)
    return int.from_bytes(data, "little", signed=has_sign)
