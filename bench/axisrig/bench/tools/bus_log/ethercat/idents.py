"""AT, MDT and service channel of a drive with idents (SoE) in words."""

from collections.abc import Mapping
from typing import Final

from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.profiles.sercos import words
from axisrig.kernel.profiles.sercos.service import (
    ERROR_CODE,
    HEADER,
    Element,
    Header,
    Operation,
    ident_name,
    ident_number,
    soe_error_text,
)

POSITIONS: Final = frozenset(
    ident_number(f"S-0-0{number:03}") for number in (47, 51, 53, 130, 131, 132, 133, 189)
)
"""What counts position units."""
_READY: Final = ("not ready", "logic ready", "power ready", "operates")
_CONTROL: Final = {
    words.ON: "on",
    words.ENABLE: "enable",
    words.RUN: "run",
    words.REAL_TIME[0]: "real-time 1",
    words.REAL_TIME[1]: "real-time 2",
}
_STATUS: Final = {
    words.C1D: "class 1 error",
    words.C2D_CHANGED: "class 2 changed",
    words.C3D_CHANGED: "class 3 changed",
    words.REAL_TIME[0]: "real-time 1",
    words.REAL_TIME[1]: "real-time 2",
    words.COMMAND_CHANGED: "command changed",
    words.FOLLOWS: "follows",
}
_ASKS: Final = {
    Operation.READ: "read",
    Operation.READ_ANSWER: "answer",
    Operation.WRITE: "write",
    Operation.WRITE_ANSWER: "written",
    Operation.NOTIFICATION: "notification",
    Operation.EMERGENCY: "emergency",
}


def carried_words(carried: MappedObject, number: int, per_mm: float) -> str:
    """Say a value of an AT or an MDT."""
    name = ident_name(carried.index)
    if carried.index == words.CONTROL_WORD:
        return f"{name} 0x{number:04X} {_bits(number, _CONTROL)}".rstrip()
    if carried.index == words.STATUS_WORD:
        ready = _READY[number >> words.READY_SHIFT & words.READY_MASK]
        return f"{name} 0x{number:04X} {', '.join(filter(None, (ready, _bits(number, _STATUS))))}"
    return f"{name} {number}{_in_mm(carried.index, number, per_mm)}"


def message_words(body: bytes) -> tuple[str, set[str]]:
    """Say a message of the service channel, and what `--only` may ask for.

    Raises ValueError for bytes that are none.
    """
    head = Header.read(body)
    data = body[HEADER.size :]
    what = _ASKS[head.operation]
    if head.fragments:
        return f"SoE {what}, {len(data)} bytes, {head.fragments} more parts", {"soe"}
    name = ident_name(head.ident)
    text = f"SoE {what} {name} {_elements(head.elements)}".rstrip()
    if head.is_error:
        code = ERROR_CODE.unpack_from(data)[0] if len(data) >= ERROR_CODE.size else 0
        text += f": {soe_error_text(code)}"
    elif data:
        text += f" = {_value(head, data)}"
    if head.drive:
        text += f" (drive {head.drive})"
    return text, {"soe", name.lower()}


def _bits(word: int, names: Mapping[int, str]) -> str:
    return ", ".join(name for mask, name in names.items() if word & mask)


def _in_mm(ident: int, number: int, per_mm: float) -> str:
    return f" ({number / per_mm:.6f} mm)" if ident in POSITIONS else ""


def _elements(elements: Element) -> str:
    """Name the elements; the value alone needs no word."""
    if elements == Element.VALUE:
        return ""
    return "+".join(str(each.name).lower().replace("_", " ") for each in Element if each & elements)


def _value(head: Header, data: bytes) -> str:
    """Say what a message carries: a number where it is one, else its bytes."""
    known = words.telegram_idents().get(head.ident)
    is_number = head.elements in (Element.VALUE, Element.DATA_STATE) and len(data) in (2, 4)
    if not is_number:
        return data.hex(" ")
    number = int.from_bytes(data, "little", signed=known is not None and known.is_signed)
    if head.ident in words.REAL_TIME_BITS and number:
        return ident_name(number)
    return str(number)
