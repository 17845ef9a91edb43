"""#IDENT and #COMMAND that fail: which alarm comes up, what it names, and what goes on."""

from collections.abc import Callable
from typing import Any

import pytest
from tests.sercos.test_waits_for_commands import COMMAND, DONE, FIRST, RUNNING, SECOND, Program

from axisrig.kernel.drives.sercos.service_channel import SoeError
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import DriveRead, DriveWait, DriveWrite
from axisrig.kernel.profiles.sercos.service import (
    Attribute,
    Element,
    Kind,
    ident_number,
    pack_list,
)

KEY = "S-0-0092"
U16 = Attribute(Kind.UNSIGNED, 2)
INVALID = 0x7002
"""An error code of the service channel: too short."""


def block(number: int) -> Block:
    return Block(number, 10 * number, "")


def read(number: int = 1, key: str = KEY, length: int | None = 2, axis: str = "Z") -> DriveRead:
    return DriveRead(block(number), axis, key, length)


def write(
    value: float = 5.0, number: int = 1, *, key: str = KEY, length: int | None = 2, **more: Any
) -> DriveWrite:
    return DriveWrite(block(number), "Z", key, value, more.pop("waits", True), length, **more)


def alarm_of(program: Program) -> Alarm:
    """The alarm of the next cycle; there is none in the one after it."""
    with pytest.raises(Alarm) as caught:
        program.accesses.check()
    program.accesses.check()
    return caught.value


# Several failures


def test_of_several_failures_in_one_cycle_the_first_one_comes_up() -> None:
    """Refusals, a length and a value that does not fit: whichever is first, and only it."""

    def refused(program: Program, number: int) -> None:
        program.accesses.begin(read(number))
        program.channel.refuse(INVALID)

    def too_long(program: Program, number: int) -> None:
        program.accesses.begin(read(number, length=4))
        program.channel.answer(U16.pack() + bytes(2))

    def too_large(program: Program, number: int) -> None:
        program.accesses.begin(write(65_536.0, number))
        program.channel.answer(U16.pack())

    failures = {900032: refused, 900256: too_long, 900112: too_large}
    for first, fail_first in failures.items():
        for second, fail_second in failures.items():
            program = Program()
            fail_first(program, 3)
            fail_second(program, 4)
            alarm = alarm_of(program)
            assert (alarm.id, alarm.place) == (first, "line 3, block N30"), second
            fail_second(program, 5)  # in another cycle
            assert alarm_of(program).id == second


# Where an access fails


@pytest.mark.parametrize("code", [None, INVALID])
def test_a_refusal_names_the_ident_its_block_and_what_the_drive_answers(code: int | None) -> None:
    def read_refused(program: Program) -> None:
        program.accesses.begin(read(7))

    def attribute_refused(program: Program) -> None:
        program.accesses.begin(write(number=7))

    def value_refused(program: Program) -> None:
        program.accesses.begin(write(number=7))
        program.channel.answer(U16.pack())

    for begin in (read_refused, attribute_refused, value_refused):
        program = Program()
        begin(program)
        assert program.accesses.is_waiting
        assert program.accesses.is_busy
        program.channel.refuse(code)
        assert not program.accesses.is_waiting
        assert not program.accesses.is_busy
        alarm = alarm_of(program)
        assert (alarm.id, alarm.place) == (900032, "line 7, block N70")
        assert alarm.values == {
            "axis": "Z", "key": KEY, "object": "service channel",
            "answer": str(SoeError(ident_number(KEY), code)),
        }  # fmt: skip


@pytest.mark.parametrize("at_end", [False, True])
def test_a_command_that_cannot_be_asked_or_cancelled_is_named_though_the_block_has_none(
    at_end: bool,
) -> None:
    program = Program()
    program.starts(FIRST, SECOND)
    program.accesses.begin(DriveWait(block(9), "Z", commands=True))
    program.asked()
    if at_end:
        program.channel.answer(DONE)
        program.channel.answer(DONE)
        program.channel.answer()  # the first one is cancelled
    else:
        program.channel.answer(DONE)
    program.channel.refuse(INVALID)
    alarm = alarm_of(program)
    assert (alarm.id, alarm.values["key"], alarm.place) == (900032, SECOND, "line 9, block N90")
    assert program.accesses.is_waiting is not at_end


