"""#IDENT RD: the number that a program gets, by kind, width and bits of the value."""

from typing import Any

import pytest
from tests.sercos.test_drive_by_hand import Bench

from axisrig.kernel.drives.sercos.accesses import BOTH, SercosAccesses
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import DriveRead, DriveWrite
from axisrig.kernel.profiles.sercos.service import Attribute, Kind, ident_number

BLOCK = Block(1, 10, "")
KEY = "S-0-0092"
UNSIGNED = (Kind.BINARY, Kind.UNSIGNED, Kind.HEXADECIMAL, Kind.IDENT)
WIDTHS = (1, 2, 4)


class Program:
    """The accesses of two axes, whose questions the test answers."""

    def __init__(self) -> None:
        self.benches = {axis: Bench() for axis in ("Y", "Z")}
        self.accesses = SercosAccesses({axis: made.drive for axis, made in self.benches.items()})

    def reads(self, attribute: Attribute, value: bytes, axis: str = "Z", key: str = KEY) -> float:
        self.accesses.begin(DriveRead(BLOCK, axis, key, attribute.width))
        channel = self.benches[axis].channel
        assert channel.asked[-1] == (ident_number(key.upper()), BOTH)
        assert self.accesses.is_waiting
        channel.answer(attribute.pack() + value)
        assert not self.accesses.is_waiting
        self.accesses.check()
        return self.accesses.value(axis, key)


@pytest.mark.parametrize("width", WIDTHS)
def test_a_signed_value_is_the_complement_of_two(width: int) -> None:
    """All bits: -1; the highest alone: -2^(n-1); all but it: 2^(n-1) - 1."""
    program, attribute = Program(), Attribute(Kind.SIGNED, width)
    ones, top = b"\xff" * width, bytes(width - 1) + b"\x80"
    most = b"\xff" * (width - 1) + b"\x7f"
    half = 2.0 ** (8 * width - 1)
    for value, number in ((ones, -1.0), (top, -half), (most, half - 1), (bytes(width), 0.0)):
        assert program.reads(attribute, value) == number
    assert program.reads(attribute, b"\xfe" + b"\xff" * (width - 1)) == -2.0


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("kind", UNSIGNED)
def test_any_other_value_is_never_negative(kind: Kind, width: int) -> None:
    program, attribute = Program(), Attribute(kind, width)
    assert program.reads(attribute, b"\xff" * width) == 2.0 ** (8 * width) - 1
    assert program.reads(attribute, bytes(width - 1) + b"\x80") == 2.0 ** (8 * width - 1)


def test_each_axis_and_each_ident_keep_their_own_value() -> None:
    program, signed = Program(), Attribute(Kind.SIGNED, 2)
    wanted = {("Y", KEY): -300, ("Z", KEY): 300, ("Z", "p-0-0001"): -7}
    for (axis, key), number in wanted.items():
        data = number.to_bytes(2, "little", signed=True)
        assert program.reads(signed, data, axis, key) == number
    for (axis, key), number in wanted.items():
        assert program.accesses.value(axis, key) == program.accesses.value(axis, key.upper())
        assert program.accesses.value(axis, key) == number


@pytest.mark.parametrize("width", WIDTHS)
def test_a_negative_value_is_written_to_signed_idents_as_it_is_read(width: int) -> None:
    program, attribute = Program(), Attribute(Kind.SIGNED, width)
    channel: Any = program.benches["Z"].channel
    for number in (-1, -(2 ** (8 * width - 1)), 2 ** (8 * width - 1) - 1, 0):
        program.accesses.begin(DriveWrite(BLOCK, "Z", KEY, float(number), True, width))
        channel.answer(attribute.pack())
        ident, data = channel.asked[-1]
        channel.answer()
        program.accesses.check()
        assert (ident, len(data)) == (ident_number(KEY), width)
        assert program.reads(attribute, data) == number
