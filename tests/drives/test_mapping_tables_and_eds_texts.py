"""Columns and cells of a mapping table, and structures and empty values of an EDS."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.kernel.drives.canopen.eds_file import read_eds_file
from axisrig.kernel.drives.canopen.eds_text import canonical
from axisrig.kernel.drives.canopen.mapping import COLUMNS, FIELDS, Telegram, telegrams
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.errors import UserError

HEAD = ",".join(COLUMNS)
ROWS = (
    "RPDO1,1,0,0x6040,0,16,no,controlword",
    "RPDO1,1,0,0x607A,0,32,yes,target",
    "TPDO1,1,0,0x6041,0,16,no,statusword",
    "TPDO1,1,0,0x6064,0,32,yes,actual",
)
Table = Callable[..., str]


@pytest.fixture
def table(tmp_path: Path) -> Table:
    def write(head: str, *rows: str) -> str:
        path = tmp_path / "map.csv"
        path.write_text("\n".join([head, *rows, ""]), encoding="utf-8")
        return str(path)

    return write


@pytest.mark.parametrize(
    ("bits", "length"),
    [((1,), 1), ((8,), 1), ((9,), 2), ((12,), 2), ((16, 1), 3), ((4, 4), 1), ((64,), 8), ((), 0)],
)
def test_a_telegram_has_whole_bytes_for_its_bits(bits: tuple[int, ...], length: int) -> None:
    objects = tuple(MappedObject(0x2000, sub, size, False, "") for sub, size in enumerate(bits))
    assert Telegram("TPDO1", 1, 0, objects).length == length


def test_the_first_row_of_a_telegram_has_its_times(table: Table) -> None:
    """The others may leave them out: 0."""
    head = f"{HEAD},event_ms,cob_id"
    rows = [f"{row},0,0" for row in ROWS]
    path = table(
        head, *rows,
        "TPDO3,254,7,0x2000,1,8,no,,20,0x1C1", "TPDO3,254,9,0x2000,2,8,no,,30,0x1C2",
    )  # fmt: skip
    found = telegrams(0x60BA, path)["TPDO3"]
    assert (found.inhibit_100us, found.event_ms, found.identifier) == (7, 20, 0x1C1)
    assert [(each.index, each.sub) for each in found.objects] == [(0x2000, 1), (0x2000, 2)]


@pytest.mark.parametrize("cell", ["", " ", "\t", "0", " 0 "])
def test_an_optional_cell_may_be_blank(table: Table, cell: str) -> None:
    path = table(f"{HEAD},event_ms,cob_id", *(f"{row},{cell},{cell}" for row in ROWS))
    for telegram in telegrams(0x60BA, path).values():
        assert (telegram.event_ms, telegram.identifier) == (0, 0)


@pytest.mark.parametrize(
    ("more", "twice"),
    [("pdo", "pdo"), ("field", "field"), ("note,sub", "sub"), ("note,note", "note"),
     ("event_ms,note,event_ms", "event_ms")],
)  # fmt: skip
def test_a_column_is_there_once_wherever_the_second_one_is(
    table: Table, more: str, twice: str
) -> None:
    with pytest.raises(UserError, match="has a column twice") as caught:
        telegrams(0x60BA, table(f"{HEAD},{more}", *ROWS))
    assert (caught.value.line, caught.value.value) == (1, twice)


@pytest.mark.parametrize(
    ("name", "near"),
    [("sign", "signed"), ("cobid", "cob_id"), ("notes", "note"), ("fields", "field")],
)
def test_a_column_that_nothing_reads_has_the_nearest_name(
    table: Table, name: str, near: str
) -> None:
    with pytest.raises(UserError, match="a column that it does not know") as caught:
        telegrams(0x60BA, table(f"{HEAD},{name}", *ROWS))
    assert caught.value.value == name
    assert near in str(caught.value.allowed).split(", ")
    assert not {"transmission", "inhibit_100us"} & set(str(caught.value.allowed).split(", "))


def test_a_column_that_is_near_to_none_has_all_names(table: Table) -> None:
    with pytest.raises(UserError) as caught:
        telegrams(0x60BA, table(f"{HEAD},quark", *ROWS))
    assert set(COLUMNS) <= set(str(caught.value.allowed).split())


def test_each_field_has_one_place_of_the_table(table: Table) -> None:
    for row in ROWS:
        field = row.rpartition(",")[2]
        direction = "RPDO2" if FIELDS[field] else "TPDO2"
        second = f"{direction},1,0,0x2000,0,16,no,{field}"
        with pytest.raises(UserError, match=f"the field {field} is twice") as caught:
            telegrams(0x60BA, table(HEAD, *ROWS, second))
        assert caught.value.line == 6


# An EDS


@pytest.fixture
def written(tmp_path: Path) -> Callable[[str], str]:
    def write(text: str) -> str:
        path = tmp_path / "some.eds"
        path.write_text(text, encoding="ascii")
        return canonical(read_eds_file(str(path))).text

    return write


@pytest.mark.parametrize("name", ["FileName", "FileVersion", "FileRevision", "Description"])
def test_what_the_file_says_nothing_about_is_left_out(
    written: Callable[[str], str], name: str
) -> None:
    for value, shown in (("7", True), ("", False), ("  ", False)):
        text = written(f"[FileInfo]\n{name}={value}\nEDSVersion=4.0\n[DeviceInfo]\n")
        lines = text.split("\n")
        assert "EDSVersion=4.0" in lines
        assert (f"{name}=7" in lines) is shown
        assert any(line.startswith(name) for line in lines) is shown


@pytest.mark.parametrize(
    ("members", "is_there"),
    [
        ("[0040sub1]\nDefaultValue=0x5\n", True), ("[40sub1]\nDefaultValue=5\n", True),
        ("[0040sub1]\nDefaultValue=word\n", False), ("[0040sub2]\nDefaultValue=5\n", False),
        ("", False),
    ],
)  # fmt: skip
def test_a_structure_of_the_maker_goes_on_with_the_type_that_it_names(
    written: Callable[[str], str], members: str, is_there: bool
) -> None:
    """Objects below 1000; what a record of such a type is made of."""
    text = written(f"[DeviceInfo]\n[0040]\nParameterName=Own\nObjectType=6\n{members}")
    assert ("[40sub1]\nDefaultValue=5\n" in text) is is_there
    assert "[0040]" not in text


VARIABLE = "ParameterName=Some\nObjectType=7\nDataType=7\nAccessType=rw\n"
MEMBER = "ParameterName=Part\nDataType=7\nAccessType=rw\n"


def test_objects_come_in_the_order_of_their_numbers(written: Callable[[str], str]) -> None:
    names = ("6064", "1000", "A000", "2001", "600F")
    text = written("[DeviceInfo]\n" + "".join(f"[{name}]\n{VARIABLE}" for name in names))
    assert [line[1:-1] for line in text.split("\n") if line[1:-1] in names] == sorted(names)


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_members_of_a_variable_are_noted_however_few_there_are(tmp_path: Path, count: int) -> None:
    path = tmp_path / "some.eds"
    subs = "".join(f"[2000sub{sub}]\n{MEMBER}" for sub in range(count))
    path.write_text(f"[DeviceInfo]\n[2000]\n{VARIABLE}{subs}", encoding="ascii")
    file = read_eds_file(str(path))
    assert "2000sub" not in canonical(file).text
    wanted = f"is a variable, and its {count} sub-indices are left out"
    assert [(note.text, note.place, note.line) for note in file.notes] == (
        [(wanted, "[2000]", 2)] if count else []
    )


def test_an_object_with_members_and_without_a_kind_is_a_record(
    written: Callable[[str], str],
) -> None:
    """CiA 306-1: where the kind is missing it is a variable, which has no members."""
    text = written(f"[DeviceInfo]\n[2000]\nParameterName=Some\n[2000sub1]\n{MEMBER}")
    assert "[2000]\nParameterName=Some\nObjectType=0x9\n" in text
    assert "[2000sub1]\nParameterName=Part\nObjectType=0x7\n" in text
    alone = written(f"[DeviceInfo]\n[2000]\n{VARIABLE.replace('ObjectType=7', '')}")
    assert "[2000]\nParameterName=Some\nObjectType=0x7\n" in alone


@pytest.mark.parametrize(
    ("value", "mapped"), [("0", 0), ("1", 1), ("2", 1), ("0x1", 1), ("", 0), ("0x00", 0)]
)
def test_an_object_may_be_mapped_or_not(
    written: Callable[[str], str], value: str, mapped: int
) -> None:
    text = written(f"[DeviceInfo]\n[2000]\n{VARIABLE}PDOMapping={value}\n")
    assert f"\nPDOMapping={mapped}\n" in text


@pytest.mark.parametrize(("sub", "is_known"), [("1", True), ("2", False), ("0", False)])
def test_the_type_of_a_structure_is_in_its_first_member(
    written: Callable[[str], str], sub: str, is_known: bool
) -> None:
    """Else the value is bytes: DOMAIN, 0F."""
    text = written(
        f"[DeviceInfo]\n[0040]\nParameterName=Own\n[0040sub{sub}]\nDefaultValue=5\n"
        f"[2000]\n{VARIABLE.replace('DataType=7', 'DataType=0x40')}"
    )
    assert ("DataType=0x40" in text, "DataType=0xF" in text) == (is_known, not is_known)


@pytest.mark.parametrize(
    ("keys", "key", "line", "value", "word"),
    [
        ("ParameterName=A\nAccessType=rw\n", "DataType", 2, None, "is missing"),
        ("ParameterName=A\nAccessType=rw\nDataType=word\n", "DataType", 5, "word", "no number"),
        ("ParameterName=A\nDataType=7\n", "AccessType", 2, None, "is missing"),
        ("ParameterName=A\nDataType=7\nAccessType=\n", "AccessType", 5, "", "is missing"),
        ("AccessType=any\nParameterName=A\nDataType=7\n", "AccessType", 3, "any", "no access type"),
    ],
)  # fmt: skip
def test_a_key_is_refused_with_its_value_where_it_has_one(
    written: Callable[[str], str], keys: str, key: str, line: int, value: str | None, word: str
) -> None:
    with pytest.raises(UserError) as caught:
        written(f"[DeviceInfo]\n[2000]\n{keys}")
    error = caught.value
    assert error.message == f"the EDS cannot be read: [2000] {key}: {word}"
    assert (error.line, error.value) == (line, value)


@pytest.mark.parametrize("line", ["=5", " = 5", "word", "="])
def test_a_line_without_a_key_is_left_out_with_a_note(tmp_path: Path, line: str) -> None:
    path = tmp_path / "some.eds"
    path.write_text(f"[DeviceInfo]\nVendorName=A\n{line}\nProductName=B\n", encoding="ascii")
    file = read_eds_file(str(path))
    assert {name: entry.value for name, entry in file.sections["deviceinfo"].entries.items()} == {
        "vendorname": "A",
        "productname": "B",
    }
    (note,) = file.notes
    assert note.text == "line 3 is neither section nor key and is left out"
    assert note.place == "[DeviceInfo]"
