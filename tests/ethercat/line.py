"""A small master for tests: frames by hand on a simulated line of slaves."""

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from tests.drive_node.conftest import FakeAxis, FakeSignal

from axisrig.bench.bus.ethercat.segment import EthercatSegment, Link
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.node import EthercatDrive, SlaveSettings
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

Sent = tuple[int, int, bytes]
"""Command, address (position or station in the low half), data."""
INIT, PREOP, SAFEOP, OP, ACK = 1, 2, 4, 8, 0x10


def physical(command: int, adp: int, ado: int, data: bytes | int) -> Sent:
    """A datagram to a register; an int is a number of bytes to read."""
    return command, adp & 0xFFFF | ado << 16, bytes(data) if isinstance(data, int) else data


def frame(*datagrams: Sent) -> bytes:
    """An Ethernet frame with these datagrams."""
    body = b""
    for number, (command, address, data) in enumerate(datagrams):
        more = 0x8000 if number + 1 < len(datagrams) else 0
        body += struct.pack("<BBIHH", command, number, address, len(data) | more, 0)
        body += data + b"\x00\x00"
    head = b"\xff" * 6 + bytes.fromhex("020000000001") + b"\x88\xa4"
    return (head + struct.pack("<H", len(body) | 0x1000) + body).ljust(60, b"\x00")


@dataclass
class Answer:
    """What a datagram came back with."""

    data: bytes
    wkc: int
    adp: int
    events: int

    @property
    def number(self) -> int:
        return int.from_bytes(self.data, "little")


def answers(back: bytes) -> list[Answer]:
    at, found, more = 16, [], True
    while more:
        _, _, adp, _, word, events = struct.unpack_from("<BBHHHH", back, at)
        size = word & 0x7FF
        data = back[at + 10 : at + 10 + size]
        (wkc,) = struct.unpack_from("<H", back, at + 10 + size)
        found.append(Answer(data, wkc, adp, events))
        more, at = bool(word & 0x8000), at + 12 + size
    return found


