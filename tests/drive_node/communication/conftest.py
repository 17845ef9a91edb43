"""A stranger at the bus of one drive: raw frames in, raw frames out."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import can
import pytest

from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS

NODE = 3


@dataclass
class Stranger:
    """A master of its own on the bus of a drive. Frames are written as hexadecimal digits.

    heard: identifier and data of everything the drive has sent; times_ns: when each frame ended.
    """

    bench: Any
    port: SimBus
    heard: list[tuple[int, str]] = field(default_factory=list)
    times_ns: list[int] = field(default_factory=list)

    @property
    def node(self) -> DriveNode:
        node: DriveNode = self.bench.node
        return node

    def frames(self, can_id: int) -> list[str]:
        return [data for known, data in self.heard if known == can_id]

    def times_ms(self, can_id: int, since_ns: int = 0) -> list[float]:
        pairs = zip(self.times_ns, self.heard, strict=True)
        return [(t - since_ns) / MS for t, (known, _) in pairs if known == can_id]

    def send(self, can_id: int, data: str = "", *, remote: bool = False, dlc: int = 0) -> None:
        self.port.send(
            can.Message(
                arbitration_id=can_id,
                is_extended_id=False,
                is_remote_frame=remote,
                dlc=dlc if remote else None,
                data=None if remote else bytes.fromhex(data),
            )
        )

    def run_ms(self, time_ms: float) -> None:
        scheduler = self.bench.scheduler
        scheduler.run_until(scheduler.now_ns + round(time_ms * MS))

    def after(
        self, can_id: int, data: str = "", *, remote: bool = False, wait_ms: float = 1
    ) -> list[tuple[int, str]]:
        """Send a frame; return what the drive sends within `wait_ms`."""
        begin = len(self.heard)
        self.send(can_id, data, remote=remote)
        self.run_ms(wait_ms)
        return self.heard[begin:]

    def sdo(self, request: str) -> str:
        """Send an SDO request; return the one answer, or "" when there is none."""
        answers = [data for can_id, data in self.after(0x600 + NODE, request) if can_id == 0x583]
        assert len(answers) <= 1
        return answers[0] if answers else ""

    def write(self, index: int, sub: int, value: int, size: int) -> int:
        """Write up to 4 bytes expedited; return 0 or the abort code."""
        head = 0x23 | 4 - size << 2
        data = (value & (1 << 8 * size) - 1).to_bytes(4, "little")
        return self._code(self.sdo(_request(head, index, sub) + data.hex()))

    def read(self, index: int, sub: int = 0) -> int:
        """Read up to 4 bytes expedited, unsigned."""
        answer = bytes.fromhex(self.sdo(_request(0x40, index, sub) + "00000000"))
        assert answer[0] & 0xE3 == 0x43, answer.hex()
        return int.from_bytes(answer[4 : 8 - (answer[0] >> 2 & 3)], "little")

    def read_code(self, index: int, sub: int = 0) -> int:
        """Return the abort code of a read, 0 when there is none."""
        return self._code(self.sdo(_request(0x40, index, sub) + "00000000"))

    def nmt(self, command: int, node: int = NODE, wait_ms: float = 1) -> list[tuple[int, str]]:
        return self.after(0, bytes((command, node)).hex(), wait_ms=wait_ms)

    def enable(self) -> None:
        """Walk to operation enabled by PDO, one SYNC per ms."""
        self.nmt(1)
        for controlword in ("0600", "0700", "0f00"):
            self.send(0x203, controlword + "00000000" + "0000")
            self.run_ms(0.5)
            self.after(0x80)
        assert self.node.state is State.OPERATION_ENABLED

    @staticmethod
    def _code(answer: str) -> int:
        data = bytes.fromhex(answer)
        assert data, "no answer"
        return int.from_bytes(data[4:], "little") if data[0] == 0x80 else 0


def _request(head: int, index: int, sub: int) -> str:
    return bytes((head, index & 0xFF, index >> 8, sub)).hex()


@pytest.fixture
def stranger(drive_bench: Callable[..., Any]) -> Callable[..., Stranger]:
    """Make a stranger alone with a new drive, 1 ms after its boot; arguments of the bench."""

    def make(**arguments: Any) -> Stranger:
        bench = drive_bench(**arguments)
        bench.master.bus.shutdown()
        stranger = Stranger(bench, bench.segment.port("stranger"))

        def listen(message: can.Message) -> None:
            stranger.heard.append((message.arbitration_id, message.data.hex()))
            stranger.times_ns.append(bench.scheduler.now_ns)

        stranger.port.attach(listen)
        return stranger

    return make
