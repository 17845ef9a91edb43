"""What a drive has, as its EDS says it: checked before anything is sent.

canopen reads the EDS; here its dictionary is asked for types, and a mapping or a write that the
drive cannot take is a `UserError` before the machine runs.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from canopen.objectdictionary import ObjectDictionary, ODVariable, datatypes, import_od

from axisrig.kernel.drives.functions import Functions
from axisrig.kernel.drives.mapping import Telegram
from axisrig.kernel.drives.sdo import object_name
from axisrig.kernel.errors import UserError


def read_eds(path: str, node_id: int) -> ObjectDictionary:
    """Read an EDS or DCF file. Raises UserError when it cannot be read."""
    if not Path(path).is_file():
        raise UserError("the EDS is no file", file=path)
    try:
        found: ObjectDictionary = import_od(path, node_id)
    except Exception as error:
        # canopen lets through whatever its parser meets: missing keys, numbers that are none
        raise UserError(f"the EDS cannot be read: {error}", file=path) from error
    return found


def variable(od: ObjectDictionary, index: int, sub: int) -> ODVariable | None:
    """Return the variable of an object, None when the dictionary has none there."""
    found = od.get_variable(index, sub)
    # canopen gives a plain variable for any sub-index
    return found if isinstance(found, ODVariable) and found.subindex == sub else None


def encode(od: ObjectDictionary, index: int, sub: int, value: int) -> bytes:
    """Return `value` as the object's type wants it.

    Raises UserError for an object that the drive does not have or cannot write, and for a value
    outside its type.
    """
    found = variable(od, index, sub)
    if found is None:
        raise UserError("the drive has no such object", value=object_name(index, sub))
    if not found.writable:
        raise UserError("the drive does not let the object be written", value=_named(found))
    if found.data_type not in (*datatypes.INTEGER_TYPES, datatypes.BOOLEAN):
        raise UserError("only whole numbers can be written at start-up", value=_named(found))
    try:
        data: bytes = found.encode_raw(value)
    except Exception as error:
        raise UserError(
            f"the value does not fit {_named(found)}", value=value, allowed=f"{len(found)} bits"
        ) from error
    return data


def allowed_values(found: ODVariable) -> range:
    """Return the values from LowLimit to HighLimit of a whole number, else those of its type."""
    low = -(1 << len(found) - 1) if is_signed(found) else 0
    high = low + (1 << len(found)) - 1
    return range(
        low if found.min is None else found.min, (high if found.max is None else found.max) + 1
    )


def is_signed(found: ODVariable) -> bool:
    """Return whether a variable has a sign."""
    return found.data_type in datatypes.SIGNED_TYPES


def _named(found: ODVariable) -> str:
    return f"{object_name(found.index, found.subindex)} {found.name}"


def check_mapping(od: ObjectDictionary, telegrams: Iterable[Telegram]) -> None:
    """Check every telegram against the dictionary; raises UserError for the first that differs."""
    for telegram in telegrams:
        index = telegram.communication_index
        for place in ((index, 1), (index, 2), (index + 0x200, 0)):
            if variable(od, *place) is None:
                raise UserError(f"the drive has no {telegram.name}", value=object_name(*place))
        for mapped in telegram.objects:
            _check_object(od, telegram, mapped)


def _check_object(od: ObjectDictionary, telegram: Telegram, mapped: Any) -> None:
    found = variable(od, mapped.index, mapped.sub)
    if found is None:
        raise UserError(
            f"{telegram.name} maps an object that the drive does not have",
            value=object_name(mapped.index, mapped.sub),
        )
    if not found.pdo_mappable:
        raise UserError(
            f"{telegram.name} maps an object that no PDO may carry", value=_named(found)
        )
    if not (found.writable if telegram.is_received else found.readable):
        way = "an RPDO" if telegram.is_received else "a TPDO"
        raise UserError(f"{way} cannot carry this object: {found.access_type}", value=_named(found))
    if (len(found), is_signed(found)) != (mapped.bits, mapped.signed):
        raise UserError(
            f"{telegram.name} maps {_named(found)} with another type",
            value=_type(mapped.bits, mapped.signed),
            allowed=_type(len(found), is_signed(found)),
        )


def check_functions(
    axis: str,
    functions: Functions,
    od: ObjectDictionary,
    telegrams: Mapping[str, Telegram],
) -> None:
    """Check the drive functions of an axis against its drive; raises UserError."""
    sent = {
        (mapped.index, mapped.sub): mapped
        for telegram in telegrams.values()
        for mapped in telegram.objects
        if telegram.is_received
    }
    for function in functions.values():
        place = (function.index, function.sub)
        found = variable(od, *place)
        title = f"drive function {function.key} of axis {axis}"
        if found is None:
            raise UserError(f"{title}: the drive has no such object", value=object_name(*place))
        if not found.writable:
            raise UserError(f"{title}: the drive does not let it be written", value=_named(found))
        if (len(found), is_signed(found)) != (function.bits, function.is_signed):
            raise UserError(
                f"{title}: {_named(found)} has another data type",
                value=function.data_type,
                allowed=_type(len(found), is_signed(found)),
            )
        if variable(od, function.read_index, function.read_sub) is None:
            raise UserError(
                f"{title}: the drive has no such object to read",
                value=object_name(function.read_index, function.read_sub),
            )
        if function.communication == "CYCLIC" and (place not in sent or sent[place].field):
            raise UserError(
                f"{title} is CYCLIC and no RPDO carries its object freely",
                value=object_name(*place),
                allowed="objects of RPDOs without a field in the mapping table",
                hint="map it in the table of pdo_map, or use ACYCLIC",
            )


def _type(bits: int, signed: bool) -> str:
    return f"{bits} bits {'signed' if signed else 'unsigned'}"
