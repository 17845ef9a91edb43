"""Numbers of an EDS in all its places, as CiA 306-1 writes them and with a comment behind them."""

from collections.abc import Callable
from pathlib import Path

import pytest
from canopen.objectdictionary import ObjectDictionary, ODVariable

from axisrig.kernel.drives.canopen.dictionary import eds_notes, read_eds
from axisrig.kernel.errors import UserError

NODE = 3
OBJECT = """\
[1000]
ParameterName=Device type
ObjectType=7
DataType=0x0007
AccessType=ro
DefaultValue=0x20192
PDOMapping=0
"""
RATES = (10, 20, 50, 125, 250, 500, 800, 1000)
"""Bit rates of CiA 301 in kbit/s."""
NUMBERS = {
    "VendorNumber": "vendor_number", "ProductNumber": "product_number",
    "RevisionNumber": "revision_number", "NrOfRXPDO": "nr_of_RXPDO", "NrOfTXPDO": "nr_of_TXPDO",
}  # fmt: skip
FLAGS = {
    "SimpleBootUpMaster": "simple_boot_up_master", "SimpleBootUpSlave": "simple_boot_up_slave",
    "Granularity": "granularity", "DynamicChannelsSupported": "dynamic_channels_supported",
    "GroupMessaging": "group_messaging", "LSS_Supported": "LSS_supported",
}  # fmt: skip
TEXTS = {"VendorName": "vendor_name", "ProductName": "product_name", "OrderCode": "order_code"}
FORMS = {"31": 31, "0x1F": 31, "037": 31, "0X1f": 31}
"""31 as CiA 306-1 may write it: decimal, hexadecimal, octal."""
COMMENTS = ["", ";of it", " ; of it", "\t; of it", " ;"]

Read = Callable[..., tuple[ObjectDictionary, list[str]]]


@pytest.fixture
def read(tmp_path: Path) -> Read:
    """Read an EDS of these lines; the dictionary, and the places of the notes."""

    def reading(*lines: str) -> tuple[ObjectDictionary, list[str]]:
        path = tmp_path / "some.eds"
        text = "\n".join(lines)
        if "[DeviceInfo]" not in text:
            text = "[DeviceInfo]\n" + text
        path.write_text(f"{text}\n{OBJECT}", encoding="utf-8")
        return read_eds(str(path), NODE), [f"{n.place}: {n.text}" for n in eds_notes(str(path))]

    return reading


# [DeviceInfo]


@pytest.mark.parametrize("comment", COMMENTS)
@pytest.mark.parametrize(("form", "value"), FORMS.items())
@pytest.mark.parametrize("key", NUMBERS)
def test_a_number_of_the_device_is_read_in_each_form(
    read: Read, key: str, form: str, value: int, comment: str
) -> None:
    od, notes = read("[DeviceInfo]", f"{key}={form}{comment}")
    assert (getattr(od.device_information, NUMBERS[key]), notes) == (value, [])
    others = [getattr(od.device_information, name) for name in NUMBERS.values()]
    assert [found for found in others if found] == [value]


@pytest.mark.parametrize("comment", COMMENTS)
@pytest.mark.parametrize("value", [0, 1])
@pytest.mark.parametrize("key", FLAGS)
def test_a_flag_of_the_device_is_read(read: Read, key: str, value: int, comment: str) -> None:
    od, notes = read("[DeviceInfo]", f"{key}={value}{comment}")
    found = {name: getattr(od.device_information, name) for name in FLAGS.values()}
    assert bool(found.pop(FLAGS[key])) is bool(value)
    assert not any(found.values())
    assert notes == []


@pytest.mark.parametrize("comment", COMMENTS)
@pytest.mark.parametrize("rate", RATES)
def test_a_bit_rate_is_one_that_the_device_allows(read: Read, rate: int, comment: str) -> None:
    """In bit/s; 0 stands for a rate that it does not take."""
    others = [f"BaudRate_{other}=0{comment}" for other in RATES if other != rate]
    od, notes = read("[DeviceInfo]", f"BaudRate_{rate}=1{comment}", *others)
    assert od.device_information.allowed_baudrates == {rate * 1000}
    assert notes == []


