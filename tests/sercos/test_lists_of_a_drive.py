"""Lists and texts in the idents of a SERCOS drive: how many elements they have and may have."""

import struct

import pytest
from tests.sercos.test_sercos_faults_by_hand import Hand

from axisrig.bench.drive.sercos.idents import rows
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.profiles.sercos.service import (
    HEADER,
    Element,
    Header,
    Operation,
    ident_name,
    ident_number,
    pack_list,
    read_list,
    read_text,
)

MOST = {
    "S-0-0016": 32, "S-0-0017": 512, "S-0-0021": 64, "S-0-0022": 64, "S-0-0024": 32,
    "S-0-0025": 32, "S-0-0292": 8,
}  # fmt: skip
"""Elements that a list may have, all of two bytes (docs/sercos.md)."""
PROFILES = {"one_probe": "both", "two_probes": "both two"}
WRITABLE = ("S-0-0016", "S-0-0024")


def preop(profile: str = "one_probe") -> Hand:
    hand = Hand(profile=profile)
    hand.drive.states.state = AlState.PREOP  # phase 2
    return hand


def read(hand: Hand, ident: str) -> bytes:
    """The value, which may come in fragments."""
    head = Header(Operation.READ, 0, Element.VALUE, ident_number(ident))
    return b"".join(part[HEADER.size :] for part in hand.drive.channel.serve(head.pack()))


def test_these_are_all_its_lists() -> None:
    assert [row["ident"] for row in rows() if row["form"] == "list"] == [*MOST]


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("ident", MOST)
def test_a_list_says_how_many_bytes_it_has_and_may_have(ident: str, profile: str) -> None:
    """SERCOS: two words, the length and the largest length, both in bytes; after power on."""
    hand = preop(profile)
    hand.drive.idents.reset()
    data = read(hand, ident)
    length, largest = struct.unpack_from("<HH", data)
    assert (len(data), largest) == (4 + length, 2 * MOST[ident])


@pytest.mark.parametrize("ident", WRITABLE)
@pytest.mark.parametrize("count", [0, 1, 16, 17, 31, 32])
def test_a_list_takes_as_many_elements_as_it_may_have(ident: str, count: int) -> None:
    hand, items = preop(), [ident_number(f"S-0-{n:04}") for n in range(100, 100 + count)]
    assert hand.written(ident, pack_list(items, 2, MOST[ident])) is None
    assert read_list(read(hand, ident), 2) == items
    assert hand.drive.idents.items(ident_number(ident)) == items


@pytest.mark.parametrize("ident", WRITABLE)
@pytest.mark.parametrize("count", [33, 34, 64])
def test_a_list_with_one_element_too_many_is_refused_and_stays(ident: str, count: int) -> None:
    hand = preop()
    before = read(hand, ident)
    assert hand.written(ident, pack_list([1] * count, 2, count)) == "LONG"
    assert read(hand, ident) == before


@pytest.mark.parametrize(
    ("data", "code"),
    [
        (struct.pack("<HHB", 1, 64, 0), "INVALID"),  # half an element
        (struct.pack("<HHHB", 3, 64, 0, 0), "INVALID"),
        (struct.pack("<HH", 2, 64), "SHORT"),  # it is announced and is missing
        (struct.pack("<HHHH", 2, 64, 0, 0), "LONG"),  # one more than announced
        (struct.pack("<H", 0), "SHORT"),
        (b"", "SHORT"),
    ],
)
def test_a_list_whose_length_is_not_that_of_its_elements_is_refused(data: bytes, code: str) -> None:
    hand = preop()
    before = read(hand, "S-0-0016")
    assert hand.written("S-0-0016", data) == code
    assert read(hand, "S-0-0016") == before


@pytest.mark.parametrize("ident", [ident for ident in MOST if ident not in WRITABLE])
def test_a_list_that_is_the_drives_own_is_not_written(ident: str) -> None:
    assert preop().written(ident, pack_list([], 2, MOST[ident])) == "READ_ONLY"


@pytest.mark.parametrize("profile", PROFILES)
def test_the_list_of_all_idents_is_that_of_the_drive(profile: str) -> None:
    """A drive with one probe lacks the idents of the second; each that is listed can be read."""
    hand = preop(profile)
    listed = read_list(read(hand, "S-0-0017"), 2)
    wanted = [row["ident"] for row in rows() if row["drives"] in PROFILES[profile].split()]
    assert [ident_name(number) for number in listed] == wanted
    assert ("S-0-0402" in wanted) is (profile == "two_probes")
    for ident in wanted:
        assert isinstance(hand.ask(Operation.READ, ident), bytes), ident
    for row in rows():
        if row["ident"] not in wanted:
            assert hand.ask(Operation.READ, row["ident"]) == "NO_IDENT"


@pytest.mark.parametrize("profile", PROFILES)
def test_the_procedure_commands_of_a_drive_are_listed(profile: str) -> None:
    """Reset of class 1, both checks of a transition, and the probing cycle."""
    listed = read_list(read(preop(profile), "S-0-0025"), 2)
    assert [ident_name(n) for n in listed] == ["S-0-0099", "S-0-0127", "S-0-0128", "S-0-0170"]


def test_modes_of_the_drive_are_listed_and_each_of_them_is_taken() -> None:
    """S-0-0032: 3 is position with feedback 1, 11 the same without lag."""
    hand = preop()
    assert read_list(read(hand, "S-0-0292"), 2) == [3, 11]
    for mode in (3, 11):
        assert hand.written("S-0-0032", mode.to_bytes(2, "little")) is None
        assert hand.number("S-0-0032") == mode
    assert hand.written("S-0-0032", b"\x02\x00") == "INVALID"


def test_power_on_gives_lists_and_texts_back_what_they_had() -> None:
    hand = preop()
    table = hand.drive.idents
    table.put_list(ident_number("S-0-0016"), [ident_number("S-0-0051")] * 3)
    table.put_list(ident_number("S-0-0021"), [1, 2, 3])
    hand.fault(0x2310)
    hand.cycle(0)
    assert hand.text()
    table.reset()
    assert read_list(read(hand, "S-0-0016"), 2) == [ident_number("S-0-0051")]
    assert read_list(read(hand, "S-0-0024"), 2) == [ident_number("S-0-0047")]
    assert read_list(read(hand, "S-0-0021"), 2) == []
    assert read_text(read(hand, "S-0-0095")) == ""


@pytest.mark.parametrize("count", [0, 1, 64])
def test_a_list_of_the_drive_takes_as_many_as_it_may_have(count: int) -> None:
    hand, items = preop(), list(range(count))
    hand.drive.idents.put_list(ident_number("S-0-0022"), items)
    data = read(hand, "S-0-0022")
    assert struct.unpack_from("<HH", data) == (2 * count, 128)
    assert hand.drive.idents.items(ident_number("S-0-0022")) == items


def test_the_text_of_a_fault_has_its_length_and_its_largest_one() -> None:
    """60 signs of one byte each."""
    hand = preop()
    for code in (0x2310, 0x1234):
        hand.fault(code)
        data = read(hand, "S-0-0095")
        assert struct.unpack_from("<HH", data) == (len(data) - 4, 60)
        assert len(data) > 4


@pytest.mark.parametrize("state", [AlState.SAFEOP, AlState.OP])
@pytest.mark.parametrize("ident", WRITABLE)
def test_what_a_telegram_carries_is_protected_from_phase_3_on(ident: str, state: AlState) -> None:
    hand = preop()
    hand.drive.states.state = state
    assert hand.written(ident, pack_list([], 2, 32)) == "PROTECTED"
