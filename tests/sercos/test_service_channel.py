"""Both ends of the service channel of a SERCOS drive, over a mailbox of a test."""

import struct
from collections.abc import Callable, Sequence

import pytest

from axisrig.bench.drive.sercos.service_channel import Ident
from axisrig.bench.drive.sercos.service_channel import ServiceChannel as Slave
from axisrig.kernel.drives.sercos.service_channel import ServiceChannel, SoeError
from axisrig.kernel.profiles.sercos.service import (
    Attribute,
    Element,
    Header,
    Kind,
    Operation,
    command_states,
    ident_number,
    pack_list,
    pack_text,
    parts_of,
    read_list,
    read_text,
    soe_errors,
)
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

PROBE, CONTROL, COMMAND, LISTED, NAME = (
    ident_number(f"S-0-0{number}") for number in (130, 169, 170, "016", 142)
)
STATES, ERRORS = command_states(), soe_errors()
SIZE = 48  # of either mailbox: 38 bytes of data in a message
Got = bytes | SoeError


class Wire:
    """A slave with two drives, and the control's end of its mailbox."""

    def __init__(self) -> None:
        self.scheduler: Scheduler = new_scheduler()
        self.phase = 4
        self.changes: list[str] = []
        self.command = Ident(Attribute(Kind.BINARY, 2, is_command=True), b"\0\0", name="Probing")
        self.idents = {
            PROBE: Ident(
                Attribute(Kind.SIGNED, 4, decimals=4), struct.pack("<i", -1_294_530),
                name="Probe 1 positive edge", unit="mm", is_read_only=True,
            ),
            CONTROL: Ident(
                Attribute(Kind.BINARY, 2, protected=(False, False, True)), b"\0\0",
                minimum=0, maximum=15, default=1, changed=lambda: self.changes.append("control"),
            ),
            COMMAND: self.command,
            LISTED: Ident(
                Attribute(Kind.IDENT, 2, is_list=True), pack_list([51], 2, 40), capacity=80
            ),
            NAME: Ident(Attribute(Kind.TEXT, 1), pack_text("x", 60), capacity=60),
        }  # fmt: skip
        self.slave = Slave([self.idents, {}], lambda: SIZE, lambda: self.phase)
        self.asked: list[bytes] = []
        self.answers: list[bytes] = []
        self.is_silent = False
        self.master = ServiceChannel(self._carry_all, self.scheduler, lambda: SIZE - 6, 20 * MS)

    def _carry_all(self, parts: Sequence[bytes]) -> None:
        for part in parts:
            self._carry(part)

    def _carry(self, body: bytes) -> None:
        assert len(body) <= SIZE - 6
        self.asked.append(body)
        if not self.is_silent:
            self.answers += self.slave.serve(body)

    def deliver(self) -> None:
        while self.answers:
            body = self.answers.pop(0)
            assert len(body) <= SIZE - 6
            self.master.take(body)

    def read(self, ident: int, elements: Element = Element.VALUE, drive: int = 0) -> Got:
        got: list[Got] = []
        self.master.read(drive, ident, elements, got.append)
        self.deliver()
        return got[0]

    def write(self, ident: int, value: bytes, drive: int = 0) -> Got:
        got: list[Got] = []
        self.master.write(drive, ident, value, got.append)
        self.deliver()
        return got[0]


@pytest.fixture
def wire() -> Wire:
    return Wire()


def code(answer: Got) -> int | None:
    assert isinstance(answer, SoeError)
    return answer.code


def test_a_value_with_all_that_belongs_to_it(wire: Wire) -> None:
    """In fragments: 2 + 4 + 21 + 4 + 4 + 2 + 4 bytes do not fit into one message."""
    elements = Element.DATA_STATE | Element.NAME | Element.ATTRIBUTE | Element.UNIT | Element.VALUE
    answer = wire.read(PROBE, elements)
    assert isinstance(answer, bytes)
    attribute = wire.idents[PROBE].attribute
    found = parts_of(elements, answer, attribute)
    assert read_text(found[Element.NAME]) == "Probe 1 positive edge"
    assert read_text(found[Element.UNIT]) == "mm"
    assert Attribute.read(found[Element.ATTRIBUTE]) == attribute
    assert struct.unpack("<i", found[Element.VALUE]) == (-1_294_530,)
    numbers = Element.MINIMUM | Element.MAXIMUM | Element.DEFAULT
    assert wire.read(CONTROL, numbers) == struct.pack("<HHH", 0, 15, 1)


def test_an_answer_echoes_drive_and_elements(wire: Wire) -> None:
    question = Header(Operation.READ, 0, Element.VALUE, PROBE)
    (answer,) = wire.slave.serve(question.pack())
    assert Header.read(answer) == Header(Operation.READ_ANSWER, 0, Element.VALUE, PROBE)
    (refused,) = wire.slave.serve(Header(Operation.WRITE, 5, Element.VALUE, PROBE).pack())
    assert Header.read(refused) == Header(Operation.WRITE_ANSWER, 5, Element.VALUE, PROBE, True)
    assert refused[4:] == struct.pack("<H", 0x800A)