def test_a_command_that_failed_is_that_alarm_even_if_it_cannot_be_cancelled() -> None:
    for state in (0x5, 0xF):
        program = Program()
        program.starts(FIRST)
        program.accesses.begin(DriveWait(block(2), "Z", commands=True))
        program.channel.answer(state.to_bytes(2, "little"))
        program.channel.refuse(INVALID)
        alarm = alarm_of(program)
        assert (alarm.id, alarm.values["state"]) == (900748, f"0x{state:X}")


@pytest.mark.parametrize("state", [0x0, 0x3])
def test_a_command_that_is_done_or_not_there_any_more_is_no_alarm(state: int) -> None:
    program = Program()
    program.starts(FIRST)
    program.accesses.begin(DriveWait(block(2), "Z", commands=True))
    program.channel.answer(RUNNING)
    program.channel.answer(RUNNING)
    assert program.asked() == [(ident_number(FIRST), Element.DATA_STATE)] * 3
    program.channel.answer(state.to_bytes(2, "little"))
    program.channel.answer()
    program.accesses.check()
    assert not program.accesses.is_waiting


# Lengths and values


@pytest.mark.parametrize(("length", "width"), [(2, 4), (4, 2), (2, 1), (4, 1), (4, 8), (2, 8)])
@pytest.mark.parametrize("writes", [False, True])
def test_a_length_that_is_not_that_of_the_ident_is_neither_read_nor_written(
    length: int, width: int, writes: bool
) -> None:
    program, attribute = Program(), Attribute(Kind.UNSIGNED, width).pack()
    if writes:
        program.accesses.begin(write(number=6, length=length))
        program.asked()
        program.channel.answer(attribute)
        assert program.asked() == []
    else:
        program.accesses.begin(read(6, length=length))
        program.channel.answer(attribute + bytes(width))
    alarm = alarm_of(program)
    assert (alarm.id, alarm.place) == (900256, "line 6, block N60")
    assert alarm.values == {
        "keyword": "TYP", "value": f"{length}", "allowed": f"{width} for {KEY}",
    }  # fmt: skip
    assert not program.accesses.is_busy


@pytest.mark.parametrize("width", [2, 4])
@pytest.mark.parametrize("kind", [Kind.UNSIGNED, Kind.SIGNED])
def test_a_value_beside_the_range_of_its_ident_is_not_written(kind: Kind, width: int) -> None:
    """0 to 2^n - 1, signed -2^(n-1) to 2^(n-1) - 1; the limits themselves are written."""
    bits, is_signed = 8 * width, kind is Kind.SIGNED
    low = -(1 << bits - 1) if is_signed else 0
    high = (1 << bits - is_signed) - 1
    for value in (low, high, low - 1, high + 1):
        program = Program()
        program.accesses.begin(write(float(value), 8, length=width))
        program.asked()
        program.channel.answer(Attribute(kind, width).pack())
        if low <= value <= high:
            data = value.to_bytes(width, "little", signed=is_signed)
            assert program.asked() == [(ident_number(KEY), data)]
            continue
        assert program.asked() == []
        alarm = alarm_of(program)
        assert (alarm.id, alarm.place) == (900112, "line 8, block N80")
        text = f"{bits} bits, {'signed' if is_signed else 'unsigned'}"
        assert alarm.values == {
            "axis": "Z", "key": KEY, "value": str(value), "data_type": text,
        }  # fmt: skip


@pytest.mark.parametrize(
    ("attribute", "what"),
    [
        (Attribute(Kind.IDENT, 2, is_list=True), "list"),
        (Attribute(Kind.UNSIGNED, 4, is_list=True), "list"),
        (Attribute(Kind.TEXT, 1), "text"),
    ],
)
@pytest.mark.parametrize("writes", [False, True])
def test_a_list_or_a_text_is_no_number(attribute: Attribute, what: str, writes: bool) -> None:
    """S-0-0017 has hundreds of items, which no number holds."""
    program = Program()
    if writes:
        program.accesses.begin(write(length=attribute.width))
        program.asked()
        program.channel.answer(attribute.pack())
        assert program.asked() == []
    else:
        program.accesses.begin(read(length=attribute.width))
        items = pack_list([1] * 400, attribute.width, 400)
        program.channel.answer(attribute.pack() + items)
    alarm = alarm_of(program)
    assert (alarm.id, alarm.place) == (900256, "line 1, block N10")
    assert alarm.values["allowed"] == f"none for {KEY}: it is a {what}"
    assert not program.accesses.is_busy


def test_what_was_read_before_stays_where_a_length_is_wrong() -> None:
    program = Program()
    for length, value in ((2, 7), (4, 8)):
        program.accesses.begin(read(length=length))
        program.channel.answer(U16.pack() + value.to_bytes(2, "little"))
    assert alarm_of(program).id == 900256
    assert program.accesses.value("Z", KEY) == 7.0


