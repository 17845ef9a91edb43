"""EDS and DCF as editors of the field write them: read, with a note for each mend, or refused.

Source: CiA 306-1. The shapes are those that EDS files of makers and of editors were seen with.
"""

import random
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from canopen.objectdictionary import ObjectDictionary, ODVariable

from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.drives.canopen.dictionary import eds_notes, read_eds
from axisrig.kernel.drives.canopen.eds_file import read_eds_file, whole_number
from axisrig.kernel.errors import UserError

WHOLE = eds_text(DriveProfile())
KEPT = ("FileInfo", "DeviceInfo", "DummyUsage", "Comments", "1000", "1001", "1018", "1003", "1400",
        "1600", "1800", "6040", "6064", "607D")  # fmt: skip
NODE = 3


def _sections(text: str) -> dict[str, str]:
    return {part.partition("]")[0]: f"[{part.strip()}\n\n" for part in text.split("\n[")[1:]}


SECTIONS = {"FileInfo": "", **_sections("\n" + WHOLE)}
SMALL = "".join(body for name, body in SECTIONS.items() if name.partition("sub")[0] in KEPT)
"""A few objects of each shape, so that reading costs little."""

Values = dict[tuple[int, int], tuple[object, ...]]


def values_of(od: ObjectDictionary) -> Values:
    """Return type, access, limits and default of every variable."""
    found: Values = {}
    for index in od:
        whole = od[index]
        for item in [whole] if isinstance(whole, ODVariable) else whole.values():
            found[index, item.subindex] = (
                item.data_type, item.access_type, item.pdo_mappable, item.min, item.max,
                item.default,
            )  # fmt: skip
    return found


@pytest.fixture
def written(tmp_path: Path) -> Callable[..., str]:
    """Write an EDS with the line ends of Windows."""

    def write(text: str, encoding: str = "utf-8") -> str:
        path = tmp_path / "some.eds"
        path.write_bytes(text.replace("\n", "\r\n").encode(encoding))
        return str(path)

    return write


def changed(section: str, pattern: str, new: str) -> str:
    """Return the small EDS with a change in one section, which must hit."""
    begin = SMALL.index(f"[{section}]\n")
    end = SMALL.find("\n[", begin) + 1 or len(SMALL)
    body, count = re.subn(pattern, new, SMALL[begin:end], flags=re.MULTILINE)
    assert count
    return SMALL[:begin] + body + SMALL[end:]


def test_the_eds_of_our_own_drive_is_read_without_a_note(written: Callable[..., str]) -> None:
    path = written(SMALL)
    assert eds_notes(path) == []
    by_canopen = {"6040": 0x06, "6064": 0x04}  # UNSIGNED16, INTEGER32 of CiA 301
    found = read_eds(path, NODE)
    assert {name: found[int(name, 16)].data_type for name in by_canopen} == by_canopen
    assert found[0x1800][1].default == 0x40000180 + NODE or found[0x1800][1].default == 0x180 + NODE
    assert [found[0x607D][sub].default for sub in (1, 2)] != []


VENDOR = changed("DeviceInfo", "^VendorName=.*", "VendorName=Müller Antriebe")
LIST_ONLY = "[Comments]\nLines={count}\nLine1=first\n{name}=second\n\n"

