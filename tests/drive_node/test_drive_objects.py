"""The object table, the EDS made from it, and two foreign readers of that EDS."""

from dataclasses import fields
from fractions import Fraction

import pytest
from canopen.objectdictionary import ODVariable

from axisrig.bench.drive.cia402.dictionary.eds import (
    default_text,
    eds_text,
    object_dictionary,
)
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.objects import Allowed, object_rows, variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile

ROWS = object_rows()
PROFILE = DriveProfile(encoder_increments=1 << 18, position_factor=Fraction(1, 2))


def test_keys_are_unique_and_ordered() -> None:
    keys = [(row.index, -1 if row.sub is None else row.sub) for row in ROWS]
    assert keys == sorted(set(keys))


def test_heads_have_members_and_sub_index_0_names_the_highest() -> None:
    for head in (row for row in ROWS if row.is_head):
        subs = [row.sub for row in ROWS if row.index == head.index and row.sub is not None]
        assert subs[0] == 0
        if variables()[head.index, 0].access == "const":
            assert int(variables()[head.index, 0].default) == subs[-1]


def test_every_field_of_the_image_is_an_object_and_back() -> None:
    named = {row.value for row in variables().values() if row.value}
    assert named == {field.name for field in fields(ProcessImage)}


def test_what_a_pdo_may_carry_stands_in_the_image() -> None:
    for row in variables().values():
        assert not row.pdo or row.value
        assert row.pdo != "rx" or row.access == "rw"
        assert row.pdo != "tx" or row.access == "ro"


def test_every_writable_object_says_when_it_acts() -> None:
    for row in variables().values():
        assert bool(row.effect) == (row.access == "rw"), row


def test_allowed_values() -> None:
    """Empty = all, a list of values and ranges, or the bits that may be set."""
    assert {7, -7} <= {v for v in range(-9, 9) if v in Allowed.parse("")}
    assert [v for v in range(-2, 8) if v in Allowed.parse("-1|2|0x6")] == [-1, 2, 6]
    assert [v for v in range(9) if v in Allowed.parse("0|2..4|7")] == [0, 2, 3, 4, 7]
    bits = Allowed.parse("mask 0x3F3F")
    assert all(v in bits for v in (0, 1, 0x2020, 0x3F3F))
    assert not any(v in bits for v in (0x40, 0x8001, 0xFFFF, 0x1_0000))
    for wrong in ("maske 0x3F", "1,2", "mask"):
        with pytest.raises(ValueError, match="invalid literal"):
            Allowed.parse(wrong)


def test_only_writable_numbers_are_narrowed_and_their_default_is_allowed() -> None:
    for row in variables().values():
        if row.allowed != Allowed():
            assert row.access == "rw", row
            assert int(row.default.format(**PROFILE.object_defaults), 0) in row.allowed, row


def test_canopen_reads_back_what_the_table_says() -> None:
    dictionary = object_dictionary(5, PROFILE)
    from_profile = {(0x608F, 1): 1 << 18, (0x6092, 1): 1 << 17}
    for key, row in variables().items():
        read = dictionary.get_variable(*key)
        assert isinstance(read, ODVariable)
        assert read.name == row.name
        assert read.data_type == row.data_type.code
        assert read.access_type == ("rww" if row.pdo == "rx" else row.access)
        assert read.pdo_mappable == bool(row.pdo)
        assert (read.min, read.max) == (row.low, row.high)
        if row.type == "DOMAIN":
            assert read.default is None
        elif row.type == "STRING":
            assert read.default == row.default
        elif "$NODEID" in row.default:
            assert read.default == 5 + int(row.default.removeprefix("$NODEID+"), 16)
        else:
            found = row.default.format(**PROFILE.object_defaults)
            assert read.default == from_profile.get(key, int(found, 0))
    dummies = range(2, 8)  # canopen adds them by itself where DummyUsage says so
    assert sorted(dictionary) == [*dummies, *sorted({row.index for row in ROWS})]


def test_predefined_connection_set() -> None:
    """Identifiers of CiA 301 for node 5; bit 31 marks the PDOs that are not in use."""
    dictionary = object_dictionary(5, PROFILE)
    rpdos = [dictionary[0x1400 + n][1].default for n in range(4)]
    tpdos = [dictionary[0x1800 + n][1].default for n in range(4)]
    assert rpdos == [0x205, 0x80000305, 0x80000405, 0x80000505]
    assert tpdos == [0x40000185, 0x40000285, 0x40000385, 0xC0000485]


def test_vendor_fields_are_numbers_and_signed_defaults_decimal() -> None:
    text = eds_text(PROFILE)
    for line in text.splitlines():
        if line.startswith(("VendorNumber=", "ProductNumber=", "RevisionNumber=")):
            int(line.split("=")[1], 0)
    for row in variables().values():
        if row.type.startswith("I"):
            assert "x" not in row.default


@pytest.mark.parametrize("lacks", ["", "60FD", "6064", "60FD 6064 60BA"])
def test_a_pdo_is_off_by_default_where_the_drive_lacks_any_object_of_its_mapping(
    lacks: str,
) -> None:
    profile = DriveProfile(lacks=lacks)
    rows = variables()
    found = {}
    for index in (*range(0x1600, 0x1604), *range(0x1A00, 0x1A04)):
        entries = [row for (at, sub), row in rows.items() if at == index and sub]
        mapped = {int(row.default, 0) >> 16 for row in entries} - {0}
        is_whole = not mapped & {int(each, 16) for each in lacks.split()}
        found[index] = is_whole
        count = default_text(rows[index, 0], profile)
        assert count == (rows[index, 0].default if is_whole else "0"), hex(index)
    assert set(found.values()) == ({True, False} if lacks else {True})


def test_equal_profiles_give_equal_text() -> None:
    assert eds_text(DriveProfile()) == eds_text(DriveProfile())
    assert eds_text(DriveProfile()) != eds_text(PROFILE)
