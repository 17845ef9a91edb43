"""Edges of what a mailbox serves: lists by their kind, odd sizes, transfers, lengths."""

import csv
import struct
from collections.abc import Iterator
from importlib import resources
from typing import Any

import pytest
from tests.ethercat.line import INIT, Line
from tests.ethercat.test_messages_of_a_slave import Slave
from tests.ethercat.test_sdo_server_of_a_slave import DATA, Server

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.distributed_clock import DistributedClock
from axisrig.bench.drive.ethercat.local_clock import LocalClock
from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.bench.drive.ethercat.object_information import ObjectInformation
from axisrig.bench.drive.ethercat.objects import described
from axisrig.kernel.profiles.ethercat.layouts import MailboxType
from axisrig.kernel.time.clock import MS

COMMAND = 0x0504_0001
NEVER_STORED = (0x1003, 0x1010, 0x1011)


def rows() -> Iterator[dict[str, str]]:
    """The objects of the slave in both tables, in their order."""
    own = resources.files("axisrig.bench.drive.ethercat") / "objects_ethercat.csv"
    yield from csv.DictReader(own.read_text(encoding="utf-8").splitlines())
    profile = resources.files("axisrig.bench.drive.cia402.dictionary") / "objects_profile.csv"
    yield from csv.DictReader(profile.read_text(encoding="utf-8").splitlines())


def is_listed(row: dict[str, str], kind: int) -> bool:
    if kind in (2, 3):
        return row["pdo"] == ("rx" if kind == 2 else "tx")
    if kind == 1:
        return row["type"] not in ("array", "record")
    is_number = row["type"] not in ("STRING", "DOMAIN", "array", "record")
    is_kept = row["pdo"] != "rx" and int(row["index"], 16) not in NEVER_STORED
    return row["access"] == "rw" and is_number and is_kept


def listed(answers: list[bytes]) -> tuple[int, list[int], list[int]]:
    """Kind, indices, and how many fragments each answer says that are left."""
    content = b"".join(answer[6:] for answer in answers)
    kind, *indices = struct.unpack(f"<{len(content) // 2}H", content)
    return kind, indices, [int.from_bytes(answer[4:6], "little") for answer in answers]


