"""What a mailbox of CANopen over EtherCAT takes for an answer, message by message (ETG.1000.6)."""

import struct
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.cia402.objects import SdoError
from axisrig.kernel.drives.ethercat.mailbox import Mailbox
from axisrig.kernel.drives.ethercat.mailbox_port import MailboxPlaces
from axisrig.kernel.profiles.ethercat.layouts import MailboxType
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

INDEX, OTHER = 0x6061, 0x6060
EMERGENCY, REQUEST, RESPONSE, INFORMATION = 1, 2, 3, 8
GENERAL, NO_OBJECT = 0x08000000, 0x06020000


def coe(service: int, content: bytes) -> bytes:
    return (service << 12).to_bytes(2, "little") + content


def expedited(index: int = INDEX, value: int = 8) -> bytes:
    return struct.pack("<BHBI", 0x4F, index, 0, value)


def abort(index: int = INDEX) -> bytes:
    return struct.pack("<BHBI", 0x80, index, 0, NO_OBJECT)


class Asked:
    """A mailbox that has asked for an object; waits: the slave has the request.

    written: the messages to the slave, behind their mailbox heads.
    """

    def __init__(self, *, waits: bool = True) -> None:
        self.written: list[bytes] = []
        transactions: Any = SimpleNamespace(ask=self._note)
        self.mailbox = Mailbox(transactions, new_scheduler(), 1001, 20 * MS)
        self.mailbox.port.places = MailboxPlaces(0x1000, 64, 0x1080, 64)
        self.found: list[bytes | SdoError] = []
        self.heard: list[bytes] = []
        self.mailbox.emergency = self.heard.append
        self.mailbox.read(INDEX, 0, self.found.append)
        self.mailbox.port.waits = waits

    def _note(self, datagrams: Any, *_args: Any, **_more: Any) -> None:
        data = datagrams[0].data
        self.written.append(data[6 : 6 + int.from_bytes(data[:2], "little")])

    def take(self, kind: MailboxType, body: bytes) -> Any:
        """What the question has got; None while it is open."""
        self.mailbox._taken(kind, body)
        assert self.mailbox.is_busy is not bool(self.found)
        if not self.found:
            return None
        (answer,) = self.found
        return answer.code if isinstance(answer, SdoError) else answer


@pytest.mark.parametrize(
    ("kind", "body", "answer"),
    [
        (MailboxType.COE, coe(RESPONSE, expedited()), b"\x08"),
        (MailboxType.COE, coe(RESPONSE, abort()), NO_OBJECT),
        (MailboxType.COE, coe(REQUEST, abort()), NO_OBJECT),  # an abort is a request
        (MailboxType.ERROR, b"\1\0\2\0", GENERAL),
        (MailboxType.COE, coe(RESPONSE, expedited(OTHER)), None),
        (MailboxType.COE, coe(RESPONSE, abort(OTHER)), None),
        (MailboxType.COE, coe(INFORMATION, expedited()), None),
        (MailboxType.COE, coe(EMERGENCY, expedited()), None),
        (MailboxType.COE, coe(RESPONSE, expedited()[:3]), None),
        (MailboxType.COE, b"\0", None), (MailboxType.COE, b"", None),
        (MailboxType.SOE, coe(RESPONSE, expedited()), None),
        (MailboxType.EOE, coe(RESPONSE, expedited()), None),
    ],
)  # fmt: skip
def test_an_answer_is_one_about_the_object_after_the_slave_has_the_request(
    kind: MailboxType, body: bytes, answer: Any
) -> None:
    assert Asked().take(kind, body) == answer
    assert Asked(waits=False).take(kind, body) is None


@pytest.mark.parametrize("waits", [True, False])
def test_an_emergency_is_handed_on_whenever_it_comes(waits: bool) -> None:
    """Code, register and five bytes of the maker; one that is shorter is none."""
    data = bytes.fromhex("1023 20 0102030405")
    asked = Asked(waits=waits)
    for content in (data, data + b"more", data[:7]):
        assert asked.take(MailboxType.COE, coe(EMERGENCY, content)) is None
    assert asked.heard == [data, data]
    asked.mailbox.emergency = None
    assert asked.take(MailboxType.COE, coe(EMERGENCY, data)) is None


