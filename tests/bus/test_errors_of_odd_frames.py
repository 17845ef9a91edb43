"""Errors of remote and extended frames, of two senders alone, and own frames while errors count."""

from typing import Any

import can
import pytest

from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler


@pytest.mark.parametrize("is_remote", [False, True])
@pytest.mark.parametrize("can_id", [0x703, 0x1ABCDEF])
def test_an_error_frame_has_the_identifier_alone_of_what_it_destroyed(
    scheduler: Scheduler, segment: Segment, can_id: int, is_remote: bool
) -> None:
    """No data, no length, and no request; then comes the frame itself."""
    frames: list[tuple[Frame, bool]] = []
    segment.observe(lambda _time, _name, frame, is_error: frames.append((frame, is_error)))
    sender, _ = segment.port("sender"), segment.port("receiver")
    segment.add_fault(lambda _frame, _port, attempt: None if attempt else ErrorAtBit(20))
    is_extended = can_id > 0x7FF
    given: dict[str, Any] = {"dlc": 4} if is_remote else {"data": b"\x01\x02\x03\x04"}
    sender.send(
        can.Message(
            arbitration_id=can_id, is_extended_id=is_extended, is_remote_frame=is_remote, **given
        )
    )
    scheduler.run_until(MS)
    whole = Frame(can_id, given.get("data", b""), is_extended, is_remote, 4)
    assert frames == [(Frame(can_id, b"", is_extended, False, 0), True), (whole, False)]


def test_two_senders_of_one_frame_alone_on_a_bus_have_no_acknowledgement(
    scheduler: Scheduler, segment: Segment
) -> None:
    """ISO 11898-1: receivers acknowledge. 16 errors of 8 make both error passive, none goes off;
    a third one that comes lets the frame through."""
    kinds: list[bool] = []
    segment.observe(lambda _time, _name, _frame, is_error: kinds.append(is_error))
    ports = [segment.port(name) for name in ("one", "two")]
    for port in ports:
        port.send_raw(0x181, b"same")
    scheduler.run_until(10 * MS)
    assert len(kinds) > 20
    assert all(kinds)
    assert [port.tec for port in ports] == [128, 128]
    third = segment.port("third")
    scheduler.run_until(12 * MS)
    assert kinds[-1] is False
    received = third.recv(0)
    assert received is not None
    assert bytes(received.data) == b"same"
    assert [port.tec for port in ports] == [127, 127]


def test_own_frames_come_back_also_while_errors_are_counted(
    scheduler: Scheduler, segment: Segment
) -> None:
    """python-can: `is_rx` is False for one's own. After an error the counts run down."""
    own = segment.port("own", receive_own_messages=True)
    other = segment.port("other")
    segment.add_fault(
        lambda frame, _port, attempt: ErrorAtBit(20) if frame[1] == b"\1" and not attempt else None
    )
    heard: list[tuple[int, bool]] = []
    own.attach(lambda msg: heard.append((msg.data[0], msg.is_rx)))
    tecs = []
    for number in (1, 2, 3):
        own.send_raw(0x181, bytes([number]))
        scheduler.run_until(number * MS)
        tecs.append(own.tec)
    assert heard == [(1, False), (2, False), (3, False)]
    assert tecs == [7, 6, 5]
    other.send_raw(0x182, b"\x09")
    scheduler.run_until(4 * MS)
    assert heard[-1] == (9, True)
    assert [other.recv(0) is not None for _ in range(4)] == [True, True, True, False]


@pytest.mark.parametrize("wanted", [(), ("one",), ("two",), ("one", "two")])
def test_each_of_several_senders_of_one_frame_has_its_own_back_where_it_asked(
    scheduler: Scheduler, segment: Segment, wanted: tuple[str, ...]
) -> None:
    """All send the same bits, so that the frame gets through once; a third hears it once."""
    ports = {
        name: segment.port(name, receive_own_messages=name in wanted) for name in ("one", "two")
    }
    third = segment.port("third")
    for port in ports.values():
        port.send_raw(0x181, b"same")
    scheduler.run_until(MS)
    for name, port in ports.items():
        own = port.recv(0)
        assert (None if own is None else own.is_rx) == (False if name in wanted else None)
        assert port.recv(0) is None
    heard = third.recv(0)
    assert heard is not None
    assert (heard.is_rx, bytes(heard.data)) == (True, b"same")
    assert third.recv(0) is None
