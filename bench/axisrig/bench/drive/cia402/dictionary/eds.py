"""The EDS of the drive, made from the object tables, and the dictionary that canopen reads from it.

Source: CiA 306-1 (electronic data sheet). Signed defaults are decimal and the vendor fields
are numbers, because other readers refuse anything else.
"""

import io
from collections.abc import Iterable
from functools import cache

from canopen.objectdictionary import ObjectDictionary
from canopen.objectdictionary.eds import import_eds

from axisrig.bench.drive.cia402.dictionary.objects import (
    DATA_TYPES,
    DUMMIES,
    HEADS,
    VARIABLE,
    DataType,
    ObjectRow,
    object_rows,
    rows_of,
)
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

_MANDATORY = (0x1000, 0x1001, 0x1018)
_BIT_RATES_KBIT_S = (10, 20, 50, 125, 250, 500, 800, 1000)
_MAPPINGS = (*range(0x1600, 0x1800), *range(0x1A00, 0x1C00))
TRIGGER_SOURCE = 0x60D0
_ACCESS = {("rw", "rx"): "rww"}  # CiA 306: rw object that an RPDO may write


def eds_text(profile: DriveProfile, file_name: str = "axisrig-drive.eds") -> str:
    """Return the EDS of a drive with this profile; the same text on every call."""
    rows = [row for row in object_rows() if profile.has_object(*row.key)]
    indices = list(dict.fromkeys(row.index for row in rows))
    mandatory = [index for index in indices if index in _MANDATORY]
    optional = [index for index in indices if index not in _MANDATORY]
    lines = [*_head(file_name, indices)]
    for title, members in (
        ("MandatoryObjects", mandatory),
        ("OptionalObjects", optional),
        ("ManufacturerObjects", []),
    ):
        lines += _object_list(title, members)
        for index in members:
            group = [row for row in rows if row.index == index]
            for row in group:
                lines += _object(row, len(group) - 1, profile)
    return "\n".join(lines) + "\n"


@cache
def object_dictionary(node_id: int, profile: DriveProfile) -> ObjectDictionary:
    """Return the dictionary of the drive with `node_id` as canopen reads it from the EDS.

    Master and drive share it: values live in the nodes, the dictionary only describes.
    """
    dictionary: ObjectDictionary = import_eds(  # type: ignore[no-untyped-call]
        io.StringIO(eds_text(profile)), node_id
    )
    return dictionary


def _section(title: str, entries: Iterable[tuple[str, object]]) -> list[str]:
    return [f"[{title}]", *(f"{key}={value}" for key, value in entries), ""]


def _head(file_name: str, indices: list[int]) -> list[str]:
    rpdos = sum(0x1400 <= index < 0x1600 for index in indices)
    tpdos = sum(0x1800 <= index < 0x1A00 for index in indices)
    # The dates are part of the text and therefore fixed: equal inputs give an equal file
    stamp = [
        (f"{what}{key}", value)
        for what in ("Creation", "Modification")
        for key, value in (("Time", "12:00AM"), ("Date", "01-01-2026"))
    ]
    file_info = [
        ("FileName", file_name),
        ("FileVersion", 1),
        ("FileRevision", 0),
        ("EDSVersion", "4.0"),
        ("Description", "Model of a servo drive of CiA 402"),
        *stamp,
        ("CreatedBy", "axisrig"),
        ("ModifiedBy", "axisrig"),
    ]
    device_info = [
        ("VendorName", "axisrig"),
        ("VendorNumber", "0x00000000"),
        ("ProductName", "axisrig DS402 drive"),
        ("ProductNumber", "0x00000192"),
        ("RevisionNumber", "0x00010000"),
        ("OrderCode", "DS402"),
        *((f"BaudRate_{rate}", 1) for rate in _BIT_RATES_KBIT_S),
        ("SimpleBootUpMaster", 0),
        ("SimpleBootUpSlave", 1),
        ("Granularity", 8),
        ("DynamicChannelsSupported", 0),
        ("GroupMessaging", 0),
        ("NrOfRXPDO", rpdos),
        ("NrOfTXPDO", tpdos),
        ("LSS_Supported", 1),
    ]
    dummies = [(f"Dummy{code:04d}", int(code in DUMMIES)) for code in range(1, 8)]
    return [
        *_section("FileInfo", file_info),
        *_section("DeviceInfo", device_info),
        *_section("DummyUsage", dummies),
        *_section("Comments", [("Lines", 0)]),
    ]


def _object_list(title: str, indices: list[int]) -> list[str]:
    entries = [(str(number), f"0x{index:04X}") for number, index in enumerate(indices, 1)]
    return _section(title, [("SupportedObjects", len(indices)), *entries])


def _object(row: ObjectRow, sub_count: int, profile: DriveProfile) -> list[str]:
    title = f"{row.index:04X}" + ("" if row.sub is None else f"sub{row.sub:X}")
    entries: list[tuple[str, object]] = [
        ("ParameterName", row.name),
        ("ObjectType", f"0x{HEADS.get(row.type, VARIABLE):X}"),
    ]
    if row.is_head:
        return _section(title, [*entries, ("SubNumber", sub_count)])
    entries += [
        ("DataType", f"0x{data_type(row, profile).code:04X}"),
        ("AccessType", _ACCESS.get((row.access, row.pdo), row.access)),
    ]
    if row.low is not None:
        entries.append(("LowLimit", row.low))
    if row.high is not None:
        entries.append(("HighLimit", row.high))
    if row.type != "DOMAIN":
        entries.append(("DefaultValue", default_text(row, profile)))
    entries.append(("PDOMapping", int(bool(row.pdo))))
    return _section(title, entries)


def data_type(row: ObjectRow, profile: DriveProfile) -> DataType:
    """Return the type of an object in a drive with this profile."""
    is_source = row.index == TRIGGER_SOURCE and row.sub
    return DATA_TYPES[profile.source_type] if is_source else row.data_type


def default_text(row: ObjectRow, profile: DriveProfile) -> str:
    """Return the default value; a PDO that would carry a missing object carries nothing."""
    if (
        row.index in _MAPPINGS
        and profile.missing_objects
        and not all(
            profile.has_object(int(other.default, 0) >> 16, int(other.default, 0) >> 8 & 0xFF)
            for other in rows_of(row.index)
            if other.sub
        )
    ):
        return "0"
    if row.index == TRIGGER_SOURCE and row.sub == 0:
        return str(sum(profile.has_object(TRIGGER_SOURCE, sub) for sub in (1, 2)))
    # Few defaults come from the profile, and every start asks for those of all objects
    return row.default.format(**profile.object_defaults) if "{" in row.default else row.default