@pytest.mark.parametrize("key", TEXTS)
def test_a_text_of_the_device_is_no_number(read: Read, key: str) -> None:
    """A semicolon inside a word is of the word."""
    od, notes = read("[DeviceInfo]", f"{key}=Drive 0x10;B ; of it")
    assert getattr(od.device_information, TEXTS[key]) == "Drive 0x10;B"
    assert notes == []


@pytest.mark.parametrize("text", ["", "; none", "one", "1.5", "0x", "1 2", "one;1"])
@pytest.mark.parametrize("key", ["VendorNumber", "BaudRate_500", "LSS_Supported"])
def test_what_is_no_number_of_the_device_counts_as_missing(read: Read, key: str, text: str) -> None:
    """And is noted; the numbers after it are read."""
    od, notes = read("[DeviceInfo]", f"{key}={text}", "ProductNumber=5", "BaudRate_20=1")
    assert notes == [f"[DeviceInfo] {key}: is no number and counts as missing"]
    info = od.device_information
    assert (info.vendor_number, info.product_number) == (None, 5)
    assert info.allowed_baudrates == {20_000}


# The other sections


@pytest.mark.parametrize("comment", COMMENTS)
def test_the_number_of_comments_may_have_one_itself(read: Read, comment: str) -> None:
    _, notes = read("[Comments]", f"Lines=2{comment}", "Line1=first", "Line2=second")
    assert notes == []


@pytest.mark.parametrize("said", ["1", "3", "0", "x", "", "1;2"])
def test_another_number_of_comments_is_noted(read: Read, said: str) -> None:
    od, notes = read("[Comments]", f"Lines={said}", "Line1=first", "Line2=second")
    assert notes == ["[Comments] Lines: does not fit the 2 lines that are there"]
    assert od.comments == "first\nsecond"


def test_comments_come_in_the_order_of_their_numbers(read: Read) -> None:
    """10 after 9, wherever they stand; what is no line is none."""
    numbers = [10, 2, 1, 9, 3, 8, 4, 7, 5, 6]
    lines = [f"Line{number}=text {number}" for number in numbers]
    od, notes = read("[Comments]", "Lines=10", *lines, "LineX=no line")
    assert od.comments == "\n".join(f"text {number}" for number in range(1, 11))
    assert notes == []


@pytest.mark.parametrize("name", ["DeviceComissioning", "DeviceCommissioning"])
@pytest.mark.parametrize("comment", COMMENTS)
@pytest.mark.parametrize(("form", "value"), FORMS.items())
def test_a_configuration_has_its_bit_rate_in_thousands(
    read: Read, name: str, form: str, value: int, comment: str
) -> None:
    """CiA 306-1 spells the section with one m, editors with two. The node is that of the rig."""
    od, notes = read(f"[{name}]", f"NodeID=9{comment}", f"Baudrate={form}{comment}")
    assert (od.bitrate, od.node_id, notes) == (value * 1000, NODE, [])


@pytest.mark.parametrize("name", ["MandatoryObjects", "OptionalObjects", "ManufacturerObjects"])
@pytest.mark.parametrize("comment", COMMENTS)
def test_a_list_names_objects_that_are_there(read: Read, name: str, comment: str) -> None:
    """One that has no section is noted, with its number in hexadecimal digits."""
    there = f"1=0x1000{comment}"
    _, notes = read(f"[{name}]", "SupportedObjects=1", there)
    assert notes == []
    for missing in ("0x6A0B", "0x0040"):  # also a structure of the maker
        _, notes = read(f"[{name}]", "SupportedObjects=2", there, f"2={missing}{comment}")
        assert notes == [f"[{name}] 2: names {missing}, which has no section"]


@pytest.mark.parametrize("first", ["DeviceComissioning", "DeviceCommissioning"])
def test_of_two_configurations_the_one_in_the_spelling_of_the_standard_counts(
    read: Read, first: str
) -> None:
    """Wherever they stand; a drive is set up for one node at one bit rate."""
    texts = {
        "DeviceComissioning": ["[DeviceComissioning]", "NodeID=9", "Baudrate=250"],
        "DeviceCommissioning": ["[DeviceCommissioning]", "NodeID=8", "Baudrate=500"],
    }
    (second,) = texts.keys() - {first}
    od, _ = read(*texts[first], *texts[second])
    assert od.bitrate == 250_000


