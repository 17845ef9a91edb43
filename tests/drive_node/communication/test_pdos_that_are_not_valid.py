"""PDOs that are not valid, a master that stays away, LSS frames in another order."""

import struct
from collections.abc import Callable, Sequence
from typing import Any

import pytest
from tests.drive_node.communication.test_lss_by_frames import IDENTITY, Slave

from axisrig.kernel.profiles.cia402.ds402 import State

Make = Callable[..., Any]
NOT_VALID = 1 << 31
LOST = (0x083, "3081110000000000")
IDENTIFIED = ["4f00000000000000"]


@pytest.mark.parametrize("number", [0, 1])
def test_an_rpdo_that_is_not_valid_is_not_taken(stranger: Make, number: int) -> None:
    """Bit 31 of its COB-ID; valid again it is, off and on. The other one passes all the time."""
    drive = stranger()
    index, cob_id = 0x1400 + number, 0x203 + 0x100 * number
    fields = [(0x6040, 16), (0x607A, 32), (0x60B8, 16)]
    for entry in (0x1600, 0x1601):  # both carry the same three
        pdo = entry - 0x200
        own = drive.read(pdo, 1) & 0x7FF or 0x203 + 0x100 * (entry - 0x1600)
        assert drive.write(pdo, 1, own | NOT_VALID, 4) == 0
        assert drive.write(entry, 0, 0, 1) == 0
        for sub, (mapped, bits) in enumerate(fields, 1):
            assert drive.write(entry, sub, mapped << 16 | bits, 4) == 0
        assert drive.write(entry, 0, len(fields), 1) == 0
        assert drive.write(pdo, 1, own, 4) == 0
    drive.nmt(1)
    image = drive.node.servo.image
    target = 0
    for is_valid in (True, False, True, False):
        valid = cob_id if is_valid else cob_id | NOT_VALID
        assert drive.write(index, 1, valid, 4) == 0
        other = 0x203 + 0x100 * (1 - number)
        for can_id, is_taken in ((cob_id, is_valid), (other, True)):
            target += 1000
            before = image.target_position
            drive.send(can_id, struct.pack("<HiH", 0, target, 0).hex())
            drive.run_ms(0.5)
            drive.after(0x80)
            assert image.target_position == (target if is_taken else before)


def test_an_rpdo_that_is_not_valid_enables_nothing(stranger: Make) -> None:
    drive = stranger()
    assert drive.write(0x1400, 1, 0x203 | NOT_VALID, 4) == 0
    drive.nmt(1)
    for controlword in ("0600", "0700", "0f00"):
        drive.send(0x203, controlword + "000000000000")
        drive.run_ms(0.5)
        drive.after(0x80)
    assert drive.node.state is State.SWITCH_ON_DISABLED


@pytest.mark.parametrize(("index", "value", "size"), [(0x100C, 30, 2), (0x100D, 3, 1)])
def test_a_master_that_stays_away_is_missed_with_another_life_time_too(
    stranger: Make, index: int, value: int, size: int
) -> None:
    """100C times 100D; only without any life time is nobody missed."""
    drive = stranger()
    assert drive.write(0x1017, 0, 0, 2) == 0
    for own, (at, width) in {10: (0x100C, 2), 2: (0x100D, 1)}.items():
        assert drive.write(at, 0, own, width) == 0
    drive.after(0x703, remote=True)
    drive.run_ms(25)
    assert drive.frames(0x083) == [LOST[1]]
    assert drive.write(index, 0, value, size) == 0
    drive.run_ms(5)
    assert drive.frames(0x083) == [LOST[1]]
    assert drive.read(0x1001) & 1 << 4
    assert drive.write(index, 0, 0, size) == 0
    drive.run_ms(5)
    assert drive.frames(0x083) == [LOST[1], "0000000000000000"]


def identified(order: Sequence[int]) -> bool:
    """Ask for the own identity, with the numbers of the frames in another order."""
    vendor, product, revision, serial = IDENTITY
    numbers = (vendor, product, revision, revision, serial, serial)
    slave, answers = Slave(), list[str]()
    for place, number in zip(order, numbers, strict=True):
        answers += slave.ask(0x46 + place, *struct.pack("<I", number))
    assert answers in ([], IDENTIFIED)
    return bool(answers)


@pytest.mark.parametrize(
    "order",
    [(0, 1, 3, 2, 4, 5), (0, 1, 2, 3, 5, 4), (0, 2, 1, 3, 4, 5), (0, 1, 2, 2, 4, 5),
     (0, 1, 2, 3, 4, 4), (1, 0, 2, 3, 4, 5)],
)  # fmt: skip
def test_an_identity_is_asked_for_in_the_order_of_its_numbers(order: tuple[int, ...]) -> None:
    """46h to 4Bh: what comes out of turn identifies nobody."""
    assert identified(range(6))
    assert not identified(order)
