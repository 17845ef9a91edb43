"""What a drive has by its dictionary, by hand: ranges, bytes, what a DCF wants, texts of an EDS."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from canopen import objectdictionary
from canopen.objectdictionary import ODVariable, datatypes

from axisrig.kernel.drives.canopen.dcf import dcf_value, dcf_values
from axisrig.kernel.drives.canopen.dictionary import (
    allowed_values,
    check_functions,
    check_mapping,
    check_objects,
    encode,
    variable,
)
from axisrig.kernel.drives.canopen.eds_file import (
    object_of,
    read_eds_file,
    table_of,
    whole_number,
)
from axisrig.kernel.drives.canopen.eds_text import canonical
from axisrig.kernel.errors import UserError

MAKE: Any = objectdictionary  # its constructors have no types
U8, U16, I16, I32 = (
    datatypes.UNSIGNED8, datatypes.UNSIGNED16, datatypes.INTEGER16, datatypes.INTEGER32,
)  # fmt: skip


def item(index: int, sub: int = 0, kind: int = U16, **more: Any) -> ODVariable:
    found: ODVariable = MAKE.ODVariable(f"object {index:X}", index, sub)
    found.data_type, found.access_type, found.pdo_mappable = kind, "rw", True
    for name, value in more.items():
        setattr(found, name, value)
    return found


def dictionary(*items: ODVariable) -> Any:
    od = MAKE.ObjectDictionary()
    for found in items:
        if not found.subindex:
            od.add_object(found)
            continue
        if found.index not in od:
            od.add_object(MAKE.ODRecord(f"record {found.index:X}", found.index))
        od[found.index].add_member(found)
    return od


# Ranges


@pytest.mark.parametrize(
    ("kind", "low", "high", "values"),
    [
        (U8, None, None, range(256)), (I16, None, None, range(-32768, 32768)),
        (datatypes.BOOLEAN, None, None, range(2)), (U8, 5, None, range(5, 256)),
        (U8, None, 9, range(10)), (I16, -3, 4, range(-3, 5)),
        # Place holders of editors: nothing but one value, or none
        (U8, 0, 0, range(256)), (U8, 7, 7, range(256)), (I16, 5, 1, range(-32768, 32768)),
        (U8, 6, 7, range(6, 8)),
    ],
)  # fmt: skip
def test_a_whole_number_is_inside_its_limits_or_its_type(
    kind: int, low: int | None, high: int | None, values: range
) -> None:
    assert allowed_values(item(0x2000, kind=kind, min=low, max=high)) == values


@pytest.mark.parametrize(
    ("kind", "value", "data"),
    [(U8, 255, "ff"), (U16, 258, "0201"), (I16, -2, "feff"), (I32, -2, "feffffff"),
     (datatypes.BOOLEAN, 1, "01")],
)  # fmt: skip
def test_a_value_is_written_as_its_type_wants_it(kind: int, value: int, data: str) -> None:
    assert encode(dictionary(item(0x2000, kind=kind)), 0x2000, 0, value).hex() == data


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [(U8, 256, "does not fit"), (U8, -1, "does not fit"), (I16, 32768, "does not fit"),
     (datatypes.BOOLEAN, 2, "does not take"), (datatypes.REAL32, 1, "only whole numbers")],
)  # fmt: skip
def test_a_value_that_its_type_does_not_hold_is_refused(kind: int, value: int, text: str) -> None:
    with pytest.raises(UserError, match=text) as caught:
        encode(dictionary(item(0x2000, kind=kind)), 0x2000, 0, value)
    if text == "does not fit":
        bits = 8 if kind == U8 else 16
        assert (caught.value.value, caught.value.allowed) == (value, f"{bits} bits")


def test_limits_count_unless_they_are_left_out() -> None:
    od = dictionary(item(0x2000, kind=U8, min=5, max=9))
    assert [encode(od, 0x2000, 0, value) for value in (5, 9)] == [b"\x05", b"\x09"]
    for value in (4, 10):
        with pytest.raises(UserError, match="does not take the value") as caught:
            encode(od, 0x2000, 0, value)
        assert caught.value.allowed == "5 to 9"
        assert encode(od, 0x2000, 0, value, minds_limits=False) == bytes((value,))


def test_an_object_is_there_by_index_and_sub_index() -> None:
    od = dictionary(item(0x2000), item(0x2001, 1), item(0x2001, 2))
    array = MAKE.ODArray("array", 0x2002)
    array.add_member(item(0x2002, 1))
    od.add_object(array)
    found = {
        (index, sub): variable(od, index, sub) is not None
        for index in (0x2000, 0x2001, 0x2002, 0x2003)
        for sub in (0, 1, 2, 3)
    }
    there = {(0x2000, 0), (0x2001, 1), (0x2001, 2), (0x2002, 1)}
    assert {place for place, is_there in found.items() if is_there} == there
    with pytest.raises(UserError, match="no such object") as caught:
        encode(od, 0x2001, 3, 1)
    assert (caught.value.value, caught.value.allowed) == ("0x2001:3", "sub-index 1, 2")
    with pytest.raises(UserError, match="no such object") as caught:
        encode(od, 0x2000, 1, 1)
    assert (caught.value.value, caught.value.allowed) == ("0x2000:1", None)


@pytest.mark.parametrize("access", ["ro", "const"])
def test_what_cannot_be_written_is_refused(access: str) -> None:
    with pytest.raises(UserError, match="does not let the object be written") as caught:
        encode(dictionary(item(0x2000, access_type=access)), 0x2000, 0, 1)
    assert caught.value.value == "0x2000:0 object 2000"
    text = item(0x2000, kind=datatypes.VISIBLE_STRING)
    with pytest.raises(UserError, match="only whole numbers") as caught:
        encode(dictionary(text), 0x2000, 0, 1)
    assert caught.value.value == "0x2000:0 object 2000"


@pytest.mark.parametrize(
    ("is_received", "more", "bits", "signed", "text"),
    [
        (True, {}, 16, False, None), (False, {}, 16, False, None),
        (True, {"access_type": "ro"}, 16, False, "RPDO cannot carry"),
        (False, {"access_type": "ro"}, 16, False, None),
        (False, {"access_type": "wo"}, 16, False, "TPDO cannot carry"),
        (True, {"access_type": "wo"}, 16, False, None),
        (True, {"pdo_mappable": False}, 16, False, "no PDO may carry"),
        (True, {}, 8, False, "another type"), (True, {}, 16, True, "another type"),
        (True, {"data_type": I16}, 16, True, None),
    ],
)  # fmt: skip
def test_a_telegram_carries_what_the_drive_lets_it(
    is_received: bool, more: dict[str, Any], bits: int, signed: bool, text: str | None
) -> None:
    od = dictionary(item(0x2000, **more))
    mapped = SimpleNamespace(index=0x2000, sub=0, bits=bits, signed=signed)
    telegram: Any = SimpleNamespace(name="PDO1", is_received=is_received, objects=[mapped])
    if text is None:
        check_objects(od, telegram)
    else:
        with pytest.raises(UserError, match=text) as caught:
            check_objects(od, telegram)
        if text == "another type":
            shown = f"{bits} bits {'signed' if signed else 'unsigned'}"
            assert (caught.value.value, caught.value.allowed) == (shown, "16 bits unsigned")
        else:
            assert (caught.value.value, caught.value.allowed) == ("0x2000:0 object 2000", None)
    mapped.index = 0x2001
    with pytest.raises(UserError, match="does not have") as caught:
        check_objects(od, telegram)
    assert caught.value.value == "0x2001:0"


@pytest.mark.parametrize(("name", "base"), [("RPDO2", 0x1401), ("TPDO2", 0x1801)])
@pytest.mark.parametrize("lacks", [(0, 1), (0, 2), (0x200, 0)])
def test_a_telegram_needs_identifier_type_and_mapping_of_its_pdo(
    name: str, base: int, lacks: tuple[int, int]
) -> None:
    places = [(base, 1), (base, 2), (base + 0x200, 0)]
    missing = base + lacks[0], lacks[1]
    telegram: Any = SimpleNamespace(name=name, communication_index=base, objects=[])
    check_mapping(dictionary(*[item(*place) for place in places]), [telegram])
    rest = dictionary(*[item(*place) for place in places if place != missing])
    with pytest.raises(UserError, match=f"has no {name}") as caught:
        check_mapping(rest, [telegram])
    assert caught.value.value == f"0x{missing[0]:04X}:{missing[1]}"


FUNCTION_CASES: list[tuple[dict[str, Any], str | None]] = [
    ({}, None),
    ({"communication": "ACYCLIC", "index": 0x2001}, None),
    ({"communication": "CYCLIC"}, None),
    ({"communication": "CYCLIC", "index": 0x2001}, "no RPDO carries"),  # in none
    ({"communication": "CYCLIC", "index": 0x2002}, "no RPDO carries"),  # with a field
    ({"communication": "CYCLIC", "index": 0x2003}, "no RPDO carries"),  # in a TPDO
    ({"index": 0x2004}, "does not let it be written"),
    ({"index": 0x2005}, "has no such object"),
    ({"bits": 32}, "another data type"), ({"is_signed": True}, "another data type"),
    ({"read_index": 0x2005}, "no such object to read"), ({"read_index": 0x2004}, None),
    ({"read_sub": 1}, "no such object to read"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "text"), FUNCTION_CASES)
def test_a_drive_function_needs_an_object_and_a_cyclic_one_a_free_place(
    changes: dict[str, Any], text: str | None
) -> None:
    """A place of an RPDO without a field: with one the control itself sends the object."""
    od = dictionary(
        *[item(index) for index in (0x2000, 0x2001, 0x2002, 0x2003)],
        item(0x2004, access_type="ro"),
    )

    def telegram(is_received: bool, *objects: tuple[int, str]) -> Any:
        mapped = [SimpleNamespace(index=index, sub=0, field=field) for index, field in objects]
        return SimpleNamespace(is_received=is_received, objects=mapped)

    function = {
        "key": "F", "communication": "ACYCLIC", "index": 0x2000, "sub": 0, "read_index": 0x2000,
        "read_sub": 0, "bits": 16, "is_signed": False, "data_type": "UNS16", **changes,
    }  # fmt: skip
    functions: Any = {"F": SimpleNamespace(**function)}
    telegrams = {
        "RPDO1": telegram(True, (0x2002, "controlword"), (0x2000, "")),
        "TPDO1": telegram(False, (0x2003, "")),
    }
    if text is None:
        check_functions("Z", functions, od, telegrams)
        return
    with pytest.raises(UserError, match=text) as caught:
        check_functions("Z", functions, od, telegrams)
    assert caught.value.message.startswith("drive function F of axis Z")


# A DCF


def test_a_dcf_wants_values_written_that_are_not_the_ones_of_the_control() -> None:
    od = dictionary(
        item(0x1017, value=9), item(0x6040, value=6), item(0x60C2, 1, value=4),
        item(0x2000, value=7), item(0x2001), item(0x2002, value=5, access_type="ro", default=5),
        item(0x2003, 1, I16, value=-2), item(0x2003, 2, datatypes.REAL32, value=0.5),
        item(0x2004, kind=datatypes.VISIBLE_STRING, value="ab"),
        item(0x6065, kind=I32, value=1, default=1), item(0x2005, value=b"\x01\x02"),
    )  # fmt: skip
    found = [(v.index, v.sub, v.value, v.data.hex()) for v in dcf_values(od)]
    assert found == [
        (0x2000, 0, 7, "0700"), (0x2003, 1, -2, "feff"), (0x2003, 2, 0.5, "0000003f"),
        (0x2004, 0, "ab", "6162"), (0x2005, 0, b"\x01\x02", "0102"), (0x6065, 0, 1, "01000000"),
    ]  # fmt: skip
    assert [dcf_value(od, 0x2003, sub) for sub in (1, 2, 3)] == [-2, None, None]
    assert dcf_value(od, 0x1017, 0) is None


@pytest.mark.parametrize(("value", "is_refused"), [(9, True), (10, False), (20, False), (21, True)])
def test_limits_of_the_file_count_for_the_values_of_its_dcf(value: int, is_refused: bool) -> None:
    od = dictionary(item(0x2000, 3, value=value, min=10, max=20), item(0x2001, value=500))
    if not is_refused:
        assert [(each.index, each.sub, each.value) for each in dcf_values(od)] == [
            (0x2000, 3, value), (0x2001, 0, 500),
        ]  # fmt: skip
        return
    with pytest.raises(
        UserError, match=r"0x2000:3 .* does not take the value by the EDS"
    ) as caught:
        list(dcf_values(od))
    assert (caught.value.value, caught.value.allowed) == (value, "10 to 20")


def test_a_dcf_that_wants_another_value_of_what_cannot_be_written_is_refused() -> None:
    od = dictionary(item(0x2002, value=6, access_type="ro", default=5))
    with pytest.raises(UserError, match="does not let the object be written"):
        list(dcf_values(od))


# Texts


@pytest.mark.parametrize(
    ("text", "number"),
    [("12", 12), ("+12", 12), ("-12", -12), ("0x1F", 31), ("-0X1f", -31), ("017", 15),
     ("-0017", -15), ("0", 0), ("00", 0), ("08", 8), (" 7 ", 7), ("", None), ("0x", None),
     ("1.5", None), ("$NODEID", None), ("12a", None), ("--1", None)],
)  # fmt: skip
def test_a_number_is_decimal_hexadecimal_or_octal(text: str, number: int | None) -> None:
    assert whole_number(text) == number


@pytest.mark.parametrize(
    ("name", "place", "table"),
    [
        ("1018", (0x1018, None), None),
        ("1018sub4", (0x1018, 4), None),
        ("1A00SUBff", (0x1A00, 255), None),
        ("7", (7, None), None),
        ("1018sub", None, None),
        ("10180", None, None),
        ("DeviceInfo", None, None),
        ("1003Name", None, (0x1003, "Name")),
        ("1003VALUE", None, (0x1003, "Value")),
        ("1018sub1000", None, None),
        ("1010ObjectLinks", None, (0x1010, "Objectlinks")),
    ],
)
def test_a_section_is_an_object_a_member_or_a_table(
    name: str, place: tuple[int, int | None] | None, table: tuple[int, str] | None
) -> None:
    assert (object_of(name), table_of(name)) == (place, table)


@pytest.mark.parametrize(
    ("text", "number", "notes"),
    [("5", 5, []), ("", None, ["is empty and counts as missing"]), (None, None, [])],
)
def test_a_key_that_is_empty_counts_as_missing(
    tmp_path: Path, text: str | None, number: int | None, notes: list[str]
) -> None:
    path = tmp_path / "some.eds"
    path.write_text("[1000]\nOther=1\n" + ("" if text is None else f"DataType={text}\n"))
    file = read_eds_file(str(path))
    assert file.number(file.sections["1000"], "DATATYPE") == number
    assert [note.text for note in file.notes] == notes
    assert [(note.place, note.line) for note in file.notes] == [("[1000] DATATYPE", 3)] * len(notes)


def test_a_key_that_is_no_number_is_refused_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "some.eds"
    path.write_text("[1000]\nOther=1\nDataType=0x7G\n", encoding="ascii")
    file = read_eds_file(str(path))
    with pytest.raises(UserError, match="no number") as caught:
        file.number(file.sections["1000"], "DataType")
    refused = caught.value
    assert (refused.line, refused.value, str(refused.file)) == (3, "0x7G", str(path))


@pytest.mark.parametrize(
    ("data", "value", "notes"),
    [
        (b"[A]\nKey = x ; of what\n", "x", []),
        ("[A]\nKey=ä\n".encode("utf-8-sig"), "ä", ["the file begins with a byte order mark"]),
        ("[A]\nKey=ä\n".encode("utf-16"), "ä", ["the file begins with a byte order mark"]),
        ("[A]\nKey=ä\n".encode("cp1252"), "ä", ["the file is no UTF-8 and is read as cp1252"]),
        # A byte that is no sign of either keeps its place
        (b"[A]\nKey=a\x81\xe4\n", "a\ufffdä", ["the file is no UTF-8 and is read as cp1252"]),
        # Zeros up to the end of a block, as some tools fill files up
        (b"[A]\nKey=x\n\0\0\0", "x", []), (b"[A]\nKey=x\n\0\x1a\0\n", "x", []),
        (b"; [B]\n# no\n[ A ] ; first\r\nKey=x\r\nno key\r\n\x1a", "x",
         ["line 5 is neither section nor key and is left out"]),
        (b"[A]\nKey=x\nkey=x\n", "x", ["is there twice with one value, lines 2 and 3"]),
        (b"[A]\nKey=a;b\n", "a;b", []),
    ],
)  # fmt: skip
def test_a_file_is_read_as_its_editor_has_written_it(
    tmp_path: Path, data: bytes, value: str, notes: list[str]
) -> None:
    path = tmp_path / "some.eds"
    path.write_bytes(data)
    file = read_eds_file(str(path))
    assert (list(file.sections), file.sections["a"].text("KEY")) == (["a"], value)
    assert [note.text for note in file.notes] == notes


@pytest.mark.parametrize(
    ("data", "text", "line"),
    [("Key=1\n[A]\n", "before the first section", 1), ("\n; c\n", "has no section", None),
     ("[A]\n[b]\n[a]\n", "is there twice, first in line 1", 3),
     ("[A]\nk=1\nK=2\n", "is there twice, first in line 2 with '1'", 3),
     ("[A]\nk=a\n\nk=A\n", "is there twice, first in line 2 with 'a'", 4)],
)  # fmt: skip
def test_a_file_that_says_two_things_is_refused(
    tmp_path: Path, data: str, text: str, line: int | None
) -> None:
    path = tmp_path / "some.eds"
    path.write_text(data)
    with pytest.raises(UserError, match=text) as caught:
        read_eds_file(str(path))
    assert caught.value.line == line


@pytest.mark.parametrize("lines", ["Lines=2", "Lines=0x2", "Lines=1", "Lines=3", "Lines=", ""])
def test_the_comments_of_a_file_are_counted_anew(tmp_path: Path, lines: str) -> None:
    """Lines that follow each other, and a note where the file counts them otherwise or not."""
    path = tmp_path / "some.eds"
    path.write_text(f"[Comments]\n{lines}\nLine4=last\nLine1=first\n", encoding="ascii")
    file = read_eds_file(str(path))
    text = canonical(file).text
    assert "[Comments]\nLines=2\nLine1=first\nLine2=last\n" in text
    notes = [note.text for note in file.notes if note.section]
    is_right = lines in ("Lines=2", "Lines=0x2")
    assert notes == ([] if is_right else ["does not fit the 2 lines that are there"])


@pytest.mark.parametrize(
    ("kind", "count", "compact"), [("0x8", 3, {0x2000: 3}), ("0x9", 3, {}), ("0x8", 0, {})]
)
def test_the_short_form_is_of_arrays_alone(
    tmp_path: Path, kind: str, count: int, compact: dict[int, int]
) -> None:
    """CiA 306-1: CompactSubObj; a record has a section for each of its members."""
    path = tmp_path / "some.eds"
    head = f"[2000]\nParameterName=Some\nObjectType={kind}\nCompactSubObj={count}\n"
    short = "DataType=0x6\nAccessType=rw\n" if compact else ""
    member = "[2000sub1]\nParameterName=First\nDataType=0x5\nAccessType=ro\n"
    path.write_text(head + short + member, encoding="ascii")
    found = canonical(read_eds_file(str(path)))
    assert found.compact == compact
    assert ("CompactSubObj" in found.text) is bool(compact)
    assert "[2000sub1]" in found.text