SHAPES: list[tuple[str, str, str, str]] = [
    # text, encoding, section and key of the note, its text ("" = CiA 306 allows it: no note)
    (VENDOR, "cp1252", "", "cp1252"),
    (VENDOR, "cp850", "", "cp1252"),
    (VENDOR, "utf-8", "", ""),
    (SMALL, "utf-8-sig", "", "byte order mark"),
    (SMALL, "utf-16", "", "byte order mark"),
    (re.sub(r"(?m)^([A-Za-z]+)(=)", lambda m: m[1].lower() + m[2], SMALL), "ascii", "", ""),
    (SMALL.upper().replace("0X", "0x"), "ascii", "", ""),
    (SMALL.replace("[Comments]\nLines=0\n\n", LIST_ONLY.format(count=2, name="line2")), "ascii",
     "", ""),
    (SMALL.replace("[Comments]\nLines=0\n\n", LIST_ONLY.format(count=3, name="Line2")), "ascii",
     "[Comments] Lines", "does not fit"),
    (changed("DummyUsage", "^Dummy0001=.*\n", ""), "ascii", "", ""),
    (changed("DummyUsage", "^Dummy0001=.*", "Dummy0001="), "ascii", "[DummyUsage] Dummy0001",
     "empty"),
    (changed("DeviceInfo", "^VendorNumber=.*", "VendorNumber="), "ascii",
     "[DeviceInfo] VendorNumber", "counts as missing"),
    (changed("6040", "^ObjectType=.*", "ObjectType="), "ascii", "[6040] ObjectType", "empty"),
    (changed("6040", "^ObjectType=.*", "ObjectType=07"), "ascii", "", ""),
    (changed("1018", "^ObjectType=.*\n", ""), "ascii", "[1018] ObjectType", "record"),
    (changed("6040", "^ParameterName=.*\n", ""), "ascii", "[6040] ParameterName", "missing"),
    (changed("6040", "^(DataType=.*)", r"  \1   ; sixteen bits"), "ascii", "", ""),
    (changed("6040", "^(DataType=.*)", r"\1\n\1"), "ascii", "[6040] DataType", "twice"),
    (changed("6040", "^(DataType=.*)", r"\1\nrubbish"), "ascii", "[6040]", "neither section"),
    (SMALL.replace("$NODEID+0x200", "0x200 + $NodeId"), "ascii", "", ""),
    (SMALL.replace("[1018sub", "[1018Sub0"), "ascii", "", ""),
    (re.sub(r"(?ms)^\[DeviceInfo\].*?(?=^\[)", "", SMALL), "ascii", "", "[DeviceInfo] is missing"),
    (re.sub(r"(?ms)^\[1018\]\n.*?(?=^\[)", "", SMALL), "ascii", "[1018sub0]", "no object"),
]  # fmt: skip


@pytest.mark.long(but=6)
@pytest.mark.parametrize(("text", "encoding", "place", "note"), SHAPES)
def test_what_can_be_meant_in_one_way_is_read(
    written: Callable[..., str], text: str, encoding: str, place: str, note: str
) -> None:
    path = written(text, encoding)
    notes = eds_notes(path)
    found = values_of(read_eds(path, NODE))
    as_it_was = values_of(read_eds(written(SMALL), NODE))
    lost = 0x1018 if place == "[1018sub0]" else None
    assert found == {key: value for key, value in as_it_was.items() if key[0] != lost}
    if not note:
        assert notes == []
    else:
        assert note in notes[0].text
        assert notes[0].place == place


