"""Sub-indices of an EDS: hexadecimal in the names of sections, whatever editor wrote them."""

from collections.abc import Callable
from pathlib import Path

import pytest
from canopen.objectdictionary import ODArray, ODRecord

from axisrig.kernel.drives.canopen.dictionary import read_eds
from axisrig.kernel.drives.canopen.eds_file import EdsFile, read_eds_file
from axisrig.kernel.drives.canopen.eds_text import canonical
from axisrig.kernel.errors import UserError

NODE = 3
SUBS = (0, 1, 9, 10, 15, 16, 17, 31, 32, 99, 100, 127, 254)
"""Those where decimal and hexadecimal numbers part, and the last of CiA 301 that holds data."""


def member(title: str, number: int) -> str:
    """Its default is a number of its own."""
    return (
        f"[{title}]\nParameterName=Member {number}\nDataType=0x0007\nAccessType=rw\n"
        f"DefaultValue={1000 + number}\nPDOMapping=0\n"
    )


def record(index: str, members: str, kind: int = 9) -> str:
    return f"[{index}]\nParameterName=Some record\nObjectType={kind}\n{members}"


@pytest.fixture
def eds(tmp_path: Path) -> Callable[[str], str]:
    def write(text: str) -> str:
        path = tmp_path / "some.eds"
        path.write_text(f"[DeviceInfo]\nVendorName=Some\n{text}", encoding="ascii")
        return str(path)

    return write


@pytest.mark.parametrize("form", ["{0}sub{1:X}", "{0}sub{1:x}", "{0}SUB{1:X}", "{0}sub{1:02X}"])
@pytest.mark.parametrize("kind", [8, 9])
def test_each_member_has_the_sub_index_of_its_section(
    eds: Callable[[str], str], form: str, kind: int
) -> None:
    """CiA 306-1: `[2000subA]` is sub-index 10, and `[2000sub10]` is 16."""
    members = "".join(member(form.format("2000", sub), sub) for sub in SUBS)
    whole = read_eds(eds(record("2000", members, kind)), NODE)[0x2000]
    assert isinstance(whole, ODArray if kind == 8 else ODRecord)
    assert {sub: whole[sub].default for sub in SUBS} == {sub: 1000 + sub for sub in SUBS}
    assert [whole[sub].subindex for sub in SUBS] == list(SUBS)
    assert [whole[sub].name for sub in SUBS] == [f"Member {sub}" for sub in SUBS]


def test_members_may_stand_in_any_order_and_before_their_object(eds: Callable[[str], str]) -> None:
    text = member("2000sub10", 16) + member("2000subA", 10) + record("2000", member("2000sub9", 9))
    file = read_eds_file(eds(text))
    written = canonical(file).text
    places = [written.index(f"[2000{part}]") for part in ("", "sub9", "subA", "sub10")]
    assert places == sorted(places)
    whole = read_eds(eds(text), NODE)[0x2000]
    assert [whole[sub].default for sub in (9, 10, 16)] == [1009, 1010, 1016]


@pytest.mark.parametrize(
    ("first", "second"), [("2000subA", "2000sub0A"), ("2000sub9", "2000sub009"), ("20", "0020")]
)
def test_one_object_in_two_spellings_is_refused(
    eds: Callable[[str], str], first: str, second: str
) -> None:
    head = record("2000", "") if "sub" in first else ""
    text = head + member(first, 1) + member(second, 2)
    with pytest.raises(UserError) as caught:
        canonical(read_eds_file(eds(text)))
    expected = f"the EDS cannot be read: [{second}]: is the same object as [{first}]"
    assert (caught.value.message, caught.value.allowed) == (expected, "each object once")


def test_an_index_is_hexadecimal_in_either_case(eds: Callable[[str], str]) -> None:
    text = "".join(
        member(name, number) for number, name in enumerate(("200a", "200B", "2010", "ABcd"))
    )
    found = read_eds(eds(text), NODE)
    assert [found[index].default for index in (0x200A, 0x200B, 0x2010, 0xABCD)] == [
        1000, 1001, 1002, 1003,
    ]  # fmt: skip


