"""What a drive has, as its EDS says it: checked before anything is sent.

canopen reads the EDS; here its dictionary is asked for types, and a mapping or a write that the
drive cannot take is a `UserError` before the machine runs.
"""

import io
from collections.abc import Iterable, Mapping
from copy import copy
from pathlib import Path
from typing import Any

from canopen.objectdictionary import ObjectDictionary, ODArray, ODVariable, datatypes
from canopen.objectdictionary.eds import import_eds

from axisrig.kernel.drives.canopen.eds_file import Note, read_eds_file
from axisrig.kernel.drives.canopen.eds_text import EdsText, canonical
from axisrig.kernel.drives.canopen.mapping import Telegram
from axisrig.kernel.drives.cia402.objects import object_name
from axisrig.kernel.drives.functions import Functions
from axisrig.kernel.errors import UserError, near_files
from axisrig.kernel.profiles.canopen.identifiers import MAPPING_OF_PDO


def read_eds(path: str, node_id: int) -> ObjectDictionary:
    """Read an EDS or DCF file for a node number, which the result has as its own.

    Raises UserError when it cannot be read.
    """
    if not Path(path).is_file():
        raise UserError("the EDS is no file", file=path, hint=near_files(Path(), path))
    text = canonical(read_eds_file(path))
    try:
        found: ObjectDictionary = import_eds(  # type: ignore[no-untyped-call]
            io.StringIO(text.text), node_id
        )
    except Exception as error:
        # canopen lets through whatever its parser meets
        raise UserError(f"the EDS cannot be read: {error}", file=path) from error
    _complete_arrays(found, text)
    found.node_id = node_id  # canopen keeps it only where the file is a DCF
    return found


def eds_notes(path: str) -> list[Note]:
    """Return what `read_eds` mends in a file. Raises UserError when it cannot be read."""
    file = read_eds_file(path)
    canonical(file)
    return file.notes


def _complete_arrays(od: ObjectDictionary, text: EdsText) -> None:
    """Give arrays that the EDS has in the short form (CompactSubObj) all their members."""
    for index, count in text.compact.items():
        array = od[index]
        assert isinstance(array, ODArray)
        name = array[1].name  # the file may give the first member one of its own
        for sub in range(1, min(count, 254) + 1):
            if sub not in array.subindices:
                member = copy(array[1])
                member.subindex, member.name = sub, f"{name} {sub}"
                array.add_member(member)
            array[sub].name = text.names.get((index, sub), array[sub].name)


def variable(od: ObjectDictionary, index: int, sub: int) -> ODVariable | None:
    """Return the variable of an object, None when the dictionary has none there."""
    found = od.get_variable(index, sub)
    # canopen gives a plain variable for any sub-index, and makes members of arrays up
    if not isinstance(found, ODVariable) or found.subindex != sub:
        return None
    whole = od[index]
    return None if isinstance(whole, ODArray) and sub not in whole.subindices else found


def encode(
    od: ObjectDictionary, index: int, sub: int, value: int, *, minds_limits: bool = True
) -> bytes:
    """Return `value` as the object's type wants it.

    minds_limits: also LowLimit and HighLimit of the EDS count.
    Raises UserError for an object that the drive does not have or cannot write, and for a value
    outside its type or limits.
    """
    found = variable(od, index, sub)
    if found is None:
        raise UserError(
            "the drive has no such object", value=object_name(index, sub), allowed=_subs(od, index)
        )
    if not found.writable:
        raise UserError("the drive does not let the object be written", value=_named(found))
    if found.data_type not in (*datatypes.INTEGER_TYPES, datatypes.BOOLEAN):
        raise UserError("only whole numbers can be written at start-up", value=_named(found))
    bits = len(found)
    try:
        data = value.to_bytes(-(-bits // 8), "little", signed=is_signed(found))
    except OverflowError as error:
        raise UserError(
            f"the value does not fit {_named(found)}", value=value, allowed=f"{bits} bits"
        ) from error
    values = allowed_values(found)
    if minds_limits and value not in values:
        raise UserError(
            f"{_named(found)} does not take the value by the EDS",
            value=value,
            allowed=f"{values[0]} to {values[-1]}",
        )
    return data


def _subs(od: ObjectDictionary, index: int) -> str | None:
    """Say which sub-indices an array or a record has."""
    found = od.get(index)
    if found is None or isinstance(found, ODVariable):
        return None
    return f"sub-index {', '.join(str(sub) for sub in found)}"


def allowed_values(found: ODVariable) -> range:
    """Return the values of a whole number: from LowLimit to HighLimit, else those of its type.

    Limits that allow nothing but one value are place holders of EDS editors and say nothing.
    """
    bits = 1 if found.data_type == datatypes.BOOLEAN else len(found)
    low = -(1 << bits - 1) if is_signed(found) else 0
    high = low + (1 << bits) - 1
    if found.min is not None and found.max is not None and found.min >= found.max:
        return range(low, high + 1)
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
        for place in ((index, 1), (index, 2), (index + MAPPING_OF_PDO, 0)):
            if variable(od, *place) is None:
                raise UserError(f"the drive has no {telegram.name}", value=object_name(*place))
        check_objects(od, telegram)


def check_objects(od: ObjectDictionary, telegram: Telegram) -> None:
    """Check what a telegram carries; raises UserError for the first object that differs."""
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