@pytest.mark.parametrize("size", [128, 33, 48, 47, 1024])
@pytest.mark.parametrize("kind", [1, 2, 3, 4, 5])
def test_a_list_has_the_objects_of_its_kind_whatever_the_mailbox_holds(
    kind: int, size: int
) -> None:
    """1 all, 2 in RxPDOs, 3 in TxPDOs, 4 stored, 5 at start-up; whole numbers in each fragment."""
    profile = DriveProfile()
    information = ObjectInformation(described(profile), profile, lambda _: 0, lambda: size)
    answers = information.request(struct.pack("<HBBHH", 8 << 12, 1, 0, 0, kind))
    found, indices, left = listed(answers)
    wanted = list(dict.fromkeys(int(row["index"], 16) for row in rows() if is_listed(row, kind)))
    assert (found, indices) == (kind, wanted)
    assert left == list(range(len(answers)))[::-1]
    fits = (size - 12) // 2 * 2
    assert [len(answer) - 6 for answer in answers[:-1]] == [fits] * (len(answers) - 1)
    assert len(answers) == -(-(2 + 2 * len(wanted)) // fits)
    assert [bool(answer[2] & 0x80) for answer in answers] == [True] * (len(answers) - 1) + [False]


def test_how_many_objects_each_list_has() -> None:
    profile = DriveProfile()
    information = ObjectInformation(described(profile), profile, lambda _: 0, lambda: 128)
    (answer,) = information.request(struct.pack("<HBBHH", 8 << 12, 1, 0, 0, 0))
    wanted = [len({row["index"] for row in rows() if is_listed(row, kind)}) for kind in range(1, 6)]
    assert list(struct.unpack("<H5H", answer[6:])) == [0, *wanted]
    assert len(set(wanted[:4])) == 4


# SDO


def test_an_object_of_no_bytes_is_given_with_its_size() -> None:
    """No expedited answer: that has one byte at least."""
    server = Server()
    assert server.ask("4000200100000000") == "4100200100000000"
    assert server.ask("60" + "00" * 7).startswith("80002001")  # nothing is left of it


@pytest.mark.parametrize("size", [1, 2, 4])
def test_an_expedited_write_without_a_size_has_that_of_the_object(size: int) -> None:
    """Bit 0 of its head is 0, and what is in bits 2 and 3 says nothing."""
    server = Server()
    server.objects.size = size
    for unused in (0, 1, 3):
        head = bytes((0x22 | unused << 2,)).hex()
        assert server.ask(head + "002001" + DATA[1:5].hex()) == "6000200100000000"
        assert server.objects.written.pop() == (0x2000, 1, DATA[1 : 1 + size].hex())


@pytest.mark.parametrize("size", [1, 2, 3, 4])
def test_an_expedited_write_with_a_size_has_it(size: int) -> None:
    server = Server()
    server.objects.size = 4  # the object says what it takes; here anything
    head = bytes((0x23 | 4 - size << 2,)).hex()
    assert server.ask(head + "002001" + DATA[1:5].hex()) == "6000200100000000"
    assert server.objects.written == [(0x2000, 1, DATA[1 : 1 + size].hex())]


@pytest.mark.parametrize("way", ["init", "power"])
def test_a_transfer_ends_with_the_state(way: str) -> None:
    """The next segment is one of nothing, as after a start."""
    line = Line(settings=[SlaveSettings(serial=1, mailbox_bytes=32)])
    line.preop(mailbox=32)
    _, body = line.coe(struct.pack("<BHB4x", 0x40, 0x1008, 0), size=32)
    assert body[0] == 0x41
    if way == "init":
        assert line.ask(INIT) == (INIT, 0)
    else:
        line.drive.power_off()
        line.drive.power_on()
    line.preop(mailbox=32)
    line.send_mail(3, struct.pack("<HB7x", 2 << 12, 0x60), 32)
    line.wait(MS)
    answer = line.one(1, 0, 0x1020, 32)
    assert answer.wkc == 1
    assert answer.data[8] == 0x80
    assert int.from_bytes(answer.data[12:16], "little") == COMMAND


# Messages


@pytest.mark.parametrize(
    ("length", "answer"),
    [(58, None), (59, 8), (63, 8), (64, 8), (65, 8), (0xFFFF, 8), (2, None), (1, 6), (0, 6)],
)
def test_a_message_is_as_long_as_the_mailbox_holds_at_most(length: int, answer: Any) -> None:
    """64 bytes less 6 of its head; error 8: longer than the mailbox, 6: no CoE head in it."""
    slave = Slave()
    body = struct.pack("<HHBB", length, 0, 0, MailboxType.COE) + bytes(58)
    assert slave.managers.write(0x1000, body, slave.ram)
    slave.serve()
    message = slave.read()
    assert message is not None
    if answer is None:
        assert len(message[1]) == length
    else:
        assert message[1] == struct.pack("<HH", 1, answer)


def test_a_request_of_before_does_not_shorten_the_wait_of_the_next_one() -> None:
    """Each waits its 5 ms; that of the life before ended with INIT."""
    line = Line(profile=DriveProfile(sdo_answer_ns=5 * MS))
    line.preop()
    request = struct.pack("<HBHB4x", 2 << 12, 0x40, 0x6061, 0)
    line.send_mail(3, request)
    line.wait(2 * MS)
    line.ask(INIT)
    line.preop()
    line.wait(MS)
    line.send_mail(3, request)
    line.wait(4 * MS)
    assert line.one(1, 0, 0x1080, 128).wkc == 0
    line.wait(2 * MS)
    assert line.one(1, 0, 0x1080, 128).wkc == 1


# Instants of a clock that follows


@pytest.mark.parametrize("drift_ppm", [0.0, 87.654, -123.456])
@pytest.mark.parametrize("ahead_ns", [333, -777, 20_011])
def test_the_instant_of_a_time_is_the_first_one_while_the_clock_is_led(
    drift_ppm: float, ahead_ns: int
) -> None:
    """The copy shows it then and did not a nanosecond before; what is past is now."""
    clock = DistributedClock(LocalClock(17, drift_ppm))
    for number in range(1, 5):
        now_ns = number * MS
        clock.follow(clock.system_ns(now_ns) - ahead_ns, 64, now_ns)
    now_ns = 4 * MS + 1000
    now = clock.system_ns(now_ns)
    for left in (*range(1, 60), 997, 10_007, 99_991, 1_000_003, 123_456_789):
        at_ns = clock.instant_ns(now + left, now_ns)
        assert at_ns > now_ns
        assert clock.system_ns(at_ns) >= now + left
        assert clock.system_ns(at_ns - 1) < now + left
    for left in (0, -1, -1000):
        assert clock.instant_ns(now + left, now_ns) == now_ns