# What is left out or added, with its note


def noted(text: str, eds: Callable[[str], str]) -> tuple[EdsFile, str]:
    file = read_eds_file(eds(text))
    return file, canonical(file).text


def test_members_without_their_object_are_left_out_each_with_a_note(
    eds: Callable[[str], str],
) -> None:
    file, written = noted(member("2000subA", 10) + member("2001", 1) + member("2000sub1", 1), eds)
    assert "2000" not in written
    notes = [(note.section, note.text) for note in file.notes]
    text = "belongs to no object of the file and is left out"
    assert sorted(notes) == [("2000sub1", text), ("2000subA", text)]


def test_members_of_a_variable_are_left_out_with_one_note(eds: Callable[[str], str]) -> None:
    variable = member("2000", 0) + "ObjectType=7\n"
    file, written = noted(variable + member("2000sub1", 1) + member("2000subA", 10), eds)
    assert "2000sub" not in written
    (note,) = file.notes
    assert (note.section, note.text) == (
        "2000", "is a variable, and its 2 sub-indices are left out",
    )  # fmt: skip


def test_a_member_without_a_name_gets_that_of_its_section(eds: Callable[[str], str]) -> None:
    nameless = member("2000subA", 10).replace("ParameterName=Member 10\n", "")
    file, written = noted(record("2000", nameless), eds)
    assert "[2000subA]\nParameterName=Object 2000subA\n" in written
    assert [note.place for note in file.notes] == ["[2000subA] ParameterName"]


@pytest.mark.parametrize(
    ("old", "new", "key", "text", "allowed"),
    [
        ("DataType=0x0007\n", "", "DataType", "is missing", "number of a type of CiA 301"),
        ("AccessType=rw\n", "", "AccessType", "is missing", "ro, wo, rw, rwr, rww, const"),
        ("AccessType=rw", "AccessType=r", "AccessType", "no access type",
         "ro, wo, rw, rwr, rww, const"),
    ],
)  # fmt: skip
def test_a_member_that_cannot_be_read_is_named(
    eds: Callable[[str], str], old: str, new: str, key: str, text: str, allowed: str
) -> None:
    wrong = member("2000subA", 10).replace(old, new)
    file = read_eds_file(eds(record("2000", member("2000sub1", 1) + wrong)))
    with pytest.raises(UserError) as caught:
        canonical(file)
    error = caught.value
    assert error.message == f"the EDS cannot be read: [2000subA] {key}: {text}"
    assert str(error.allowed) == allowed
    assert error.line == (15 if new else 12)  # of the key, else of the section


@pytest.mark.parametrize(
    ("written", "data_type", "value"),
    [
        ("0xFF", 2, -1), ("0x7F", 2, 127), ("0x80", 2, -128), ("0xFFFF", 3, -1), ("0x8000", 3,
         -32768), ("0xFFFFFFFF", 4, -1), ("0xFF", 5, 255), ("0xFFFF", 6, 65535), ("-5", 3, -5),
        ("0xFFFFFFFF", 7, 0xFFFFFFFF), ("0xFFFFFF", 0x10, -1), ("0xFFFFFFFFFFFFFFFF", 0x15, -1),
        ("$NODEID+0x200", 7, 0x203), ("0x200+$NODEID", 7, 0x203), ("$NODEID", 7, 3),
        ("010", 7, 8), ("10", 7, 10),
    ],
)  # fmt: skip
def test_a_value_is_that_of_its_type_and_node(
    eds: Callable[[str], str], written: str, data_type: int, value: int
) -> None:
    """A signed one in hexadecimal is the complement of two; $NODEID is added."""
    text = member("2000", 0).replace("0x0007", f"0x{data_type:X}").replace("=1000", f"={written}")
    assert read_eds(eds(text), NODE)[0x2000].default == value
