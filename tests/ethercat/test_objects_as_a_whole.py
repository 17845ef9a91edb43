"""Objects as a whole (complete access) and what SDO information lists: sizes, members, gaps.

Sizes in bytes by hand: two of sub-index 0, then the members in their order.
"""

import struct

import pytest
from canopen.sdo.exceptions import SdoAbortedError
from tests.ethercat.line import Line

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.object_access import ObjectAccess
from axisrig.bench.drive.ethercat.objects import described

NO_OBJECT, NO_SUB_INDEX = 0x0602_0000, 0x0609_0011
TOO_LONG, TOO_SHORT, READ_ONLY = 0x0607_0012, 0x0607_0013, 0x0601_0002
INCOMPATIBLE, NOT_ALLOWED = 0x0604_0043, 0x0609_0030

MEMBERS = {
    0x607D: 2 * 4,  # two I32
    0x60C2: 1 + 1,  # U8, I8
    0x6091: 2 * 4,
    0x60D0: 2 * 2,  # two I16
    0x1600: 16 * 4,
    0x1C13: 2 * 2,
}


def drive(lacks: str = "") -> tuple[Line, ObjectAccess]:
    profile = DriveProfile(lacks=lacks)
    line = Line(profile=profile)
    line.preop()
    return line, ObjectAccess(line.drive.objects, described(profile))


def refused(access: ObjectAccess, index: int, sub: int, size: int, *, complete: bool) -> int:
    try:
        access.check_size(index, sub, size, complete=complete)
    except SdoAbortedError as error:
        return int(error.code)
    return 0


@pytest.mark.parametrize("sub", [0, 1])
@pytest.mark.parametrize("index", MEMBERS)
def test_a_whole_object_takes_its_bytes_and_not_one_more(index: int, sub: int) -> None:
    """From sub-index 1 on without the two bytes of sub-index 0; fewer are the first members."""
    _, access = drive()
    size = MEMBERS[index] + (2 if sub == 0 else 0)
    found = [refused(access, index, sub, size + more, complete=True) for more in (-1, 0, 1, 2, 100)]
    assert found == [0, 0, TOO_LONG, TOO_LONG, TOO_LONG]
    with pytest.raises(SdoAbortedError) as caught:
        access.download(index, sub, bytes(size + 1), complete=True)
    assert caught.value.code == TOO_LONG


@pytest.mark.parametrize(
    ("index", "sub", "size"),
    [
        (0x6060, 0, 1),
        (0x6040, 0, 2),
        (0x6065, 0, 4),
        (0x607D, 1, 4),
        (0x60C2, 1, 1),
        (0x60D0, 2, 2),
    ],
)
def test_a_single_value_takes_its_bytes_alone(index: int, sub: int, size: int) -> None:
    _, access = drive()
    found = [refused(access, index, sub, at, complete=False) for at in range(size - 1, size + 3)]
    assert found == [TOO_SHORT, 0, TOO_LONG, TOO_LONG]


@pytest.mark.parametrize(
    ("index", "sub", "complete", "code"),
    [
        (0x2000, 0, True, NO_OBJECT),
        (0x2000, 0, False, NO_OBJECT),
        (0x607D, 2, True, NO_SUB_INDEX),  # as a whole from 0 or 1 on
        (0x607D, 3, False, NO_SUB_INDEX),
        (0x6040, 0, True, 0x0601_0004),  # a variable
        (0x6041, 0, False, READ_ONLY),
    ],
)
def test_what_cannot_be_written_is_refused_before_its_bytes(
    index: int, sub: int, complete: bool, code: int
) -> None:
    _, access = drive()
    assert refused(access, index, sub, 4, complete=complete) == code


def test_the_first_members_are_written_and_the_others_stay() -> None:
    """607D: min and max; 4 bytes from sub-index 1 on are the min alone, 6 with its number."""
    _, access = drive()
    access.download(0x607D, 0, struct.pack("<Hii", 2, -500, 700), complete=True)
    for data, sub, low in (
        (struct.pack("<i", -90), 1, -90),
        (struct.pack("<Hi", 2, -80), 0, -80),
    ):
        access.download(0x607D, sub, data, complete=True)
        assert access.upload(0x607D, 1, complete=True) == struct.pack("<ii", low, 700)
        assert access.upload(0x607D, 0, complete=True) == struct.pack("<Hii", 2, low, 700)


@pytest.mark.parametrize(
    ("index", "data"),
    [(0x607D, "02000cfeffffbc020000"), (0x1C12, "01000016"), (0x60C2, "020002fd")],
)
def test_a_write_of_nothing_is_too_short_for_the_number_of_members(index: int, data: str) -> None:
    """Whether the number can be written or not; from sub-index 1 on nothing is written."""
    line, access = drive()
    access.download(index, 0, bytes.fromhex(data), complete=True)
    before = access.upload(index, 0, complete=True)
    head = struct.pack("<BHB", 0x31, index, 0)
    _, answer = line.coe(head + bytes(4))
    assert (answer[0], int.from_bytes(answer[4:8], "little")) == (0x80, TOO_SHORT)
    access.download(index, 1, b"", complete=True)
    assert access.upload(index, 0, complete=True) == before


# PDOs that are assigned twice


