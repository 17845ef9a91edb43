"""RPDOs that are not valid: bit 31 of their COB-ID."""

import struct
from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.profiles.cia402.ds402 import State

Make = Callable[..., Any]
NOT_VALID = 1 << 31


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
