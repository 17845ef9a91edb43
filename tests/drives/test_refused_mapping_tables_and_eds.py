"""What a refusal of a mapping table or of an EDS shows: file, line, value, and what is allowed."""

from pathlib import Path
from typing import Any

import pytest

from axisrig.kernel.drives.canopen.dictionary import read_eds
from axisrig.kernel.drives.canopen.eds_file import read_eds_file
from axisrig.kernel.drives.canopen.mapping import telegrams
from axisrig.kernel.errors import UserError

HEAD = "pdo,transmission,inhibit_100us,index,sub,bits,signed,field"
CONTROLWORD, TARGET = "RPDO1,1,0,0x6040,0,16,no,controlword", "RPDO1,1,0,0x607A,0,32,yes,target"
STATUSWORD, ACTUAL = "TPDO1,1,0,0x6041,0,16,no,statusword", "TPDO1,1,0,0x6064,0,32,yes,actual"
NEEDED = [CONTROLWORD, TARGET, STATUSWORD, ACTUAL]
COLUMNS = HEAD.replace(",", " ")
Shown = tuple[int | None, Any, str | None, str | None]


@pytest.mark.parametrize(
    ("lines", "message", "shown"),
    [
        (["pdo,index,sub,bits,signed,field"], "lacks columns",
         (1, "transmission inhibit_100us", COLUMNS, None)),
        ([f"{HEAD},cob_di"], "a column that it does not know",
         (1, "cob_di", "cob_id", "words of your own go into the column note")),
        ([f"{HEAD},qqqq"], "a column that it does not know",
         (1, "qqqq", f"{COLUMNS} event_ms cob_id note",
          "words of your own go into the column note")),
        ([f"{HEAD},bits"], "a column twice", (1, "bits", "each column once", None)),
        ([HEAD, *NEEDED, "RPDO2,1,0,0x6040,0,16,no,"], "would get two values of it",
         (6, "0x6040:0", "each object in one place of the RPDOs",
          "take it out of line 2 or of line 6")),
        ([HEAD, *NEEDED, "TPDO1,1,0,0x60F4,0,32,yes,"], "TPDO1 is longer than a PDO",
         (6, "80 bits", "64 bits", None)),
        ([HEAD, CONTROLWORD, STATUSWORD, ACTUAL], "lacks a field: a set position leaves",
         (None, "target speed", "one of them, or both", None)),
        ([HEAD, *NEEDED[:2], ACTUAL], "lacks a field", (None, "statusword", None, None)),
        ([HEAD, *NEEDED, "TPDO2,1,0,0x6064,0,32,yes,actual"], "the field actual is twice",
         (6, None, None, None)),
        ([HEAD, *NEEDED[:3], ACTUAL.replace("TPDO1,1", "TPDO2,2")],
         "TPDO2 carries actual and must come with every SYNC", (5, 2, "1", None)),
        ([HEAD, *NEEDED, "TPDO2,0,0,0x60E4,1,32,yes,second"],
         "TPDO2 carries second and must come by itself",
         (6, 0, "1 .. 240, 254, 255", None)),
        ([HEAD, *NEEDED, "TPDO2,1,0,0x60E4,1,16,yes,second"],
         "the field second is a signed position of 32 bits",
         (6, "16 bits, signed yes", None, None)),
        ([HEAD, *NEEDED, "TPDO2,1,0,0x60E4,1,32,no,second"],
         "the field second is a signed position of 32 bits",
         (6, "32 bits, signed no", None, None)),
    ],
)  # fmt: skip
def test_a_mapping_table_that_cannot_be_is_refused_with_what_is_allowed(
    tmp_path: Path, lines: list[str], message: str, shown: Shown
) -> None:
    """With the place; a table that lacks something has no line of it."""
    table = tmp_path / "map.csv"
    table.write_text("\n".join([*lines, ""]), encoding="utf-8")
    with pytest.raises(UserError) as caught:
        telegrams(0x60BA, str(table))
    error = caught.value
    assert message in error.message
    allowed = " ".join(error.allowed) if isinstance(error.allowed, list) else error.allowed
    assert error.file == str(table)
    assert (error.line, error.value, allowed, error.hint) == shown


def test_a_mapping_table_that_is_no_text_is_named(tmp_path: Path) -> None:
    table = tmp_path / "map.csv"
    for content in (None, b"\xff\xfe\xfd"):
        if content is not None:
            table.write_bytes(content)
        with pytest.raises(UserError, match="the mapping table cannot be read") as caught:
            telegrams(0x60BA, str(table))
        assert caught.value.file == str(table)


@pytest.mark.parametrize(
    ("text", "message", "shown"),
    [
        ("", "it has no section", (None, None, None)),
        ("; a note\n", "it has no section", (None, None, None)),
        ("; a note\nA = 1\n[FileInfo]\n", "something is before the first section",
         (2, "A = 1", "[FileInfo] and other sections")),
        ("[A]\nB = 1\n[C]\n[a]\n", "[a] is there twice, first in line 1",
         (4, None, "each section once")),
        ("[A]\nB = 1\n\nb = 2\n", "[A] b is there twice, first in line 2 with '1'",
         (4, "2", "each key once")),
    ],
)  # fmt: skip
def test_an_eds_that_says_nothing_or_two_things_is_refused_with_its_place(
    tmp_path: Path, text: str, message: str, shown: tuple[int | None, str | None, str | None]
) -> None:
    path = tmp_path / "drive.eds"
    path.write_text(text, encoding="ascii")
    with pytest.raises(UserError) as caught:
        read_eds_file(str(path))
    error = caught.value
    assert error.message == f"the EDS cannot be read: {message}"
    assert error.file == str(path)
    assert (error.line, error.value, error.allowed) == shown


def test_an_eds_that_is_no_file_is_named_with_what_is_near_it(tmp_path: Path) -> None:
    (tmp_path / "drive.eds").touch()
    wrong = str(tmp_path / "drvie.eds")
    with pytest.raises(UserError, match="the EDS is no file") as caught:
        read_eds(wrong, 3)
    assert (caught.value.file, caught.value.hint) == (wrong, "near it: drive.eds")
    with pytest.raises(UserError, match="the EDS cannot be read: Is a directory") as caught:
        read_eds_file(str(tmp_path))
    assert caught.value.file == str(tmp_path)


def test_an_eds_that_the_parser_does_not_take_is_named(tmp_path: Path) -> None:
    """CiA 306: an object needs its data type."""
    path = tmp_path / "drive.eds"
    path.write_text("[2000]\nParameterName=Some\nObjectType=7\n", encoding="ascii")
    with pytest.raises(UserError, match="the EDS cannot be read") as caught:
        read_eds(str(path), 3)
    assert caught.value.file == str(path)
