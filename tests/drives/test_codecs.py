"""The codecs of PDOs against canopen's own, over random mappings; tables that cannot be.

canopen packs a value with its own bit arithmetic when it does not begin and end on whole bytes.
That arithmetic handles unsigned values inside one storage unit; only there can it be the reference.
"""

import struct
from pathlib import Path
from typing import Any

import pytest
from canopen.objectdictionary import ODVariable, datatypes
from canopen.pdo.base import PdoMap, PdoVariable
from hypothesis import given
from hypothesis import strategies as st

from axisrig.kernel.drives.canopen.mapping import Telegram, telegrams
from axisrig.kernel.drives.mapped import BitCodec, MappedObject
from axisrig.kernel.errors import UserError

WHOLE = {
    (8, False): datatypes.UNSIGNED8, (16, False): datatypes.UNSIGNED16,
    (32, False): datatypes.UNSIGNED32, (64, False): datatypes.UNSIGNED64,
    (8, True): datatypes.INTEGER8, (16, True): datatypes.INTEGER16,
    (32, True): datatypes.INTEGER32, (64, True): datatypes.INTEGER64,
}  # fmt: skip


def _telegram(fields: list[tuple[int, bool]]) -> Telegram:
    objects = tuple(
        MappedObject(0x2000 + n, 0, bits, signed, "") for n, (bits, signed) in enumerate(fields)
    )
    return Telegram("RPDO1", 1, 0, objects)