@pytest.mark.parametrize("comment", COMMENTS)
@pytest.mark.parametrize("used", [(), (5,), (1, 7), (1, 2, 3, 4, 5, 6, 7)])
def test_data_types_fill_places_of_rpdos_where_the_file_says_so(
    read: Read, used: tuple[int, ...], comment: str
) -> None:
    """Dummy0001 to Dummy0007; one that is 0 or missing fills none."""
    lines = [f"Dummy{code:04}=1{comment}" for code in used]
    lines += [f"Dummy{code:04}=0{comment}" for code in (2, 6) if code not in used]
    od, notes = read("[DummyUsage]", *lines)
    assert [code for code in range(8) if code in od] == [*used]
    assert notes == []


# Objects


def variable_of(access: str = "rw", data_type: str = "0x0006", *more: str) -> list[str]:
    kind = ["[2000]", "ParameterName=some", "ObjectType=7"]
    return [*kind, f"DataType={data_type}", f"AccessType={access}", *more]


def found_in(od: ObjectDictionary, index: int = 0x2000) -> ODVariable:
    found = od[index]
    assert isinstance(found, ODVariable)
    return found


@pytest.mark.parametrize("comment", COMMENTS)
@pytest.mark.parametrize(
    ("key", "name"), [("LowLimit", "min"), ("HighLimit", "max"), ("DefaultValue", "default")]
)
@pytest.mark.parametrize(("form", "value"), FORMS.items())
def test_limits_and_values_of_a_variable_are_numbers(
    read: Read, key: str, name: str, form: str, value: int, comment: str
) -> None:
    od, notes = read(*variable_of("rw", "0x0006", f"{key}={form}{comment}"))
    assert (getattr(found_in(od), name), notes) == (value, [])


@pytest.mark.parametrize("comment", COMMENTS)
@pytest.mark.parametrize("access", ["ro", "wo", "rw", "rwr", "rww", "const"])
def test_every_access_type_is_one_with_a_comment(read: Read, access: str, comment: str) -> None:
    """Read and written as CiA 306-1 says; rwr and rww are about the PDO that maps it."""
    for written in (access, access.upper()):
        od, notes = read(*variable_of(f"{written}{comment}"))
        found = found_in(od)
        assert found.readable is (access != "wo")
        assert found.writable is (access not in ("ro", "const"))
        assert notes == []


@pytest.mark.parametrize(
    ("data_type", "bits"),
    [
        (0x02, 8), (0x03, 16), (0x10, 24), (0x04, 32), (0x12, 40), (0x13, 48), (0x14, 56),
        (0x15, 64),
    ],
)  # fmt: skip
def test_a_hexadecimal_value_of_a_signed_type_is_that_of_the_bus(
    read: Read, data_type: int, bits: int
) -> None:
    """INTEGER8 to 64 (CiA 301): the upper half is negative, the lower one is not."""
    for number, value in (
        ((1 << bits) - 1, -1),
        (1 << bits - 1, -(1 << bits - 1)),
        ((1 << bits - 1) - 1, (1 << bits - 1) - 1),
        (5, 5),
    ):
        od, notes = read(*variable_of("rw", hex(data_type), f"DefaultValue=0x{number:X};raw"))
        assert (found_in(od).default, notes) == (value, [])


@pytest.mark.parametrize(
    ("data_type", "bits"),
    [
        (0x05, 8), (0x06, 16), (0x16, 24), (0x07, 32), (0x18, 40), (0x19, 48), (0x1A, 56),
        (0x1B, 64),
    ],
)  # fmt: skip
def test_a_value_of_an_unsigned_type_stays_as_it_is(read: Read, data_type: int, bits: int) -> None:
    """UNSIGNED8 to 64 (CiA 301)."""
    most = (1 << bits) - 1
    od, notes = read(*variable_of("rw", hex(data_type), f"DefaultValue=0x{most:X}"))
    assert (found_in(od).default, notes) == (most, [])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("$NODEID+0x200", 0x203), ("0x200+$NODEID", 0x203), ("$nodeid + 0x200", 0x203),
        ("$NODEID", 3), ("$NODEID+512", 0x203), ("$NODEID+0x200;of it", 0x203), ("0x200", 0x200),
    ],
)  # fmt: skip
def test_a_value_may_count_from_the_number_of_the_node(read: Read, text: str, value: int) -> None:
    od, notes = read(*variable_of("rw", "0x0007", f"DefaultValue={text}"))
    assert (found_in(od).default, notes) == (value, [])


