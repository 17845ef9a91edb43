"""An emergency that a drive on EtherCAT puts into its mailbox is what its fault is reported with.

Bytes by hand: ETG.1000.6, CoE emergency: service 1 in bits 12 to 15, then eight bytes as on CAN.
"""

from typing import Any

import pytest
from tests.ethercat.test_mailbox_port import PLACES, STATION, TIMEOUT_NS, Questions

from axisrig.kernel.drives.cia402.words import latch_object
from axisrig.kernel.drives.ethercat.image_data import ImageData
from axisrig.kernel.drives.ethercat.link import EthercatLink
from axisrig.kernel.drives.ethercat.mailbox import Mailbox
from axisrig.kernel.drives.ethercat.settings import Pdo, SlaveSettings
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.time.scheduler import Scheduler

STATUS = (
    MappedObject(0x6041, 0, 16, False, "statusword"),
    MappedObject(0x6064, 0, 32, True, "actual"),
)
OUTPUTS = (
    MappedObject(0x6040, 0, 16, False, "controlword"),
    MappedObject(0x607A, 0, 32, True, "target"),
)
COE, SOE = 3, 5
EMERGENCY, SDO_RESPONSE = b"\x00\x10", b"\x00\x30"
FOLLOWING_ERROR = b"\x11\x86\x21\x01\x02\x03\x04\x05"
SHORT_CIRCUIT = b"\x20\x23\x03\x00\x00\x00\x00\x00"
PASSIVE = b"\x20\x81\x11\x00\x00\x00\x00\x00"
OVER = bytes(8)


class Drive:
    """The link of a drive and its mailbox, whose frames the test answers."""

    def __init__(self, name: str) -> None:
        settings = SlaveSettings(
            name, 1000.0, node_id=1, inputs=[Pdo(0x1A00, STATUS)], outputs=[Pdo(0x1600, OUTPUTS)]
        )
        self.line = Questions()
        transactions: Any = self.line
        mailbox = Mailbox(transactions, Scheduler(), STATION, TIMEOUT_NS)
        mailbox.port.places = PLACES
        self.link = EthercatLink(settings, ImageData(settings, latch_object(1, "POS")), mailbox)

    def posts(self, body: bytes, kind: int = COE) -> None:
        """The slave has a message; length, address, channel, type with counter 1."""
        self.link.mailbox.port.note_full()
        head = len(body).to_bytes(2, "little") + bytes((0, 0, 0, kind | 0x10))
        self.line.taken((head + body).ljust(PLACES.in_size, b"\0"))

    @property
    def words(self) -> str:
        return str(self.link.fault().values["emcy"])


@pytest.fixture
def drives() -> tuple[Drive, Drive]:
    return Drive("Y"), Drive("Z")


def test_its_code_and_its_register_are_in_the_alarm_of_its_fault_and_of_no_other(
    drives: tuple[Drive, Drive],
) -> None:
    first, second = drives
    for own, other in ((first, second), (second, first)):
        assert (own.link.has_reported, own.words) == (False, "none")
        own.posts(EMERGENCY + FOLLOWING_ERROR)
        found = own.link.emergency
        assert own.link.has_reported
        assert found is not None
        assert (found.code, found.register, found.vendor) == (0x8611, 0x21, b"\1\2\3\4\5")
        alarm = own.link.fault()
        assert (alarm.id, alarm.values["axis"]) == (900005, own.link.name)
        assert own.words == "0x8611, following error, error register 0x21"
        assert (other.link.has_reported, other.words) == (False, "none")
        other.link.forget_fault()
        assert own.link.has_reported
        own.link.forget_fault()


def test_the_last_one_counts_until_the_fault_is_forgotten(drives: tuple[Drive, Drive]) -> None:
    """One that a fault is over (0000) is none, and takes nothing away."""
    drive, _ = drives
    drive.posts(EMERGENCY + FOLLOWING_ERROR)
    drive.posts(EMERGENCY + SHORT_CIRCUIT)
    assert drive.words.startswith("0x2320, ")
    drive.posts(EMERGENCY + OVER)
    assert drive.words.startswith("0x2320, ")
    drive.link.forget_fault()
    assert (drive.link.has_reported, drive.words) == (False, "none")
    drive.posts(EMERGENCY + OVER)
    assert not drive.link.has_reported
    drive.posts(EMERGENCY + PASSIVE)
    assert drive.words.startswith("0x8120, ")


def test_what_came_during_the_start_up_does_not_count(drives: tuple[Drive, Drive]) -> None:
    drive, _ = drives
    drive.posts(EMERGENCY + SHORT_CIRCUIT)
    drive.link.begin()
    assert not drive.link.has_reported
    drive.posts(EMERGENCY + SHORT_CIRCUIT)
    assert drive.link.has_reported


@pytest.mark.parametrize(
    ("body", "kind"),
    [
        (EMERGENCY + SHORT_CIRCUIT[:7], COE),
        (SDO_RESPONSE + SHORT_CIRCUIT, COE),
        (EMERGENCY + SHORT_CIRCUIT, SOE),
        (EMERGENCY[:1], COE),
    ],
)
def test_what_is_no_emergency(body: bytes, kind: int, drives: tuple[Drive, Drive]) -> None:
    """One byte too few, another service, another protocol, no service."""
    drive, _ = drives
    drive.posts(body, kind)
    assert not drive.link.has_reported
