"""A clock, a segment of 1 Mbit/s, and the wire written down bit by bit as an own reference."""

from collections.abc import Callable, Iterator

import can
import pytest

from axisrig.bench.bus.can.faults import ErrorAtBit, FaultAction
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

GENERATOR = 0b1100010110011001
"""x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1, written out from the CAN specification."""


def wire_bits(can_id: int, data: bytes, extended: bool, remote: bool, dlc: int) -> str:
    """Return SOF..CRC with stuff bits as text: polynomial division, then a walk over the bits."""
    if extended:
        identifier = f"{can_id:029b}"
        head = f"0{identifier[:11]}11{identifier[11:]}{remote:d}00{dlc:04b}"
    else:
        head = f"0{can_id:011b}{remote:d}00{dlc:04b}"
    head += "".join(f"{byte:08b}" for byte in data)
    rest = int(head, 2) << 15
    while rest.bit_length() > 15:
        rest ^= GENERATOR << (rest.bit_length() - 16)
    sent = ""
    run = ""
    for bit in head + f"{rest:015b}":
        sent += bit
        run = run + bit if run.endswith(bit) else bit
        if len(run) == 5:
            run = "1" if bit == "0" else "0"
            sent += run
    return sent


def fails(attempts: int, bit: int = 20, **details: object) -> Callable[..., FaultAction | None]:
    """Destroy the first `attempts` attempts of every frame."""
    return lambda frame, port, attempt: (
        ErrorAtBit(bit, **details) if attempt < attempts else None  # type: ignore[arg-type]
    )


class _Watcher(can.Listener):
    """Notes (time_ns, identifier, kind) of every frame that a tap shows."""

    def __init__(self, segment: Segment) -> None:
        self.segment = segment
        self.seen: list[tuple[int, int, str]] = []
        segment.tap(self)

    def on_message_received(self, msg: can.Message) -> None:
        kind = "error" if msg.is_error_frame else "remote" if msg.is_remote_frame else "data"
        assert round(msg.timestamp * 1e9) == self.segment.now_ns
        self.seen.append((self.segment.now_ns, msg.arbitration_id, kind))


@pytest.fixture(scope="session")
def watch() -> Callable[[Segment], list[tuple[int, int, str]]]:
    """Return the growing list of what passes over the wire: (time_ns, identifier, kind)."""
    return lambda segment: _Watcher(segment).seen


@pytest.fixture(scope="session")
def naive_wire() -> Callable[[int, bytes, bool, bool, int], str]:
    return wire_bits


@pytest.fixture(scope="session")
def naive_bits() -> Callable[[Frame], int]:
    """Length up to and with the intermission: 10 bits of tail, 3 of intermission."""
    return lambda frame: len(wire_bits(*frame)) + 13


@pytest.fixture
def scheduler() -> Scheduler:
    return new_scheduler()


@pytest.fixture
def segment(scheduler: Scheduler) -> Iterator[Segment]:
    with Segment("bus", 1_000_000, scheduler) as opened:
        yield opened