@pytest.mark.parametrize("count", [0, 1, 16, 40])
def test_a_list_is_written_and_read_in_fragments(wire: Wire, count: int) -> None:
    items = [0x8000 + n for n in range(count)]
    data = pack_list(items, 2, 40)
    assert wire.write(LISTED, data) == b""
    assert len(wire.asked) == max(1, -(-len(data) // (SIZE - 10)))
    answer = wire.read(LISTED)
    assert isinstance(answer, bytes)
    assert read_list(answer, 2) == items


@pytest.mark.parametrize("text", ["", "y", "Probe 1", "y" * 60])
def test_a_text_of_any_length_up_to_its_capacity_is_written_and_read(wire: Wire, text: str) -> None:
    """Nothing of it is a number: neither its range nor its check is asked."""
    ident = wire.idents[NAME]
    ident.minimum, ident.maximum, ident.check = 0, 0, lambda _: "INVALID"
    assert not isinstance(wire.write(NAME, pack_text(text)), SoeError)
    found = wire.read(NAME)
    assert not isinstance(found, SoeError)
    assert read_text(found) == text
    both = wire.read(NAME, Element.ATTRIBUTE | Element.VALUE)
    assert not isinstance(both, SoeError)
    parts = parts_of(Element.ATTRIBUTE | Element.VALUE, both, Attribute.read(both[:4]))
    assert parts[Element.VALUE] == pack_text(text)


def test_a_write_begins_anew_behind_one_in_fragments(wire: Wire) -> None:
    for count in (40, 3, 16, 0):
        items = [0x9000 + count + n for n in range(count)]
        assert wire.write(LISTED, pack_list(items, 2, 40)) == b""
        answer = wire.read(LISTED)
        assert isinstance(answer, bytes)
        assert read_list(answer, 2) == items
        wire.phase = 3
        assert wire.write(CONTROL, number(count % 16)) == b""
        assert wire.read(CONTROL) == number(count % 16)


def number(value: int) -> bytes:
    return struct.pack("<H", value)


Act = Callable[[Wire], Got]
REFUSALS: list[tuple[str, Act]] = [
    ("NO_IDENT", lambda wire: wire.read(ident_number("S-0-0131"))),
    ("NO_IDENT", lambda wire: wire.read(PROBE, drive=1)),
    ("DRIVE", lambda wire: wire.read(PROBE, drive=2)),
    ("NO_ELEMENT", lambda wire: wire.read(PROBE, Element(0))),
    ("NO_NAME", lambda wire: wire.read(CONTROL, Element.NAME)),
    ("NO_UNIT", lambda wire: wire.read(CONTROL, Element.UNIT)),
    ("NO_MINIMUM", lambda wire: wire.read(PROBE, Element.MINIMUM)),
    ("NO_MAXIMUM", lambda wire: wire.read(PROBE, Element.MAXIMUM)),
    ("NO_DEFAULT", lambda wire: wire.read(PROBE, Element.DEFAULT)),
    ("READ_ONLY", lambda wire: wire.write(PROBE, bytes(4))),
    ("PROTECTED", lambda wire: wire.write(CONTROL, number(1))),
    ("SHORT", lambda wire: wire.write(COMMAND, b"\x03")),
    ("LONG", lambda wire: wire.write(COMMAND, b"\x03\0\0\0")),
    ("INVALID", lambda wire: wire.write(COMMAND, number(1))),
    ("SHORT", lambda wire: wire.write(LISTED, b"\x02\0")),
    ("SHORT", lambda wire: wire.write(LISTED, b"\x04\0\x50\0\1\0")),
    ("LONG", lambda wire: wire.write(LISTED, pack_list(range(41), 2, 41))),
    ("INVALID", lambda wire: wire.write(LISTED, b"\x03\0\x50\0abc")),
    ("LONG", lambda wire: wire.write(NAME, pack_text("y" * 61))),
]  # fmt: skip


@pytest.mark.parametrize(("name", "act"), REFUSALS)
def test_what_is_refused_with_which_code(wire: Wire, name: str, act: Act) -> None:
    before = {number: ident.value for number, ident in wire.idents.items()}
    assert code(act(wire)) == ERRORS[name]
    assert {number: ident.value for number, ident in wire.idents.items()} == before
    assert wire.changes == []


@pytest.mark.parametrize(
    ("element", "name"),
    [
        (Element.DATA_STATE, "ELEMENT_1"), (Element.NAME, "NAME_READ_ONLY"),
        (Element.ATTRIBUTE, "ATTRIBUTE_READ_ONLY"), (Element.UNIT, "UNIT_READ_ONLY"),
        (Element.MINIMUM, "MINIMUM_READ_ONLY"), (Element.MAXIMUM, "MAXIMUM_READ_ONLY"),
    ],
)  # fmt: skip
def test_only_the_value_is_written(wire: Wire, element: Element, name: str) -> None:
    (answer,) = wire.slave.serve(Header(Operation.WRITE, 0, element, CONTROL).pack() + b"\1\0")
    assert answer[4:] == struct.pack("<H", ERRORS[name])


def test_range_and_phase_of_a_value(wire: Wire) -> None:
    for wire.phase, value, expected in ((3, 15, b""), (3, 16, "ABOVE"), (4, 1, "PROTECTED")):
        answer = wire.write(CONTROL, number(value))
        assert (answer if expected == b"" else code(answer)) == (
            b"" if expected == b"" else ERRORS[str(expected)]
        )
    assert (wire.idents[CONTROL].value, wire.changes) == (number(15), ["control"])
    wire.idents[CONTROL].minimum = 2
    wire.phase = 3
    assert code(wire.write(CONTROL, number(1))) == ERRORS["BELOW"]


def test_a_procedure_command_runs_ends_and_is_cancelled(wire: Wire) -> None:
    """3 runs it and 0 cancels it; the state is element 1, and who executes it ends it."""

    def state() -> Got:
        return wire.read(COMMAND, Element.DATA_STATE)

    assert state() == number(STATES["IDLE"])
    assert wire.write(COMMAND, number(3)) == b""
    assert state() == number(STATES["RUNNING"])
    assert code(wire.write(COMMAND, number(3))) == ERRORS["ACTIVE"]
    wire.command.state = STATES["FAILED"]
    assert state() == number(0xF)
    assert wire.write(COMMAND, number(0)) == b""
    assert state() == number(STATES["IDLE"])


def test_requests_go_in_turn_while_the_channel_is_busy(wire: Wire) -> None:
    order: list[str] = []
    wire.master.read(0, PROBE, Element.VALUE, lambda _: order.append("first"))
    wire.master.read(0, CONTROL, Element.VALUE, lambda _: order.append("second"))
    assert (wire.master.is_busy, len(wire.asked)) == (True, 1)
    wire.deliver()
    assert (wire.master.is_busy, order) == (False, ["first", "second"])


def test_an_answer_that_begins_a_request_keeps_their_order(wire: Wire) -> None:
    order: list[str] = []

    def again(_: Got) -> None:
        order.append("first")
        wire.master.read(0, PROBE, Element.VALUE, lambda _: order.append("third"))

    wire.master.read(0, PROBE, Element.VALUE, again)
    wire.master.read(0, PROBE, Element.VALUE, lambda _: order.append("second"))
    wire.deliver()
    assert order == ["first", "second", "third"]


def test_the_time_of_a_request_that_was_answered_is_not_that_of_the_next_one(wire: Wire) -> None:
    """20 ms each: the second one is asked after 15 ms, and has until 35 ms."""
    got: list[Got] = []
    wire.is_silent = True
    wire.master.read(0, PROBE, Element.VALUE, got.append)
    wire.scheduler.run_until(15 * MS)
    wire.master.give_up()
    wire.master.read(0, PROBE, Element.VALUE, got.append)
    wire.scheduler.run_until(35 * MS - 1)
    assert (len(got), wire.master.is_busy) == (1, True)
    wire.scheduler.run_until(35 * MS)
    assert (len(got), wire.master.is_busy) == (2, False)


def test_a_silent_drive_ends_a_request_and_a_late_answer_ends_no_other(wire: Wire) -> None:
    got: list[Got] = []
    wire.is_silent = True
    wire.master.read(0, PROBE, Element.VALUE, got.append)
    wire.scheduler.run_until(19 * MS)
    assert got == []
    wire.scheduler.run_until(21 * MS)
    (answer,) = got
    assert code(answer) is None
    assert "S-0-0130: no answer" in str(answer)
    wire.master.read(0, CONTROL, Element.VALUE, got.append)
    late = Header(Operation.READ_ANSWER, 0, Element.VALUE, PROBE).pack() + bytes(4)
    for other in (
        late,
        Header(Operation.WRITE_ANSWER, 0, Element.VALUE, CONTROL).pack(),
        Header(Operation.READ_ANSWER, 1, Element.VALUE, CONTROL).pack() + bytes(2),
        Header(Operation.READ_ANSWER, 0, Element.NAME, CONTROL).pack() + bytes(2),
        b"\x02",
    ):
        wire.master.take(other)
    assert (len(got), wire.master.is_busy) == (1, True)
    wire.master.take(Header(Operation.READ_ANSWER, 0, Element.VALUE, CONTROL).pack() + number(7))
    assert got[1] == number(7)
    wire.master.take(late)


def test_what_is_no_question_gets_no_answer_and_a_reset_drops_fragments(wire: Wire) -> None:
    for body in (b"", b"\x01\x40", Header(Operation.READ_ANSWER, 0, Element.VALUE, PROBE).pack()):
        assert wire.slave.serve(body) == []
    part = Header(Operation.WRITE, 0, Element.VALUE, 0, fragments=1).pack() + b"\1\0"
    assert wire.slave.serve(part) == []
    wire.slave.reset()
    assert wire.write(COMMAND, number(3)) == b""
