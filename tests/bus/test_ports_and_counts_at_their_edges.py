"""Names of ports, waits of no time, own remote frames, counts of who is passive as a receiver."""

import hashlib
import struct
from typing import Any

import can
import pytest

from axisrig.bench.bus.can.confinement import ErrorCounters, ErrorState
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.bus.ethercat.frame_hash import FrameHash
from axisrig.bench.bus.journal import Journal
from axisrig.kernel.time.clock import MS


@pytest.mark.parametrize(("rec", "tec"), [(0, 8), (127, 8), (128, 0)])
def test_without_an_acknowledgement_only_who_is_not_passive_counts(rec: int, tec: int) -> None:
    """ISO 11898-1: also where the receive error count alone has made it passive."""
    counters = ErrorCounters()
    for _ in range(rec):
        counters.receive_failed()
    assert counters.state is (ErrorState.PASSIVE if rec > 127 else ErrorState.ACTIVE)
    counters.transmit_failed(is_unacknowledged=True)
    assert (counters.tec, counters.rec) == (tec, rec)
    counters.transmit_failed()
    assert counters.tec == tec + 8


def test_ports_without_a_name_are_numbered_from_1_on(segment: Segment) -> None:
    named = [SimBus(segment), SimBus(segment, port_name="drive"), SimBus(segment)]
    assert [port.port_name for port in named] == ["port1", "drive", "port3"]
    assert named[2].channel_info.endswith(", port3")


@pytest.mark.parametrize("timeout_s", [0.0, -1.0])
def test_a_wait_of_no_time_takes_none(segment: Segment, timeout_s: float) -> None:
    """Whatever is planned for later; what is there already is no wait."""
    port = segment.port("drive")
    segment.scheduler.run_until(MS)
    seen: list[int] = []
    segment.scheduler.call_at(2 * MS, 0, lambda: seen.append(1))  # type: ignore[arg-type]
    assert port.run_while(lambda: True, timeout_s) is False
    assert (segment.now_ns, seen) == (MS, [])
    assert port.run_while(lambda: False, timeout_s) is True


@pytest.mark.parametrize("asks", [True, False])
def test_a_port_is_not_asked_by_its_own_remote_frames(segment: Segment, asks: bool) -> None:
    """Also where it has its own frames back."""
    own = segment.port("own", receive_own_messages=asks)
    other = segment.port("other")
    asked: dict[str, list[int]] = {"own": [], "other": []}
    own.attach_remote(asked["own"].append)
    other.attach_remote(asked["other"].append)
    own.send(can.Message(arbitration_id=0x703, is_remote_frame=True, is_extended_id=False))
    segment.scheduler.run_until(MS)
    assert asked == {"own": [], "other": [0x703]}
    back = own.recv(0)
    assert (back is not None) is asks


def test_a_hash_of_lines_is_that_of_the_documented_bytes() -> None:
    """Time, name with its length, length of the frame, the frame; also what waits in a journal."""
    journal = Journal()
    found = FrameHash(journal)
    rows: list[tuple[int, str, Any, bool]] = [
        (5, "ec1", b"abc", False), (-1, "line", b"", False), (7, "ec1", b"d", False)
    ]  # fmt: skip
    journal.entries += rows
    expected = b"".join(
        struct.pack("<q", at) + bytes([len(name)]) + name.encode()
        + struct.pack("<H", len(frame)) + frame
        for at, name, frame, _ in rows
    )  # fmt: skip
    assert found.hexdigest() == hashlib.sha256(expected).hexdigest()
    assert (found.frames, journal.entries) == (3, [])