class Line:
    """Drives on a line, and the master's end of it."""

    def __init__(
        self,
        count: int = 1,
        links: Sequence[Link] | None = None,
        settings: Sequence[SlaveSettings] | None = None,
        profile: DriveProfile | None = None,
        motion: Callable[[float], float] | None = None,
        edges_ns: Sequence[int] = (),
    ) -> None:
        self.clock: Scheduler = new_scheduler()
        self.axes = [FakeAxis(motion=motion) for _ in range(count)]
        settings = settings or [SlaveSettings(serial=n + 1) for n in range(count)]
        self.drives = [
            EthercatDrive(
                f"D{n}",
                self.clock,
                axis,
                (FakeSignal(axis, edges_ns), None),
                profile,
                settings[n],
            )
            for n, axis in enumerate(self.axes)
        ]
        self.segment = EthercatSegment(self.clock, self.drives, links)
        self.segment.receivers.append(self._receive)
        self.back: list[tuple[int, bytes]] = []
        self._counter = 0
        self._index = 0

    @property
    def drive(self) -> EthercatDrive:
        return self.drives[0]

    def _receive(self, back: bytes) -> None:
        self.back.append((self.clock.now_ns, back))

    def exchange(self, *datagrams: Sent) -> list[Answer]:
        """Send one frame and wait until it is back."""
        self.segment.send(frame(*datagrams))
        before = len(self.back)
        assert self.clock.run_while(lambda: len(self.back) == before, 10 * MS)
        return answers(self.back[-1][1])

    def one(self, command: int, adp: int, ado: int, data: bytes | int) -> Answer:
        return self.exchange(physical(command, adp, ado, data))[0]

    def read(self, ado: int, size: int, position: int = 0) -> int:
        return self.one(1, -position, ado, size).number

    def write(self, ado: int, value: int, size: int, position: int = 0) -> int:
        return self.one(2, -position, ado, value.to_bytes(size, "little")).wkc

    def wait(self, time_ns: int) -> None:
        self.clock.run_until(self.clock.now_ns + time_ns)

    # States

    def al(self, position: int = 0) -> tuple[int, int]:
        """AL status and its code."""
        data = self.one(1, -position, 0x130, 6).data
        return struct.unpack_from("<HHH", data)[::2]

    def ask(self, state: int, position: int = 0) -> tuple[int, int]:
        self.write(0x120, state, 2, position)
        return self.al(position)

    def preop(self, position: int = 0, mailbox: int = 128) -> None:
        managers = struct.pack("<HHBBBB", 0x1000, mailbox, 0x26, 0, 1, 0)
        managers += struct.pack("<HHBBBB", 0x1000 + mailbox, mailbox, 0x22, 0, 1, 0)
        assert self.one(2, -position, 0x800, managers).wkc == 1
        assert self.ask(PREOP, position) == (PREOP, 0)

    def map_image(
        self, position: int = 0, outputs: int = 8, inputs: int = 16, logical: int = 0
    ) -> None:
        """SyncManagers 2 and 3 and two FMMUs: outputs first, inputs behind them."""
        self.one(2, -position, 0x810, struct.pack("<HHBBBB", 0x1800, outputs, 0x64, 0, 1, 0))
        self.one(2, -position, 0x818, struct.pack("<HHBBBB", 0x1C00, inputs, 0x20, 0, 1, 0))
        fmmus = struct.pack("<IHBBHBBB3x", logical, outputs, 0, 7, 0x1800, 0, 2, 1)
        fmmus += struct.pack("<IHBBHBBB3x", logical + outputs, inputs, 0, 7, 0x1C00, 0, 1, 1)
        self.one(2, -position, 0x600, fmmus)

    def safeop(self) -> None:
        self.preop()
        self.map_image()
        assert self.ask(SAFEOP) == (SAFEOP, 0)

    def op(self) -> None:
        self.safeop()
        self.cycle()
        self.write(0x120, OP, 2)
        self.cycle()
        assert self.al() == (OP, 0)

    def cycle(self, control: int = 0, target: int = 0, probe: int = 0) -> tuple[Any, ...]:
        """One LRW of the default mapping: statusword, position, probe status, latch, inputs."""
        sent = struct.pack("<HiH", control, target, probe) + bytes(16)
        answer = self.exchange((12, 0, sent))[0]
        assert answer.wkc == 3
        return struct.unpack_from("<HiHiI", answer.data, 8)

    def enable(self, period_ns: int = MS) -> None:
        """Bring the drive to operation enabled, at the present position."""
        for control in (0x06, 0x07, 0x0F, 0x0F):
            position = self.cycle(control)[1]
            self.wait(period_ns - 50 * US)
        self.cycle(0x0F, position)

    # Mailbox

    def send_mail(self, kind: int, body: bytes, size: int = 128) -> int:
        self._counter = self._counter % 7 + 1
        message = struct.pack("<HHBB", len(body), 0, 0, kind | self._counter << 4) + body
        return self.one(2, 0, 0x1000, message.ljust(size, b"\x00")).wkc

    def fetch_mail(self, size: int = 128) -> tuple[int, bytes]:
        """Type and body of the next message."""
        self.wait(10 * US)
        answer = self.one(1, 0, 0x1000 + size, size)
        assert answer.wkc == 1
        length, _, _, kind = struct.unpack_from("<HHBB", answer.data)
        return kind & 15, answer.data[6 : 6 + length]

    def coe(self, request: bytes, service: int = 2, size: int = 128) -> tuple[int, bytes]:
        """Service and body of the answer to a request of CoE."""
        assert self.send_mail(3, struct.pack("<H", service << 12) + request, size) == 1
        kind, body = self.fetch_mail(size)
        assert kind == 3
        return int.from_bytes(body[:2], "little") >> 12, body[2:]

    def sdo_write(self, index: int, sub: int, value: int, size: int) -> int:
        """Write a value of up to 4 bytes; 0 or the abort code."""
        head = struct.pack("<BHB", 0x23 | 4 - size << 2, index, sub)
        _, body = self.coe(head + (value & (1 << 8 * size) - 1).to_bytes(4, "little"))
        return 0 if body[0] == 0x60 else int.from_bytes(body[4:8], "little")

    def sdo_read(self, index: int, sub: int) -> bytes:
        """Read a value of up to 4 bytes."""
        _, body = self.coe(struct.pack("<BHB4x", 0x40, index, sub))
        assert body[0] & 0xE3 == 0x43, body.hex()
        return body[4 : 8 - (body[0] >> 2 & 3)]