def test_without_a_question_no_answer_is_one() -> None:
    asked = Asked()
    assert asked.take(MailboxType.COE, coe(RESPONSE, expedited())) == b"\x08"
    for kind, body in (
        (MailboxType.COE, coe(RESPONSE, expedited(value=3))), (MailboxType.ERROR, bytes(4)),
    ):  # fmt: skip
        assert asked.take(kind, body) == b"\x08"


def test_a_long_object_comes_in_segments_and_each_is_asked_for() -> None:
    """CiA 301: 60 hex and 70 hex in turn; the size is in the first answer."""
    value = bytes(range(30))
    asked = Asked()
    first = struct.pack("<BHBI", 0x41, INDEX, 0, 30) + value[:12]
    assert asked.take(MailboxType.COE, coe(RESPONSE, first)) is None
    assert asked.written[-1] == coe(REQUEST, b"\x60" + bytes(7))
    asked.mailbox.port.waits = True
    assert asked.take(MailboxType.COE, coe(RESPONSE, b"\0" + value[12:25])) is None
    assert asked.written[-1] == coe(REQUEST, b"\x70" + bytes(7))
    asked.mailbox.port.waits = True
    last = bytes((0x10 | 2 << 1 | 1,)) + value[25:].ljust(7, b"\xee")
    assert asked.take(MailboxType.COE, coe(RESPONSE, last)) == value
    assert len(asked.written) == 3


@pytest.mark.parametrize(
    ("answer", "code"),
    [
        (b"\x10" + bytes(12), 0x05030000),  # toggle bit of the second segment
        (b"\x20" + bytes(12), 0x05040001),  # the answer to a segment that is written
        (b"\x01" + bytes(12), 0x06070010),  # the last one, and 6 bytes are missing
    ],
)
def test_a_transfer_that_goes_wrong_is_broken_off_at_both_ends(answer: bytes, code: int) -> None:
    """The slave gets the abort, who has asked the same code."""
    asked = Asked()
    first = struct.pack("<BHBI", 0x41, INDEX, 0, 30) + bytes(12)
    asked.take(MailboxType.COE, coe(RESPONSE, first))
    asked.mailbox.port.waits = True
    assert asked.take(MailboxType.COE, coe(RESPONSE, answer)) == code
    assert asked.written[-1] == coe(REQUEST, struct.pack("<BHBI", 0x80, INDEX, 0, code))
    assert not asked.mailbox.port.waits


def test_requests_run_in_turn_and_what_an_answer_asks_for_comes_behind_them() -> None:
    asked = Asked()
    asked.take(MailboxType.COE, coe(RESPONSE, expedited()))
    asked.written.clear()
    mailbox, order = asked.mailbox, list[str]()

    def first(_answer: Any) -> None:
        order.append(f"first, {len(asked.written)} written")
        mailbox.read(0x6041, 0, lambda _: order.append("third"))

    mailbox.read(INDEX, 0, first)
    mailbox.read(OTHER, 0, lambda _: order.append("second"))
    assert len(asked.written) == 1
    mailbox.port.waits = True
    mailbox._taken(MailboxType.COE, coe(RESPONSE, expedited()))
    assert order == ["first, 2 written"]
    for index, done in ((OTHER, "second"), (0x6041, "third")):
        assert asked.written[-1] == coe(REQUEST, struct.pack("<BHBI", 0x40, index, 0, 0))
        mailbox.port.waits = True
        mailbox._taken(MailboxType.COE, coe(RESPONSE, expedited(index)))
        assert order[-1] == done
    assert not mailbox.is_busy


def test_a_silent_slave_is_asked_twice_and_then_for_the_next_object() -> None:
    """Each request has two attempts of its own."""
    asked = Asked()
    mailbox = asked.mailbox
    others: list[bytes | SdoError] = []
    mailbox.read(OTHER, 0, others.append)
    mailbox._silent()
    assert (asked.found, len(asked.written)) == ([], 2)
    assert asked.written[1] == asked.written[0]
    mailbox._silent()
    (error,) = asked.found
    assert isinstance(error, SdoError)
    assert (error.code, error.index) == (None, INDEX)
    assert asked.written[-1] == coe(REQUEST, struct.pack("<BHBI", 0x40, OTHER, 0, 0))
    mailbox._silent()
    assert others == []
    mailbox._silent()
    assert isinstance(others[0], SdoError)
    assert (others[0].index, len(asked.written)) == (OTHER, 4)
