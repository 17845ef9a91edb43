"""What a port takes into its transmit queue, in which order it sends, and what it loses."""

import threading
from collections.abc import Callable

import can
import pytest

from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.controller import QueueKind
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import Scheduler

Send = Callable[[SimBus, int], None]
WAYS: dict[str, Send] = {
    "raw": lambda port, number: port.send_raw(0x100 + number, bytes([number])),
    "raw, 29 bits": lambda port, number: port.send_raw(0x10000 + number, bytes([number])),
    "message": lambda port, number: port.send(
        can.Message(arbitration_id=0x100 + number, is_extended_id=False, data=bytes([number]))
    ),
    "remote": lambda port, number: port.send(
        can.Message(arbitration_id=0x100 + number, is_extended_id=False, is_remote_frame=True)
    ),
}


def frames_of(segment: Segment) -> list[Frame]:
    found: list[Frame] = []
    segment.observe(lambda _time, _name, frame, is_error: found.append(frame))
    return found


@pytest.mark.parametrize(
    ("can_id", "is_extended"),
    [(0, False), (0x7FE, False), (0x7FF, False), (0x800, True), (0x1FFF_FFFF, True)],
)
@pytest.mark.parametrize("data", [b"", b"\x01", bytes(range(8))])
def test_identifiers_above_11_bits_are_extended_ones(
    scheduler: Scheduler, segment: Segment, can_id: int, is_extended: bool, data: bytes
) -> None:
    frames = frames_of(segment)
    port, _ = segment.port("a"), segment.port("b")
    port.send_raw(can_id, data)
    scheduler.run_until(MS)
    assert frames == [Frame(can_id, data, is_extended, False, len(data))]


@pytest.mark.parametrize(
    ("can_id", "size", "words"),
    [
        (-1, 0, "identifier -0x1 is outside 0..0x1fffffff"),
        (0x2000_0000, 0, "identifier 0x20000000 is outside 0..0x1fffffff"),
        (0x7FF, 9, "9 data bytes in a classical CAN frame"),
        (0x800, 9, "9 data bytes in a classical CAN frame"),
        (0, 64, "64 data bytes in a classical CAN frame"),
    ],
)  # fmt: skip
def test_what_is_no_frame_is_refused_and_nothing_is_sent(
    scheduler: Scheduler, segment: Segment, can_id: int, size: int, words: str
) -> None:
    frames = frames_of(segment)
    port, _ = segment.port("a"), segment.port("b")
    with pytest.raises(ValueError, match=words):
        port.send_raw(can_id, bytes(size))
    scheduler.run_until(MS)
    assert (frames, port.discarded, len(port.pending)) == ([], 0, 0)


@pytest.mark.parametrize("way", WAYS)
def test_no_other_thread_may_send(scheduler: Scheduler, segment: Segment, way: str) -> None:
    frames, errors = frames_of(segment), list[str]()
    port, _ = segment.port("a"), segment.port("b")

    def foreign() -> None:
        try:
            WAYS[way](port, 1)
        except RuntimeError as error:
            errors.append(str(error))

    thread = threading.Thread(target=foreign)
    thread.start()
    thread.join()
    scheduler.run_until(MS)
    assert errors == ["a simulated bus belongs to the thread that made it"]
    assert frames == []


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("by", ["power", "bus-off"])
def test_what_is_requested_while_a_port_takes_no_part_is_lost_and_counted(
    scheduler: Scheduler, segment: Segment, way: str, by: str
) -> None:
    """Three wait when it goes, two come meanwhile; what comes afterwards is sent."""
    frames = frames_of(segment)
    port, _ = segment.port("a"), segment.port("b")
    for number in range(3):
        WAYS[way](port, number)
    if by == "power":
        port.power_off()
    else:
        port.force_bus_off()
    assert (port.discarded, len(port.pending), port.takes_part) == (3, 0, False)
    for number in range(3, 5):
        WAYS[way](port, number)
    scheduler.run_until(MS)
    assert (port.discarded, frames) == (5, [])
    if by == "power":
        port.power_on()
    scheduler.run_until(10 * MS)  # 128 times 11 bits are 1.408 ms
    assert port.takes_part
    WAYS[way](port, 7)
    scheduler.run_until(11 * MS)
    assert [frame.arbitration_id & 0xFF for frame in frames] == [7]
    assert port.discarded == 5


@pytest.mark.parametrize(
    ("queue", "sent"),
    [("fifo", [3, 1, 2, 1, 0]), ("mailbox", [0, 1, 1, 2, 3])],
)
def test_a_fifo_sends_in_the_order_of_requests_a_mailbox_the_lowest_identifier(
    scheduler: Scheduler, segment: Segment, queue: QueueKind, sent: list[int]
) -> None:
    """All of one instant; two of one identifier keep their order."""
    frames = frames_of(segment)
    port, _ = segment.port("a", queue), segment.port("b")
    for number, can_id in enumerate((3, 1, 2, 1, 0)):
        port.send_raw(0x100 + can_id, bytes([number]))
    scheduler.run_until(2 * MS)
    assert [frame.arbitration_id - 0x100 for frame in frames] == sent
    assert [frame.data[0] for frame in frames if frame.arbitration_id == 0x101] == [1, 3]


def test_error_states_are_called_back_each_and_bus_off_alone(
    scheduler: Scheduler, segment: Segment
) -> None:
    """Two who want to know, in their order; each change once."""
    port, _ = segment.port("a"), segment.port("b")
    called: list[str] = []
    port.on_error_state(lambda state: called.append(f"first {state}"))
    port.on_bus_off(lambda: called.append("off"))
    port.on_error_state(lambda state: called.append(f"last {state}"))
    for _ in range(16):  # of 8 each: 128
        port.errors.transmit_failed()
        port.update_state()
    assert called == ["first error passive", "last error passive"]
    called.clear()
    port.force_bus_off()
    port.update_state()
    assert called == ["first bus-off", "off", "last bus-off"]
    called.clear()
    scheduler.run_until(10 * MS)
    assert called == ["first error active", "last error active"]
    assert (port.tec, port.rec, port.error_state) == (0, 0, ErrorState.ACTIVE)
    states = [(name, state) for _, name, state in segment.state_changes]
    assert states == [("a", state) for state in
                      (ErrorState.PASSIVE, ErrorState.BUS_OFF, ErrorState.ACTIVE)]  # fmt: skip


def test_a_port_without_power_does_not_recover_and_has_no_errors_when_it_is_back(
    scheduler: Scheduler, segment: Segment
) -> None:
    port, _ = segment.port("a"), segment.port("b")
    port.force_bus_off()
    port.power_off()
    port.recover()
    scheduler.run_until(10 * MS)
    assert (port.error_state, port.takes_part) == (ErrorState.BUS_OFF, False)
    port.power_on()
    assert (port.error_state, port.tec, port.takes_part) == (ErrorState.ACTIVE, 0, True)
    port.power_on()  # nothing changes
    port.power_off()
    port.power_off()
    assert not port.takes_part


def test_a_port_that_left_the_bus_refuses_to_send(scheduler: Scheduler, segment: Segment) -> None:
    frames = frames_of(segment)
    port, other = segment.port("a"), segment.port("b")
    port.shutdown()
    for send in WAYS.values():
        with pytest.raises(can.CanOperationError, match="axisrig segment bus, a is shut down"):
            send(port, 1)
    scheduler.run_until(MS)
    assert (frames, segment.ports) == ([], (other,))
