"""Ports with several callbacks and filters, ports of one name, senders that are error passive."""

from collections.abc import Callable

import can
import pytest

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.controller import Controller
from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.frame import Frame, data_frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import Scheduler

Bits = Callable[[Frame], int]


def test_each_callback_gets_each_frame_with_its_time_in_seconds(
    segment: Segment, naive_bits: Bits
) -> None:
    sender, port = segment.port("sender"), segment.port("port")
    found: list[tuple[str, int, float]] = []
    for name in ("first", "second"):
        port.attach_data(lambda can_id, _data, at, name=name: found.append((name, can_id, at)))
        port.attach(
            lambda msg, name=name: found.append(
                (f"{name} of all", msg.arbitration_id, msg.timestamp)
            )
        )
        port.attach_remote(lambda can_id, name=name: found.append((f"{name} remote", can_id, 0.0)))
    sender.send_raw(0x123, b"\x01")
    segment.scheduler.run_until(MS)
    at_s = found[0][2]
    assert sorted(found) == [
        ("first", 0x123, at_s), ("first of all", 0x123, at_s), ("second", 0x123, at_s),
        ("second of all", 0x123, at_s),
    ]  # fmt: skip
    bits = naive_bits(data_frame(0x123, b"\x01")) - 3  # SOF to end of frame, of 1 us each
    assert at_s == pytest.approx(bits * 1e-6, abs=1e-12)
    found.clear()
    sender.send(can.Message(arbitration_id=0x701, is_extended_id=False, is_remote_frame=True))
    segment.scheduler.run_until(2 * MS)
    assert sorted(name for name, *_ in found) == [
        "first of all", "first remote", "second of all", "second remote",
    ]  # fmt: skip


def test_a_remote_frame_has_no_data_whatever_its_message_has(segment: Segment) -> None:
    """Its length is that of the answer that it asks for."""
    frames: list[Frame] = []
    sender, _ = segment.port("sender"), segment.port("other")
    segment.observe(lambda _time, _name, frame, _is_error: frames.append(frame))
    message = can.Message(arbitration_id=0x701, is_extended_id=False, is_remote_frame=True, dlc=2)
    message.data = bytearray(b"\x01\x02")
    sender.send(message)
    segment.scheduler.run_until(MS)
    assert frames == [Frame(0x701, b"", False, True, 2)]


@pytest.mark.parametrize("data", [None, b"", b"\x07"])
def test_a_message_of_a_network_has_the_bytes_that_it_was_given(
    segment: Segment, data: bytes | None
) -> None:
    """SYNC without a counter has none."""
    frames: list[Frame] = []
    network = SimNetwork(segment.port("master")).connect()
    segment.port("other")
    segment.observe(lambda _time, _name, frame, _is_error: frames.append(frame))
    network.send_message(0x080, data)
    segment.scheduler.run_until(MS)
    assert frames == [data_frame(0x080, data or b"")]
    network.disconnect()


def test_who_leaves_takes_no_port_of_its_name_along(segment: Segment) -> None:
    """Two disturbers of one name may be on a bus."""
    first, second, third = (segment.port(name) for name in ("same", "same", "other"))
    first.shutdown()
    assert segment.ports == (second, third)
    second.send_raw(0x100, b"")
    segment.scheduler.run_until(MS)
    message = third.recv(0)
    assert message is not None
    assert message.arbitration_id == 0x100


def _hook(frame: Frame, _port: Controller, attempt: int) -> ErrorAtBit | None:
    """17 errors make a sender passive, and one success leaves it so."""
    return ErrorAtBit(20) if frame.arbitration_id == 0x100 and attempt < 17 else None


@pytest.mark.parametrize("other_sends", [True, False])
def test_a_passive_sender_leaves_the_bus_to_others_after_each_frame(
    segment: Segment, naive_bits: Bits, other_sends: bool
) -> None:
    """ISO 11898-1: for 8 bits more than the intermission, also after a frame that passed."""
    sender, other = segment.port("sender"), segment.port("other")
    ends: dict[int, int] = {}

    def observe(time_ns: int, _name: str, frame: Frame, is_error: bool) -> None:
        if is_error:
            return
        ends[frame.arbitration_id] = time_ns
        if frame.arbitration_id == 0x100 and other_sends:
            other.send_raw(0x700, b"")

    segment.observe(observe)
    segment.add_fault(_hook)
    sender.send_raw(0x100, b"")
    sender.send_raw(0x101, b"")
    segment.scheduler.run_until(20 * MS)
    assert (sender.tec, sender.error_state) == (17 * 8 - 2, ErrorState.PASSIVE)
    second, third = (naive_bits(data_frame(can_id, b"")) for can_id in (0x101, 0x700))
    free_ns = ends[0x100] + 3 * US
    if other_sends:
        assert list(ends) == [0x100, 0x700, 0x101]
        assert ends[0x700] == free_ns + (third - 3) * US
        assert ends[0x101] == free_ns + (third + second - 3) * US
    else:
        assert ends[0x101] == free_ns + (8 + second - 3) * US


def test_receivers_of_a_frame_with_a_late_error_have_received_it(segment: Segment) -> None:
    """Two errors, then one in the last bit: each receiver counts 2, then 1 less twice."""
    sender, receiver = segment.port("sender"), segment.port("receiver")
    errors = {0: ErrorAtBit(20), 1: ErrorAtBit(20), 2: ErrorAtBit(999)}
    counts: list[tuple[int, int, bool]] = []
    segment.add_fault(lambda _frame, _port, attempt: errors.get(attempt))
    segment.observe(
        lambda _t, _n, _f, is_error: counts.append((sender.tec, receiver.rec, is_error))
    )
    sender.send_raw(0x100, b"\x01")
    segment.scheduler.run_until(2 * MS)
    # As they are when each frame ends, before anyone counts it
    assert counts == [
        (0, 0, True), (8, 1, True), (16, 2, False), (16, 1, True), (24, 1, False),
    ]  # fmt: skip
    assert (sender.tec, receiver.rec) == (23, 0)


@pytest.mark.parametrize("bitrate", [300_000, 83_333, 666_667])
def test_each_frame_begins_where_the_one_before_it_has_ended_in_whole_bits(
    scheduler: Scheduler, naive_bits: Bits, bitrate: int
) -> None:
    """A frame with its intermission is rounded as one time, with and without a fault that looks."""

    def duration_ns(bits: int) -> int:
        return (bits * 10**9 + bitrate // 2) // bitrate

    for looks in (True, False):
        with Segment(f"odd {looks}", bitrate, scheduler) as segment:
            sender, _ = segment.port("sender"), segment.port("other")
            ends: list[int] = []
            segment.observe(lambda time_ns, *_, ends=ends: ends.append(time_ns))
            if looks:
                segment.add_fault(lambda *_: None)
            frames = [
                data_frame(0x100 + number, bytes([number] * (number % 8))) for number in range(12)
            ]
            begin_ns = scheduler.now_ns
            for frame in frames:
                sender.send_raw(frame.arbitration_id, frame.data)
            scheduler.run_until(begin_ns + 30 * MS)
            for frame, end_ns in zip(frames, ends, strict=True):
                assert end_ns == begin_ns + duration_ns(naive_bits(frame) - 3)
                begin_ns += duration_ns(naive_bits(frame))
