"""What a slave lists, describes and gives as a whole where its profile lacks objects or parts."""

import struct
from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError
from tests.ethercat.line import Line

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.object_access import ObjectAccess
from axisrig.bench.drive.ethercat.object_information import ObjectInformation
from axisrig.bench.drive.ethercat.objects import described, ethercat_table, rows

LIST, OBJECT, ENTRY, ERROR = 2, 4, 6, 7
NO_OBJECT, NO_SUB_INDEX, NO_COMPLETE_ACCESS = 0x06020000, 0x06090011, 0x06010004
MEMBERS = {
    0x607D: (1, 2), 0x608F: (1, 2), 0x6091: (1, 2), 0x6092: (1, 2), 0x6099: (1, 2),
    0x60C2: (1, 2), 0x60D0: (1, 2), 0x60E3: tuple(range(1, 37)), 0x60E4: (1,), 0x60E6: (1,),
    0x60EB: (1,),
}  # fmt: skip
"""Objects of the device profile with sub-indices (docs/drive-communication.md)."""
PARTS = [(index, sub) for index, subs in MEMBERS.items() for sub in subs if sub in (1, 2, subs[-1])]
I8, I16, I32, U8, U16, U32 = 2, 3, 4, 5, 6, 7
"""Data types of CiA 301."""


def asked(profile: DriveProfile, *words: int | str) -> tuple[int, bytes]:
    """Operation and data of the answer to a request for information, of one fragment."""
    info = ObjectInformation(described(profile), profile, lambda _: 8, lambda: 1500)
    packed = b"".join(
        bytes.fromhex(w) if isinstance(w, str) else struct.pack("<H", w) for w in words
    )
    (answer,) = info.request(struct.pack("<H", 8 << 12) + packed)
    return answer[2], answer[6:]


def listed(profile: DriveProfile, kind: int = 1) -> list[int]:
    operation, data = asked(profile, "01000000", kind)
    assert operation == LIST
    return list(struct.unpack_from(f"<{len(data) // 2}H", data))[1:]


def lacking(*parts: tuple[int, int] | int) -> DriveProfile:
    words = [f"{p:04X}" if isinstance(p, int) else f"{p[0]:04X}.{p[1]}" for p in parts]
    return DriveProfile(lacks=" ".join(words))


def test_these_are_all_objects_of_the_profile_with_sub_indices() -> None:
    found = {
        i: one for i, one in described(DriveProfile()).items() if i >= 0x6000 and one.code != 7
    }
    assert {index: (0, *MEMBERS[index]) for index in MEMBERS} == {
        index: tuple(one.rows) for index, one in found.items()
    }


@pytest.mark.parametrize(("index", "sub"), PARTS)
def test_a_part_that_is_lacking_is_not_described_and_all_others_are(index: int, sub: int) -> None:
    whole, found = described(DriveProfile()), described(lacking((index, sub)))
    assert list(found) == list(whole)
    for other, one in whole.items():
        subs = [n for n in one.rows if (other, n) != (index, sub)]
        assert list(found[other].rows) == subs
        assert (found[other].name, found[other].code) == (one.name, one.code)
    table = ethercat_table(lacking((index, sub)))
    assert [table.has(index, n) for n in (0, *MEMBERS[index])] == [
        n != sub for n in (0, *MEMBERS[index])
    ]


@pytest.mark.parametrize("index", [0x6040, 0x60BA, 0x607D, 0x60E3, 0x60FD])
def test_an_object_that_is_lacking_is_in_no_list(index: int) -> None:
    whole, profile = DriveProfile(), lacking(index)
    assert described(profile).keys() == described(whole).keys() - {index}
    for kind in range(1, 6):
        assert listed(profile, kind) == [each for each in listed(whole, kind) if each != index]
    assert asked(profile, "03000000", index) == (ERROR, struct.pack("<I", NO_OBJECT))
    assert asked(profile, "05000000", index, "0000") == (ERROR, struct.pack("<I", NO_OBJECT))


def test_the_lists_are_counted_as_they_are() -> None:
    profile = lacking(0x60BA, 0x607D, (0x60D0, 2), 0x6040)
    _, data = asked(profile, "01000000", 0)
    counts = struct.unpack_from("<5H", data, 2)
    assert counts == tuple(len(listed(profile, kind)) for kind in range(1, 6))
    _, data = asked(DriveProfile(), "01000000", 0)
    before = struct.unpack_from("<5H", data, 2)
    # Of all 60BA, 607D and 6040; 6040 is one that is received, 60BA one that is sent
    assert [a - b for a, b in zip(before, counts, strict=True)][:3] == [3, 1, 1]