@pytest.mark.parametrize(
    ("text", "section", "message"),
    [
        (SMALL + "[6040]\nParameterName=x\n", "[6040]", "there twice, first in line"),
        (changed("6040", "^(DataType)=.*", r"\1=0x6\n\1=0x7"), "[6040] DataType", "twice"),
        (changed("6040", "^DataType=.*\n", ""), "[6040] DataType", "is missing"),
        (changed("6040", "^DataType=.*", "DataType="), "[6040] DataType", "is missing"),
        (changed("6040", "^DataType=.*", "DataType=word"), "[6040] DataType", "no number"),
        (changed("6040", "^AccessType=.*\n", ""), "[6040] AccessType", "is missing"),
        (changed("6040", "^AccessType=.*", "AccessType=r w"), "[6040] AccessType", "no access"),
        (changed("1018", "^ObjectType=.*", "ObjectType=x"), "[1018] ObjectType", "no number"),
        (SMALL.replace("[1018sub1]", "[1018sub01]\nParameterName=x\nDataType=7\nAccessType=ro\n"
                       "[1018sub1]"), "[1018sub1]", "the same object"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_refused_with_line_section_and_key(
    written: Callable[..., str], text: str, section: str, message: str
) -> None:
    path = written(text)
    with pytest.raises(UserError, match=message) as error:
        read_eds(path, NODE)
    assert section in error.value.message
    assert error.value.file == path
    assert error.value.line is not None
    name = section.partition(" ")[0]
    lines = text.splitlines()
    assert name in "\n".join(lines[max(0, error.value.line - 12) : error.value.line])


@pytest.mark.parametrize("text", ["", "; nothing\n", "Key=1\n[FileInfo]\n"])
def test_a_file_without_sections_is_no_eds(written: Callable[..., str], text: str) -> None:
    with pytest.raises(UserError, match="the EDS cannot be read"):
        read_eds(written(text), NODE)


@pytest.mark.parametrize(
    ("line", "value"),
    [
        ("Key=5", "5"), ("Key = 5 ; five", "5"), ("KEY=5\t; five; or 6", "5"),
        ("key=a;b", "a;b"), ("Key=", ""), ("Key=;nothing yet", ""), ("Key= ; nothing yet", ""),
        ("Key=a=b", "a=b"), ("  Key=a b  ", "a b"), ("; Key=5", None), ("# Key=5", None),
    ],
)  # fmt: skip
def test_a_value_ends_where_its_comment_begins(
    written: Callable[..., str], line: str, value: str | None
) -> None:
    """A semicolon after a blank, or at once after the mark; one inside a word is of the word."""
    found = read_eds_file(written(f"[ Some Part ] ; of it\n{line}\nOther=1\n"))
    section = found.sections["some part"]
    assert section.text("Other") == "1"
    entry = section.entries.get("key")
    assert (entry and entry.value) == value
    assert entry is None or (entry.line, section.line) == (2, 1)
    assert found.notes == []


@pytest.mark.parametrize(
    ("text", "number"),
    [("7", 7), ("07", 7), ("010", 8), ("0x1F", 31), ("0X1f", 31), ("-3", -3), ("0", 0), ("00", 0),
     ("09", 9), ("", None), ("1F", None), ("0x", None), ("1.5", None)],
)  # fmt: skip
def test_numbers_of_cia_306(text: str, number: int | None) -> None:
    """Decimal, hexadecimal with 0x, octal with a leading 0; 09 can only be decimal."""
    assert whole_number(text) == number


@pytest.mark.parametrize(
    ("value", "data_type", "expected"),
    [("010", "0x6", 8), ("0xFFFF", "0x3", -1), ("0x8000", "0x3", -32768), ("-5", "0x3", -5),
     ("0xFFFFFFFF", "0x7", 0xFFFFFFFF), ("$NODEID + 010", "0x7", 8 + NODE),
     ("$nodeid", "0x7", NODE), ("some", "0x6", None)],
)  # fmt: skip
def test_defaults_in_every_form_of_a_number(
    written: Callable[..., str], value: str, data_type: str, expected: int | None
) -> None:
    text = f"[FileInfo]\n\n[2000]\nParameterName=x\nDataType={data_type}\nAccessType=rw\n"
    path = written(f"{text}DefaultValue={value}\n")
    assert read_eds(path, NODE)[0x2000].default == expected
    assert any("no number" in note.text for note in eds_notes(path)) == (expected is None)


def test_names_of_a_short_array(written: Callable[..., str]) -> None:
    """CiA 306: the section of names lists those members that have one of their own."""
    text = (
        "[FileInfo]\n\n[2100Name]\nNrOfEntries=1\n3=third\n\n[2100]\nParameterName=Gains\n"
        "ObjectType=0x8\nDataType=6\nAccessType=rw\nCompactSubObj=4\n"
    )
    array = read_eds(written(text), NODE)[0x2100]
    assert [array[sub].name for sub in (1, 2, 3, 4)] == ["Gains", "Gains 2", "third", "Gains 4"]


@pytest.mark.parametrize("title", ["2100Name", "2100NAME", "2100name"])
def test_only_the_table_of_names_gives_names(written: Callable[..., str], title: str) -> None:
    """CiA 306-1 has tables of values, denotations and links too, and each title in any letters."""
    tables = "".join(
        f"[{each}]\nNrOfEntries=2\n1={word}1\n4={word}4\n\n"
        for each, word in (
            ("2100Value", "7"), ("2100Denotation", "meant"), (title, "named"),
            ("2100ObjectLinks", "0x2101"), ("2101Name", "other"),
        )
    )  # fmt: skip
    array = (
        "[{0}]\nParameterName=Gains\nObjectType=0x8\nDataType=6\nAccessType=rw\nCompactSubObj=4\n\n"
    )
    text = "[FileInfo]\n\n" + tables + array.format(2100) + array.format(2102)
    od = read_eds(written(text), NODE)
    names = [[od[index][sub].name for sub in (1, 2, 3, 4)] for index in (0x2100, 0x2102)]
    assert names == [
        ["named1", "Gains 2", "Gains 3", "named4"], ["Gains", "Gains 2", "Gains 3", "Gains 4"],
    ]  # fmt: skip


def _read(path: str) -> tuple[Values, UserError | None]:
    try:
        return values_of(read_eds(path, NODE)), None
    except UserError as error:
        return {}, error


def mutated(draw: random.Random) -> tuple[str, list[tuple[str, str]]]:
    """Return the small EDS as another editor would write it, and the keys that it leaves out."""
    sections = [part for part in re.split(r"(?m)^(?=\[)", SMALL) if part.strip()]
    if draw.random() < 0.5:
        draw.shuffle(sections)
    lost: list[tuple[str, str]] = []
    lines: list[str] = []
    for section in sections:
        name = section.partition("]")[0].removeprefix("[")
        for line in section.splitlines():
            key, mark, value = line.partition("=")
            if mark and draw.random() < 0.004:
                lost.append((name, key))
                continue
            if draw.random() < 0.3:
                key = draw.choice((str.lower, str.upper, str.title))(key)
            if mark and draw.random() < 0.3:
                blank = draw.choice(("", " ", "\t", "   "))
                lines.append(f"{blank}{key}{blank}={blank}{value}{blank}")
            else:
                lines.append(f"{key}{mark}{value}")
            if draw.random() < 0.05:
                lines.append(draw.choice(("", "; a comment", "  ;[6040]", "# another", "\t")))
    return "\n".join(lines) + "\n", lost


@pytest.mark.parametrize("seed", [*range(10), *(pytest.param(n, marks=pytest.mark.long)
                                                for n in range(10, 300))])  # fmt: skip
def test_an_eds_of_another_editor_is_read_as_it_was_or_refused_by_its_key(
    written: Callable[..., str], seed: int
) -> None:
    """Case, blanks, comments and order change nothing; a missing key only its own object."""
    text, lost = mutated(random.Random(seed))
    path = written(text)
    found, error = _read(path)
    if error is not None:
        assert (error.file, error.line is None) == (path, False)
        places = [f"[{section}] {key}".lower() for section, key in lost]
        assert any(place in error.message.lower() for place in places)
        return
    before = values_of(read_eds(written(SMALL), NODE))
    touched = {section.partition("sub")[0] for section, _ in lost}
    if any(section == "DummyUsage" for section in touched):
        touched |= {f"{code:04X}" for code in range(1, 8)}
    same = {key: value for key, value in before.items() if f"{key[0]:04X}" not in touched}
    assert {key: found.get(key) for key in same} == same
    assert {f"{index:04X}" for index, _ in found.keys() ^ before.keys()} <= touched


@pytest.mark.parametrize("section", ["MandatoryObjects", "OptionalObjects", "ManufacturerObjects"])
def test_each_object_that_a_list_names_and_the_file_lacks_is_noted(
    written: Callable[..., str], section: str
) -> None:
    """CiA 306-1: three lists name the objects, one key for each, and their number."""
    listed = ("0x1000", "0x2001", "0x6040", "0x2002", "0x3003")
    lines = "".join(f"{place}={number}\n" for place, number in enumerate(listed, 1))
    path = written(f"{SMALL}[{section}]\nSupportedObjects={len(listed)}\n{lines}\n")
    notes = [(note.place, note.text) for note in eds_notes(path)]
    assert notes == [
        (f"[{section}] {key}", f"names {number}, which has no section")
        for key, number in ((2, "0x2001"), (4, "0x2002"), (5, "0x3003"))
    ]
