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
    """A mailbox that has asked for an object; waits: the slave has the request."""

    def __init__(self, *, waits: bool = True) -> None:
        transactions: Any = SimpleNamespace(ask=lambda *_args, **_more: None)
        self.mailbox = Mailbox(transactions, new_scheduler(), 1001, 20 * MS)
        self.mailbox.port.places = MailboxPlaces(0x1000, 64, 0x1080, 64)
        self.found: list[bytes | SdoError] = []
        self.heard: list[bytes] = []
        self.mailbox.emergency = self.heard.append
        self.mailbox.read(INDEX, 0, self.found.append)
        self.mailbox.port.waits = waits

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