def _canopen(fields: list[tuple[int, bool, int]]) -> Any:
    """canopen's PDO of variables with (bits, signed, data type)."""
    pdo = PdoMap.__new__(PdoMap)
    pdo.map, pdo.length, pdo.data = [], 0, bytearray()  # type: ignore[attr-defined]
    pdo.cob_id = 0x200
    pdo.is_received, pdo.timestamp, pdo.period = False, None, None
    pdo.update = lambda: None  # type: ignore[method-assign]
    for n, (bits, _signed, data_type) in enumerate(fields):
        od = ODVariable(f"v{n}", 0x2000 + n, 0)
        od.data_type = data_type
        variable = PdoVariable(od)
        variable.pdo_parent, variable.offset, variable.length = pdo, pdo.length, bits
        pdo.map.append(variable)
        pdo.length += bits
    pdo.data = bytearray(-(-pdo.length // 8))
    return pdo


def _fitting(draw: Any) -> list[tuple[int, bool]]:
    fields: list[tuple[int, bool]] = []
    for bits, signed in draw(st.lists(st.sampled_from(sorted(WHOLE)), min_size=1, max_size=8)):
        if sum(b for b, _ in fields) + bits <= 64:
            fields.append((bits, signed))
    return fields or [(16, False)]


@st.composite
def whole_mappings(draw: Any) -> tuple[list[tuple[int, bool]], list[int]]:
    fields = _fitting(draw)
    values = [
        draw(st.integers(-(1 << b - 1), (1 << b - 1) - 1) if s else st.integers(0, (1 << b) - 1))
        for b, s in fields
    ]
    return fields, values


@given(whole_mappings())
@pytest.mark.long
def test_whole_bytes_are_packed_as_canopen_does(
    mapping: tuple[list[tuple[int, bool]], list[int]],
) -> None:
    fields, values = mapping
    telegram = _telegram(fields)
    pdo = _canopen([(bits, signed, WHOLE[bits, signed]) for bits, signed in fields])
    for variable, value in zip(pdo.map, values, strict=True):
        variable.raw = value
    packed = telegram.codec.pack(*values)
    assert isinstance(telegram.codec, struct.Struct)
    assert packed == bytes(pdo.data)
    assert len(packed) == telegram.length
    assert list(telegram.codec.unpack(packed)) == [variable.raw for variable in pdo.map]


@pytest.mark.long
@given(whole_mappings())
def test_the_codec_of_bits_agrees_with_struct(
    mapping: tuple[list[tuple[int, bool]], list[int]],
) -> None:
    fields, values = mapping
    telegram = _telegram(fields)
    bits = BitCodec(telegram.objects)
    packed = telegram.codec.pack(*values)
    assert bits.pack(*values) == packed
    assert bits.unpack(packed) == telegram.codec.unpack(packed)


@pytest.mark.long
@given(st.lists(st.booleans(), min_size=1, max_size=8))
def test_single_bits_are_packed_as_canopen_does(flags: list[bool]) -> None:
    """Truth values of 1 bit: eight of them fill a byte, the first one is bit 0."""
    telegram = _telegram([(1, False)] * len(flags))
    pdo = _canopen([(1, False, datatypes.BOOLEAN)] * len(flags))
    packed = telegram.codec.pack(*map(int, flags))
    assert packed == bytes((sum(flag << n for n, flag in enumerate(flags)),))
    pdo.data[:] = packed
    assert [bool(variable.raw) for variable in pdo.map] == flags
    assert [bool(value) for value in telegram.codec.unpack(packed)] == flags


@pytest.mark.long
@given(st.data())
def test_any_lengths_come_back_as_they_were(data: Any) -> None:
    """Lengths that are no whole bytes: CiA 301 lays the first object into the lowest bits."""
    fields: list[tuple[int, bool]] = []
    while sum(bits for bits, _ in fields) < 56 and data.draw(st.booleans()):
        left = 64 - sum(bits for bits, _ in fields)
        fields.append((data.draw(st.integers(1, min(left, 40))), data.draw(st.booleans())))
    fields = fields or [(24, True)]
    telegram = _telegram(fields)
    values = [
        data.draw(
            st.integers(-(1 << b - 1), (1 << b - 1) - 1) if s else st.integers(0, (1 << b) - 1)
        )
        for b, s in fields
    ]
    packed = telegram.codec.pack(*values)
    assert len(packed) == telegram.length == -(-sum(b for b, _ in fields) // 8)
    assert list(telegram.codec.unpack(packed)) == values
    whole, start = int.from_bytes(packed, "little"), 0
    for (bits, _), value in zip(fields, values, strict=True):
        assert whole >> start & (1 << bits) - 1 == value & (1 << bits) - 1
        start += bits


@pytest.mark.parametrize(
    ("bits", "signed", "value"), [(3, False, 8), (3, True, 4), (24, True, 1 << 23)]
)
def test_a_value_that_does_not_fit_is_refused(bits: int, signed: bool, value: int) -> None:
    with pytest.raises(struct.error):
        _telegram([(bits, signed)]).codec.pack(value)


# Mapping tables of a rig

HEAD = "pdo,transmission,inhibit_100us,index,sub,bits,signed,field,note\n"
GOOD = HEAD + (
    "RPDO1,1,0,0x607A,0,32,yes,target,\n"
    "RPDO1,1,0,0x6040,0,16,no,controlword,\n"
    "RPDO2,1,0,0x6072,0,16,no,,for #DRIVE\n"
    "TPDO1,1,0,0x6064,0,32,yes,actual,\n"
    "TPDO1,1,0,0x6041,0,16,no,statusword,\n"
)


def _table(tmp_path: Path, text: str) -> dict[str, Telegram]:
    path = tmp_path / "map.csv"
    path.write_text(text, encoding="utf-8")
    return telegrams(0x60BA, str(path))


def test_a_table_may_order_its_objects_as_it_likes(tmp_path: Path) -> None:
    maps = _table(tmp_path, GOOD)
    assert [o.entry for o in maps["RPDO1"].objects] == [0x607A0020, 0x60400010]
    assert maps["RPDO2"].communication_index == 0x1401
    assert maps["TPDO1"].codec.format == "<iH"


@pytest.mark.parametrize(
    ("old", "new", "message", "line"),
    [
        ("RPDO2", "RPDO513", "pdo of the mapping table", 4),
        ("RPDO2", "RPDO9", "cob_id of the mapping table", 4),
        ("RPDO2,1", "RPDO2,256", "transmission of the mapping table", 4),
        ("0x6072", "torque", "index of the mapping table", 4),
        ("0x6072,0,16", "0x6072,0,65", "bits of the mapping table", 4),
        ("16,no,,", "16,maybe,,", "signed of the mapping table", 4),
        ("16,no,,", "16,no,torque,", "field of the mapping table", 4),
        ("16,no,,", "16,no,statusword,", "pdo of the mapping table", 4),
        ("16,no,,", "16,no,target,", "is twice", 4),
        ("TPDO1,1,0,0x6041,0,16,no,statusword,\n", "", "lacks a field", None),
        ("RPDO1,1,0,0x607A", "RPDO1,254,0,0x607A", "must come with every SYNC", 3),
        ("0x6072,0,16", "0x6072,0,64", "longer than a PDO", None),
        ("pdo,transmission", "telegram,transmission", "lacks columns", 1),
    ],
)
def test_a_table_that_cannot_be_is_told_with_its_line(
    tmp_path: Path, old: str, new: str, message: str, line: int | None
) -> None:
    text = GOOD.replace(old, new)
    if message == "longer than a PDO":
        text += "RPDO2,1,0,0x6071,0,16,yes,,\n"
    with pytest.raises(UserError, match=message) as caught:
        _table(tmp_path, text)
    assert caught.value.file is not None
    if message == "lacks a field":
        assert caught.value.value == "statusword"
    if line is not None:
        assert caught.value.line == line


@pytest.mark.parametrize(
    ("column", "wanted"),
    [
        ("cob-id", "did you mean: cob_id"),
        ("event_us", "did you mean: event_ms"),
        ("Note", "did you mean: note"),
        ("identifier", "allowed: pdo transmission"),
    ],
)
def test_a_column_that_nothing_reads_is_refused(tmp_path: Path, column: str, wanted: str) -> None:
    """Its cells would be lost: a COB-ID under another name would leave the one of the node."""
    head, rows = GOOD.split("\n", 1)
    with pytest.raises(UserError, match=wanted) as caught:
        _table(tmp_path, f"{head},{column}\n{rows}")
    assert (caught.value.line, caught.value.value) == (1, column)


@pytest.mark.parametrize("column", ["pdo", "field", "note"])
def test_a_column_that_is_there_twice_is_refused(tmp_path: Path, column: str) -> None:
    head, rows = GOOD.split("\n", 1)
    with pytest.raises(UserError, match="a column twice") as caught:
        _table(tmp_path, f"{head},{column}\n{rows}")
    assert (caught.value.line, caught.value.value) == (1, column)


def test_the_columns_that_may_be_missing_are_taken_where_they_are_there(tmp_path: Path) -> None:
    head, rows = GOOD.split("\n", 1)
    maps = _table(
        tmp_path, f"{head},cob_id,event_ms,,\n{rows}"
    )  # two without a name, as of a sheet
    assert maps == _table(tmp_path, GOOD)