def test_a_wrong_length_is_the_alarm_where_the_value_does_not_fit_either() -> None:
    program = Program()
    program.accesses.begin(write(65_536.0, length=4))
    program.channel.answer(U16.pack())
    assert alarm_of(program).id == 900256


@pytest.mark.parametrize(("value", "number"), [(4.6, 5), (4.4, 4), (-4.6, -5), (-4.4, -4)])
def test_a_value_between_two_digits_is_rounded_to_the_nearest(value: float, number: int) -> None:
    program = Program()
    program.accesses.begin(write(value))
    program.channel.answer(Attribute(Kind.SIGNED, 2).pack())
    assert program.asked()[-1][1] == number.to_bytes(2, "little", signed=True)


# Names


@pytest.mark.parametrize("key", ["S-0-92", "92", "S-8-0001", "X-0-0001", "S-0-4096", "S-0-00920"])
@pytest.mark.parametrize("command", [read, write])
def test_what_is_no_ident_is_not_asked_for(key: str, command: Callable[..., Any]) -> None:
    program = Program()
    with pytest.raises(Alarm) as caught:
        program.accesses.begin(command(key=key))
    alarm = caught.value
    assert (alarm.id, alarm.values["axis"], alarm.values["ident"]) == (900255, "Z", key)
    assert program.asked() == []
    assert not program.accesses.is_busy
    assert not program.accesses.is_waiting


@pytest.mark.parametrize("command", [read, write])
def test_a_sercos_drive_has_no_drive_functions(command: Callable[..., Any]) -> None:
    program = Program()
    with pytest.raises(Alarm) as caught:
        program.accesses.begin(command(length=None))
    values = {"axis": "Z", "key": KEY, "known": "none"}
    assert (caught.value.id, caught.value.values) == (900110, values)
    assert program.asked() == []


# Waiting


@pytest.mark.parametrize("waits", [False, True])
def test_a_write_holds_the_program_only_where_it_asks_for_it(waits: bool) -> None:
    program = Program()
    program.accesses.begin(write(waits=waits))
    held = [program.accesses.is_waiting]
    program.channel.answer(U16.pack())
    held.append(program.accesses.is_waiting)
    assert held == [waits, waits]
    assert program.accesses.is_busy
    program.channel.answer()
    assert not program.accesses.is_waiting
    assert not program.accesses.is_busy


def test_after_a_reset_nothing_waits_and_a_command_is_asked_for_no_more() -> None:
    program = Program()
    program.starts(FIRST)
    program.accesses.begin(DriveWait(block(2), "Z", commands=True))
    program.accesses.reset()
    assert not program.accesses.is_waiting
    program.asked()
    program.channel.answer(RUNNING)
    assert program.asked() == []  # neither asked for again nor cancelled
    assert not program.accesses.is_busy
    program.accesses.check()
    program.starts(SECOND)
    program.accesses.begin(DriveWait(block(3), "Z", commands=True))
    assert program.asked() == [(ident_number(SECOND), Element.DATA_STATE)]
    program.channel.answer(RUNNING)  # the wait of the next program goes on
    assert program.asked() == [(ident_number(SECOND), Element.DATA_STATE)]


def test_the_answer_to_what_was_asked_before_a_reset_is_taken_all_the_same() -> None:
    program = Program()
    program.accesses.begin(read())
    program.accesses.reset()
    assert not program.accesses.is_waiting
    assert program.accesses.is_busy
    program.channel.answer(U16.pack() + (77).to_bytes(2, "little"))
    assert not program.accesses.is_busy
    assert program.accesses.value("Z", KEY) == 77.0


@pytest.mark.parametrize(
    "attribute", [U16, Attribute(Kind.UNSIGNED, 4), Attribute(Kind.UNSIGNED, 2, is_list=True)]
)
def test_an_ident_that_is_no_command_names_its_block(attribute: Attribute) -> None:
    """#COMMAND has no TYP, so that the length of the ident says nothing."""
    program = Program()
    program.accesses.begin(write(3.0, 4, key=FIRST, is_command=True))
    program.channel.answer(attribute.pack())
    alarm = alarm_of(program)
    assert (alarm.id, alarm.place) == (900749, "line 4, block N40")
    assert alarm.values == {"axis": "Z", "key": FIRST}
    program.accesses.begin(write(3.0, key=FIRST, is_command=True))
    program.channel.answer(COMMAND)
    program.channel.answer()
    program.accesses.check()