@pytest.mark.parametrize(
    ("lines", "data_type", "access"),
    [
        ([], 0x0F, "rw"),
        (["DataType=0x0009"], 0x09, "rw"),  # a text
        (["DataType=0x000F", "AccessType=ro"], 0x0F, "ro"),
        (["DataType=0x000A", "AccessType=WO"], 0x0A, "wo"),
        (["AccessType=const"], 0x0F, "const"),
    ],
)
@pytest.mark.parametrize("is_member", [False, True])
def test_a_domain_needs_neither_type_nor_access(
    read: Read, lines: list[str], data_type: int, access: str, is_member: bool
) -> None:
    """CiA 306-1: bytes that may be read and written, unless the file says what they are."""
    domain = ["ParameterName=some", "ObjectType=0x2", *lines]
    record = [
        "[2000]", "ParameterName=both", "ObjectType=0x9", "SubNumber=3",
        "[2000sub0]", "ParameterName=count", "DataType=5", "AccessType=ro",
        "[2000sub1]", "ParameterName=number", "DataType=6", "AccessType=ro", "[2000sub2]",
    ]  # fmt: skip
    od, notes = read(*(record if is_member else ["[2000]"]), *domain)
    found = od[0x2000][2] if is_member else found_in(od)
    assert (found.data_type, found.access_type, notes) == (data_type, access, [])
    if is_member:
        assert (od[0x2000][1].data_type, od[0x2000][1].access_type) == (6, "ro")


@pytest.mark.parametrize("kind", ["0x7", "0x8"])
def test_what_a_variable_is_kept_in_and_counted_with_goes_on(read: Read, kind: str) -> None:
    """Of a variable, and of the members of an array in the short form."""
    short = ["CompactSubObj=2"] if kind == "0x8" else []
    od, notes = read(
        "[2000]", "ParameterName=some", f"ObjectType={kind}", *short, "DataType=6",
        "AccessType=rw", "Unit=mm", "Factor=0.1", "Description=a length", "StorageLocation=ROM",
        "PDOMapping=1",
    )  # fmt: skip
    for found in [od[0x2000][1], od[0x2000][2]] if short else [found_in(od)]:
        assert (found.unit, found.factor, found.description) == ("mm", 0.1, "a length")
        assert (found.storage_location, found.pdo_mappable) == ("ROM", True)
    assert notes == []


# Structures of the maker


@pytest.mark.parametrize("comment", COMMENTS)
def test_a_structure_of_the_file_is_a_type_of_its_variables(read: Read, comment: str) -> None:
    """Objects below 1000 are types; sub-index 1 has the first one of the structure."""
    structure = [
        "[0040]", "ParameterName=own", "ObjectType=6", "SubNumber=2",
        "[0040sub1]", "ParameterName=first", "DataType=7", "AccessType=ro",
        f"DefaultValue=0x0007{comment}",
    ]  # fmt: skip
    _, notes = read(*structure, *variable_of("rw", f"0x0040{comment}"))
    assert notes == []
    _, notes = read(*variable_of("rw", f"0x0040{comment}"))
    assert len(notes) == 1
    assert notes[0].startswith("[2000] DataType: 0x40 is no type of CiA 301")


@pytest.mark.parametrize(
    ("key", "text"), [("DataType", "six"), ("PDOMapping", "yes"), ("DataType", "0x")]
)
def test_a_word_where_a_number_must_be_is_refused_with_its_line(
    read: Read, key: str, text: str
) -> None:
    of_type = text if key == "DataType" else "0x0006"
    lines = ["[DeviceInfo]", *variable_of("rw", of_type), "PDOMapping=yes"]
    with pytest.raises(UserError, match=rf"\[2000\] {key}: no number") as caught:
        read(*lines)
    assert caught.value.line == 1 + lines.index(f"{key}={text}")
    assert caught.value.value == text