@pytest.mark.parametrize(("index", "sub"), PARTS)
def test_an_entry_that_is_lacking_has_no_type_or_is_past_the_last(index: int, sub: int) -> None:
    """A gap below others has type, bits and access 0; past the last one there is no sub-index."""
    operation, data = asked(lacking((index, sub)), "05000000", index, f"{sub:02x}00")
    if sub == MEMBERS[index][-1]:
        assert (operation, data) == (ERROR, struct.pack("<I", NO_SUB_INDEX))
        return
    assert (operation, data) == (ENTRY, struct.pack("<HBBHHH", index, sub, 0, 0, 0, 0))


@pytest.mark.parametrize(
    ("index", "kind"),
    [(0x60E3, I8), (0x607D, 0), (0x60D0, 0), (0x60C2, 0), (0x1018, 0), (0x1010, U32),
     (0x1C00, U8), (0x1C12, U16), (0x1600, 0), (0x6040, U16), (0x6060, I8), (0x607A, I32),
     (0x6071, I16)],
)  # fmt: skip
@pytest.mark.parametrize("sub", [None, 1, 2])
def test_an_array_has_the_type_of_its_members_and_a_record_none(
    index: int, kind: int, sub: int | None
) -> None:
    """Whatever member is lacking."""
    profile = DriveProfile() if sub is None else lacking((index, sub))
    operation, data = asked(profile, "03000000", index)
    assert operation == OBJECT
    assert struct.unpack_from("<HH", data) == (index, kind)


@pytest.mark.parametrize(("index", "sub"), PARTS)
def test_an_object_names_the_last_sub_index_that_it_has(index: int, sub: int) -> None:
    _, data = asked(lacking((index, sub)), "03000000", index)
    left = [n for n in (0, *MEMBERS[index]) if n != sub]
    assert data[4] == left[-1]


def access(profile: DriveProfile) -> tuple[ObjectAccess, Any]:
    line = Line(profile=profile)
    line.preop()
    store = line.drive.objects
    return ObjectAccess(store, described(profile)), store


@pytest.mark.parametrize(
    ("lacks", "members"),
    [("", (1, 2)), ("6099.1", (2,)), ("6099.2", (1,)), ("6091.1 607D.2", (1, 2))],
)
def test_an_object_as_a_whole_has_the_parts_that_there_are(
    lacks: str, members: tuple[int, ...]
) -> None:
    """Sub-index 0 in two bytes, then each of four bytes; both ways."""
    whole, store = access(DriveProfile(lacks=lacks))
    values = {1: 70_000, 2: 300}
    for sub in members:
        store.download(0x6099, sub, values[sub].to_bytes(4, "little"))
    count = store.upload(0x6099, 0) + b"\0"
    body = b"".join(values[sub].to_bytes(4, "little") for sub in members)
    assert whole.upload(0x6099, 0, complete=True) == count + body
    assert whole.upload(0x6099, 1, complete=True) == body
    written = b"".join((values[sub] + 1).to_bytes(4, "little") for sub in members)
    whole.download(0x6099, 1, written, complete=True)
    assert [store.value(0x6099, sub) for sub in members] == [values[sub] + 1 for sub in members]
    with pytest.raises(SdoAbortedError) as caught:
        whole.download(0x6099, 1, written + b"\0", complete=True)
    assert caught.value.code == 0x06070012


@pytest.mark.parametrize(
    ("index", "sub", "code"),
    [(0x60BA, 0, NO_OBJECT), (0x2000, 0, NO_OBJECT), (0x6099, 2, NO_SUB_INDEX),
     (0x6041, 0, NO_COMPLETE_ACCESS), (0x6041, 1, NO_COMPLETE_ACCESS)],
)  # fmt: skip
def test_what_cannot_be_read_as_a_whole_is_refused(index: int, sub: int, code: int) -> None:
    whole, _ = access(DriveProfile(lacks="60BA"))
    with pytest.raises(SdoAbortedError) as caught:
        whole.upload(index, sub, complete=True)
    assert caught.value.code == code


def test_rows_of_the_communication_come_before_those_of_the_profile() -> None:
    """Each object once, by rising index; EtherCAT has none of the PDO parameters of CANopen."""
    indices = list(dict.fromkeys(row.index for row in rows()))
    assert indices == sorted(indices)
    assert not [index for index in indices if 0x1400 <= index < 0x1600 or 0x1800 <= index < 0x1A00]
    communication = [index for index in indices if index < 0x6000]
    assert {0x1000, 0x1018, 0x1600, 0x1A00, 0x1C12, 0x1C13, 0x1C32} <= set(communication)
    assert len(communication) < len(indices)