@pytest.mark.parametrize("is_whole", [True, False])
@pytest.mark.parametrize(
    ("index", "first", "second"), [(0x1C12, 0x1600, 0x1601), (0x1C13, 0x1A00, 0x1A01)]
)
def test_a_pdo_is_assigned_once_in_either_direction(
    index: int, first: int, second: int, is_whole: bool
) -> None:
    for entries, code in (
        ((first, first), INCOMPATIBLE), ((second, second), INCOMPATIBLE), ((first, second), 0),
        ((second, first), 0), ((second,), 0), ((), 0),
    ):  # fmt: skip
        line, access = drive()
        if is_whole:
            data = struct.pack(f"<H{len(entries)}H", len(entries), *entries)
            try:
                access.download(index, 0, data, complete=True)
                found = 0
            except SdoAbortedError as error:
                found = error.code
        else:
            line.sdo_write(index, 0, 0, 1)
            for sub, entry in enumerate(entries, 1):
                assert line.sdo_write(index, sub, entry, 2) == 0
            found = line.sdo_write(index, 0, len(entries), 1)
        assert found == code
        store = line.drive.objects
        if is_whole and code:  # as before
            assert [store.value(index, sub) for sub in (0, 1)] == [1, first]
        elif not code:
            places = range(1, len(entries) + 1)
            assert store.value(index, 0) == len(entries)
            assert tuple(store.value(index, sub) for sub in places) == entries


def test_an_object_may_be_mapped_twice() -> None:
    """That is for PDOs alone: 6064 in two places of the inputs."""
    line, _ = drive()
    entries = (0x6064_0020, 0x6041_0010, 0x6064_0020)
    line.sdo_write(0x1A00, 0, 0, 1)
    for sub, entry in enumerate(entries, 1):
        assert line.sdo_write(0x1A00, sub, entry, 4) == 0
    assert line.sdo_write(0x1A00, 0, 3, 1) == 0


# What a drive lacks


def entry(line: Line, index: int, sub: int) -> tuple[int, int]:
    """Bits of an entry by SDO information (0: a gap), and the abort code."""
    _, body = line.coe(struct.pack("<BBHHBB", 5, 0, 0, index, sub, 0), service=8)
    if body[0] == 7:
        return 0, int.from_bytes(body[4:8], "little")
    return struct.unpack_from("<H", body, 10)[0], 0


def last_sub(line: Line, index: int) -> int | None:
    _, body = line.coe(struct.pack("<BBHH", 3, 0, 0, index), service=8)
    return None if body[0] == 7 else body[8]


@pytest.mark.parametrize(
    ("lacks", "last", "bits"),
    [
        ("", 2, [(16, 0), (16, 0)]),
        ("60D0.2", 1, [(16, 0), (0, NO_SUB_INDEX)]),
        ("60D0.1", 2, [(0, 0), (16, 0)]),  # a gap
        ("60D0", None, [(0, NO_OBJECT), (0, NO_OBJECT)]),
        ("60D1", 2, [(16, 0), (16, 0)]),  # another one
    ],
)
def test_information_lists_what_the_drive_has_and_nothing_else(
    lacks: str, last: int | None, bits: list[tuple[int, int]]
) -> None:
    line, access = drive(lacks)
    assert last_sub(line, 0x60D0) == last
    assert [entry(line, 0x60D0, sub) for sub in (1, 2)] == bits
    for sub, (length, _) in enumerate(bits, 1):
        if length:
            assert len(access.upload(0x60D0, sub, complete=False)) == length // 8
        else:
            with pytest.raises(SdoAbortedError) as caught:
                access.upload(0x60D0, sub, complete=False)
            assert caught.value.code == (NO_OBJECT if last is None else NO_SUB_INDEX)


@pytest.mark.parametrize(
    ("lacks", "members"),
    [("", (1, 2)), ("60D0.2", (1,)), ("60D0.1", (2,))],
)
def test_a_whole_object_has_the_members_that_the_drive_has(
    lacks: str, members: tuple[int, ...]
) -> None:
    """Trigger sources at power on: 1 of probe 1, 2 of probe 2."""
    _, access = drive(lacks)
    data = struct.pack(f"<{len(members)}h", *members)
    assert access.upload(0x60D0, 1, complete=True) == data
    assert access.upload(0x60D0, 0, complete=True)[2:] == data
    assert refused(access, 0x60D0, 1, len(data), complete=True) == 0
    assert refused(access, 0x60D0, 1, len(data) + 1, complete=True) == TOO_LONG
    access.download(0x60D0, 1, struct.pack(f"<{len(members)}h", *(6,) * len(members)),
                    complete=True)  # fmt: skip
    assert access.upload(0x60D0, 1, complete=True) == struct.pack("<h", 6) * len(members)


@pytest.mark.parametrize(
    ("index", "size", "count", "entries"),
    [
        (0x1C12, 2, 1, (0x1601,)),
        (0x1C12, 2, 1, (0x1601, 0x1600)),  # the second is there and counts not
        (0x1C12, 2, 0, (0x1601,)),
        (0x1C13, 2, 2, (0x1A01, 0x1A00)),
        (0x1600, 4, 2, (0x607A_0020, 0x6040_0010)),
        (0x1600, 4, 3, (0x607A_0020,)),
    ],
)
def test_a_list_that_is_written_from_its_first_entry_on_keeps_its_number(
    index: int, size: int, count: int, entries: tuple[int, ...]
) -> None:
    """Sub-index 0 is not among the bytes, so the number of entries stays what it was."""
    line, access = drive()
    line.sdo_write(index, 0, 0, 1)
    known = {0x1C12: (0x1600,), 0x1C13: (0x1A00, 0x1A01)}.get(
        index, (0x6040_0010, 0x607A_0020, 0x60B8_0010)
    )
    for sub, entry in enumerate(known, 1):
        assert line.sdo_write(index, sub, entry, size) == 0
    assert line.sdo_write(index, 0, count, 1) == 0
    access.download(index, 1, b"".join(e.to_bytes(size, "little") for e in entries), complete=True)
    store = line.drive.objects
    assert store.value(index, 0) == count
    found = [store.value(index, sub) for sub in range(1, len(known) + 1)]
    assert found[: len(entries)] == list(entries[: len(known)])
    assert found[len(entries) :] == list(known[len(entries) :])
