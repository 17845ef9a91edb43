"""An EDS as the parser of canopen takes it: keywords, order and numbers as CiA 306-1 has them.

canopen 2.4.1 wants keywords in one spelling, objects before their sub-indices, every DummyUsage and
every comment that is counted; it leaves out silently what is no Python number.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final

from canopen.objectdictionary import datatypes

from axisrig.kernel.drives.canopen.eds_file import (
    EdsFile,
    Section,
    object_of,
    plain,
    table_of,
    whole_number,
)

VAR, DOMAIN, ARRAY, RECORD = 7, 2, 8, 9
COMMISSIONING: Final = "DeviceComissioning"  # CiA 306 spells it so
COMMISSIONING_NAMES: Final = (COMMISSIONING.lower(), "devicecommissioning")
_RATES: Final = (10, 20, 50, 125, 250, 500, 800, 1000)
_TEXTS: Final = ("VendorName", "ProductName", "OrderCode")
_NUMBERS: Final = (
    *(f"BaudRate_{rate}" for rate in _RATES), "VendorNumber", "ProductNumber", "RevisionNumber",
    "SimpleBootUpMaster", "SimpleBootUpSlave", "Granularity", "DynamicChannelsSupported",
    "GroupMessaging", "NrOfRXPDO", "NrOfTXPDO", "LSS_Supported",
)  # fmt: skip
_DUMMIES: Final = range(1, 8)
_ACCESS: Final = ("ro", "wo", "rw", "rwr", "rww", "const")
_VALUES: Final = ("LowLimit", "HighLimit", "DefaultValue", "ParameterValue")
_KEPT: Final = ("StorageLocation", "Factor", "Description", "Unit")
_LISTS: Final = ("MandatoryObjects", "OptionalObjects", "ManufacturerObjects")
_FIRST_OBJECT: Final = 0x1000
_NODE_ID: Final = re.compile(r"\+?\s*\$NODEID\s*\+?", re.IGNORECASE)
_DOMAIN_TYPE: Final = 0x0F
_OWN_TYPES: Final = 0x1B  # a higher DataType is a structure of the maker

Keys = list[tuple[str, object]]


@dataclass(frozen=True)
class EdsText:
    """text: what canopen reads. compact: number of members of each array in the short form.

    names: of members of such arrays, by index and sub-index. lines: of every object, for messages.
    """

    text: str
    compact: Mapping[int, int]
    names: Mapping[tuple[int, int], str] = field(default_factory=dict)


def canonical(file: EdsFile) -> EdsText:
    """Return the text for canopen; mends become notes of `file`. Raises UserError."""
    parts = [*_device(file)]
    objects, members = _objects(file)
    compact: dict[int, int] = {}
    for index, head in objects.items():
        if index >= _FIRST_OBJECT:
            parts += _object(file, index, head, members.get(index, {}), compact)
        else:
            parts += _structure(index, members.get(index, {}))
    _compare_lists(file, objects)
    parts = [part for part in parts if part]
    return EdsText("\n".join(parts) + "\n", compact, _names(file))


def _written(title: str, keys: Iterable[tuple[str, object]]) -> str:
    return "\n".join([f"[{title}]", *(f"{key}={value}" for key, value in keys), ""])


def _device(file: EdsFile) -> Iterator[str]:
    """Yield the sections that are no objects."""
    info = file.sections.get("fileinfo")
    if info is not None:
        names = ("FileName", "FileVersion", "FileRevision", "EDSVersion", "Description")
        yield _written("FileInfo", [(name, info.text(name)) for name in names if info.text(name)])
    yield _comments(file)
    device = file.sections.get("deviceinfo")
    if device is None:
        file.note("[DeviceInfo] is missing: no bit rates, no vendor")
        yield _written("DeviceInfo", ())
    else:
        keys: Keys = [(key, device.text(key)) for key in _TEXTS if device.text(key)]
        for key in _NUMBERS:
            number = whole_number(plain(device.text(key)))
            if number is not None:
                keys.append((key, number))
            elif key.lower() in device.entries:
                file.note("is no number and counts as missing", device, key)
        yield _written("DeviceInfo", keys)
    found = [file.sections[name] for name in COMMISSIONING_NAMES if name in file.sections]
    if found:
        rows = [(key, file.number(found[0], key)) for key in ("NodeID", "Baudrate")]
        yield _written(COMMISSIONING, [(key, value) for key, value in rows if value])
    dummies = file.sections.get("dummyusage")
    if dummies is not None:
        keys = [(key, file.number(dummies, key) or 0) for key in map(_dummy, _DUMMIES)]
        yield _written("DummyUsage", keys)


def _dummy(code: int) -> str:
    return f"Dummy{code:04d}"


def _comments(file: EdsFile) -> str:
    section = file.sections.get("comments")
    if section is None:
        return ""
    said = whole_number(plain(section.text("Lines")))
    numbers = sorted(
        int(key.removeprefix("line")) for key in section.entries if re.fullmatch(r"line\d+", key)
    )
    if said != len(numbers):
        file.note(f"does not fit the {len(numbers)} lines that are there", section, "Lines")
    texts = [section.text(f"Line{number}") for number in numbers]
    lines: Keys = [(f"Line{place}", text) for place, text in enumerate(texts, 1)]
    return _written("Comments", [("Lines", len(lines)), *lines])


def _objects(file: EdsFile) -> tuple[dict[int, Section], dict[int, dict[int, Section]]]:
    """Return the sections of objects and those of their members, each in the order of numbers."""
    heads: dict[int, Section] = {}
    members: dict[int, dict[int, Section]] = {}
    for section in file.sections.values():
        place = object_of(section.name)
        if place is None:
            continue
        index, sub = place
        group: dict[int, Section] = heads if sub is None else members.setdefault(index, {})
        number = index if sub is None else sub
        if number in group:
            text = f"is the same object as [{group[number].name}]"
            raise file.refused(text, section, "", "each object once")
        group[number] = section
    for index in members.keys() - heads.keys():
        for section in members[index].values():
            file.note("belongs to no object of the file and is left out", section)
    ordered = {index: heads[index] for index in sorted(heads)}
    return ordered, {i: dict(sorted(subs.items())) for i, subs in members.items()}


def _object(
    file: EdsFile,
    index: int,
    head: Section,
    members: Mapping[int, Section],
    compact: dict[int, int],
) -> Iterator[str]:
    title = f"{index:04X}"
    kind = _kind(file, head, members)
    keys: Keys = [("ParameterName", _name(file, head, title)), ("ObjectType", f"0x{kind:X}")]
    count = file.number(head, "CompactSubObj") or 0
    if kind in (VAR, DOMAIN):
        keys += _variable(file, head, is_domain=kind == DOMAIN)
        if members:
            file.note(f"is a variable, and its {len(members)} sub-indices are left out", head)
    elif kind == ARRAY and count:
        keys += [("CompactSubObj", count), *_variable(file, head, is_domain=False)]
        compact[index] = count
    yield _written(title, keys)
    if kind in (VAR, DOMAIN):
        return
    for sub, section in members.items():
        name = f"{title}sub{sub:X}"
        is_domain = file.number(section, "ObjectType") == DOMAIN
        rows = [("ParameterName", _name(file, section, name)), ("ObjectType", f"0x{VAR:X}")]
        yield _written(name, [*rows, *_variable(file, section, is_domain=is_domain)])


def _structure(index: int, members: Mapping[int, Section]) -> Iterator[str]:
    """Yield a structure of the maker: canopen wants the type that its sub-index 1 names."""
    section = members.get(1)
    number = whole_number(plain(section.text("DefaultValue"))) if section is not None else None
    if number is not None:
        yield _written(f"{index:X}sub1", [("DefaultValue", number)])


def _kind(file: EdsFile, head: Section, members: Mapping[int, Section]) -> int:
    found = file.number(head, "ObjectType")
    if found is not None:
        return found
    if members:
        file.note(
            "is missing; the object has sub-indices and is read as a record", head, "ObjectType"
        )
        return RECORD
    return VAR  # CiA 306-1: so where it is missing


def _name(file: EdsFile, section: Section, usual: str) -> str:
    name = section.text("ParameterName")
    if not name:
        file.note("is missing", section, "ParameterName")
    return name or f"Object {usual}"


def _variable(file: EdsFile, section: Section, *, is_domain: bool) -> Keys:
    """Return type, access, limits and values of a variable as canopen takes them."""
    data_type = file.number(section, "DataType")
    access = plain(section.text("AccessType")).lower()
    if is_domain:
        data_type, access = data_type or _DOMAIN_TYPE, access or "rw"
    if data_type is None:
        raise file.refused("is missing", section, "DataType", "number of a type of CiA 301")
    if access not in _ACCESS:
        text = "no access type" if access else "is missing"
        raise file.refused(text, section, "AccessType", ", ".join(_ACCESS))
    if data_type > _OWN_TYPES and not _has_structure(file, data_type):
        file.note(
            f"0x{data_type:X} is no type of CiA 301, nor of this file: read as bytes",
            section,
            "DataType",
        )
        data_type = _DOMAIN_TYPE
    keys: Keys = [("DataType", f"0x{data_type:X}"), ("AccessType", access)]
    keys.append(("PDOMapping", int(bool(file.number(section, "PDOMapping")))))
    for key in _VALUES:
        text = section.text(key)
        value = _value(text, data_type) if text else None
        if value is not None:
            keys.append((key, value))
        elif text:
            file.note("is no number and is left out", section, key)
    keys += [(key, section.text(key)) for key in _KEPT if section.text(key)]
    return keys


def _has_structure(file: EdsFile, data_type: int) -> bool:
    """Whether the file has the structure that a data type names (objects below 1000)."""
    section = next((s for s in file.sections.values() if object_of(s.name) == (data_type, 1)), None)
    return section is not None and whole_number(plain(section.text("DefaultValue"))) is not None


def _value(text: str, data_type: int) -> str | None:
    """Return a limit or value; None for what is no number where one is wanted."""
    if data_type not in (*datatypes.INTEGER_TYPES, datatypes.BOOLEAN):
        return text
    whole = plain(text)
    rest = _NODE_ID.sub("", whole) if "$" in whole else whole
    is_relative = rest != whole
    number = whole_number(rest) if rest else 0
    if number is None:
        return None
    bits = _BITS[data_type]
    if data_type in datatypes.SIGNED_TYPES and number >= 1 << bits - 1:
        number -= 1 << bits  # hexadecimal, as the value is on the bus
    return f"$NODEID+0x{number:X}" if is_relative else str(number)


_BITS: Final = {
    0x01: 1, 0x02: 8, 0x03: 16, 0x04: 32, 0x05: 8, 0x06: 16, 0x07: 32, 0x10: 24, 0x12: 40,
    0x13: 48, 0x14: 56, 0x15: 64, 0x16: 24, 0x18: 40, 0x19: 48, 0x1A: 56, 0x1B: 64,
}  # fmt: skip


def _names(file: EdsFile) -> dict[tuple[int, int], str]:
    """Return the names that the file gives members of short arrays."""
    found: dict[tuple[int, int], str] = {}
    for section in file.sections.values():
        table = table_of(section.name)
        if table is not None and table[1] == "Name":
            for key, entry in section.entries.items():
                if key.isdigit():
                    found[table[0], int(key)] = entry.value
    return found


def _compare_lists(file: EdsFile, objects: Mapping[int, Section]) -> None:
    """Note objects that a list of the file names and that have no section."""
    for name in _LISTS:
        section = file.sections.get(name.lower())
        for key, entry in section.entries.items() if section is not None else ():
            number = whole_number(plain(entry.value)) if key.isdigit() else None
            if number is not None and number not in objects:
                file.note(f"names 0x{number:04X}, which has no section", section, key)
