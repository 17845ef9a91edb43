"""#COMMAND WAIT: which procedure commands of an axis a program waits for, by hand."""

from typing import Any

import pytest
from tests.sercos.test_drive_by_hand import Bench

from axisrig.kernel.drives.sercos.accesses import SercosAccesses
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import DriveWait, DriveWrite
from axisrig.kernel.profiles.sercos.service import Attribute, Element, Kind, ident_number

BLOCK = Block(1, 10, "")
FIRST, SECOND, THIRD = "S-0-0099", "S-0-0170", "S-0-0127"
RUNNING, DONE, FAILED = b"\x07\0", b"\x03\0", b"\x0f\0"
COMMAND = Attribute(Kind.BINARY, 2, is_command=True).pack()
START = b"\x03\0"


class Program:
    """The accesses of two axes; asked: of Z since the last look."""

    def __init__(self) -> None:
        self.benches = {axis: Bench() for axis in ("Y", "Z")}
        self.accesses = SercosAccesses({axis: made.drive for axis, made in self.benches.items()})
        self.channel = self.benches["Z"].channel

    def starts(self, *keys: str, attribute: bytes = COMMAND) -> None:
        for key in keys:
            command = DriveWrite(BLOCK, "Z", key, 3.0, False, 2, is_command=True)
            self.accesses.begin(command)
            self.channel.answer(attribute)
            assert self.asked()[-1] == (ident_number(key), START)
            self.channel.answer()

    def asked(self) -> list[tuple[int, Any]]:
        found = list(self.channel.asked)
        self.channel.asked.clear()
        return found


def states(*keys: str) -> list[tuple[int, Any]]:
    return [(ident_number(key), Element.DATA_STATE) for key in keys]


@pytest.mark.parametrize(
    ("key", "waited"), [("", [FIRST, SECOND, THIRD]), (SECOND, [SECOND]), (FIRST, [FIRST])]
)
def test_without_a_name_all_commands_that_were_started_are_waited_for(
    key: str, waited: list[str]
) -> None:
    """Each is cancelled once it has ended; what has ended is waited for no more."""
    program = Program()
    program.starts(FIRST, SECOND, THIRD)
    program.accesses.begin(DriveWait(BLOCK, "Z", commands=True, key=key))
    assert program.asked() == states(*waited)
    for name in waited:
        assert program.accesses.is_waiting
        program.channel.answer(DONE)
        assert program.asked() == [(ident_number(name), bytes(2))]
    for _ in waited:
        assert program.accesses.is_waiting
        program.channel.answer()
    assert not program.accesses.is_waiting
    program.accesses.check()
    program.accesses.begin(DriveWait(BLOCK, "Z", commands=True))
    rest = [name for name in (FIRST, SECOND, THIRD) if name not in waited]
    assert program.asked() == states(*rest)


def test_what_was_started_by_another_axis_or_without_commands_is_not_waited_for() -> None:
    program = Program()
    program.starts(FIRST)
    program.accesses.begin(DriveWait(BLOCK, "Y", commands=True))
    program.accesses.begin(DriveWait(BLOCK, "Z"))
    assert (program.asked(), program.benches["Y"].channel.asked) == ([], [])
    assert not program.accesses.is_waiting


@pytest.mark.parametrize("key", [FIRST, THIRD])
def test_a_value_that_is_written_is_no_command_that_was_started(key: str) -> None:
    """#IDENT WR of the ident of a procedure command, before and behind a command."""
    program = Program()
    for keys in ((), (SECOND,), (SECOND, SECOND)):
        program.starts(*keys)
        program.accesses.begin(DriveWrite(BLOCK, "Z", key, 3.0, False, 2))
        program.channel.answer(COMMAND)
        assert program.asked()[-1] == (ident_number(key), START)
        program.channel.answer()
        program.accesses.begin(DriveWait(BLOCK, "Z", commands=True))
        assert program.asked() == states(*keys)
        for _ in keys:
            program.channel.answer(DONE)
        program.asked()
        for _ in keys:
            program.channel.answer()
        assert not program.accesses.is_waiting


def test_a_command_that_has_failed_is_cancelled_and_is_an_alarm() -> None:
    program = Program()
    program.starts(FIRST, SECOND)
    program.accesses.begin(DriveWait(BLOCK, "Z", commands=True))
    program.channel.answer(FAILED)
    program.channel.answer(DONE)
    program.channel.answer()
    program.channel.answer()
    with pytest.raises(Alarm) as caught:
        program.accesses.check()
    assert (caught.value.id, caught.value.values["key"], caught.value.values["state"]) == (
        900748, FIRST, "0xF",
    )  # fmt: skip
    program.accesses.check()


def test_an_ident_that_is_no_command_is_not_started() -> None:
    program = Program()
    command = DriveWrite(BLOCK, "Z", FIRST, 3.0, True, 2, is_command=True)
    program.accesses.begin(command)
    program.asked()
    program.channel.answer(Attribute(Kind.UNSIGNED, 2).pack())
    assert program.asked() == []
    with pytest.raises(Alarm) as caught:
        program.accesses.check()
    assert caught.value.id == 900749
    program.accesses.begin(DriveWait(BLOCK, "Z", commands=True))
    assert program.asked() == []
