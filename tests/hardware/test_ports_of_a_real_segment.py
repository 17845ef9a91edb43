"""Ports of one process on a real bus: who hears whom, what is counted, and what a lost bus does."""

from typing import Any

import can
import pytest

from axisrig.bench.bus.can.frame import Frame, data_frame, frame_bits

MS = 1_000_000
EXTENDED_KEY = 0x8000_0000


@pytest.mark.parametrize("names", [("cnc", "x"), ("cnc", "x", "y")])
def test_each_other_port_hears_a_frame_also_where_there_are_two(
    make_bench: Any, names: tuple[str, ...]
) -> None:
    bench = make_bench()
    heard: dict[str, list[int]] = {name: [] for name in names}
    ports = {name: bench.segment.port(name) for name in names}
    for name, port in ports.items():
        port.attach_data(lambda can_id, _data, _time, name=name: heard[name].append(can_id))
    for number, name in enumerate(names):
        send = lambda name=name, number=number: ports[name].send_raw(0x181 + number, b"1")  # noqa: E731
        bench.scheduler.call_at((1 + number) * MS, 0, send)
    bench.scheduler.run_until(9 * MS)
    sent = [0x181 + number for number in range(len(names))]
    assert bench.sent_ids() == sent
    for number, name in enumerate(names):
        assert heard[name] == [can_id for can_id in sent if can_id != 0x181 + number]


@pytest.mark.parametrize("wanted", [(), ("cnc",), ("x",), ("cnc", "x")])
def test_who_asks_for_its_own_frames_has_them_as_sent_by_itself(
    make_bench: Any, make_frame: Any, wanted: tuple[str, ...]
) -> None:
    """Frames from outside are nobody's own."""
    bench = make_bench()
    ports = {
        name: bench.segment.port(name, receive_own_messages=name in wanted) for name in ("cnc", "x")
    }
    bench.scheduler.call_at(MS, 0, lambda: ports["cnc"].send_raw(0x201, b"1"))
    bench.adapter.coming.append((bench.wall.now_ns + 3 * MS, make_frame(0x300, 7)))
    bench.scheduler.run_until(5 * MS)
    found: dict[str, list[tuple[int, bool]]] = {}
    for name, port in ports.items():
        found[name] = []
        while (message := port.recv(0)) is not None:
            found[name].append((message.arbitration_id, message.is_rx))
    own = [(0x201, False)] if "cnc" in wanted else []
    assert found == {"cnc": [*own, (0x300, True)], "x": [(0x201, True), (0x300, True)]}


def test_identifiers_of_29_bits_are_others_than_short_ones_of_their_number(make_bench: Any) -> None:
    """Out and in, in the load too."""
    bench = make_bench()
    port = bench.segment.port("cnc")
    seen: list[tuple[int, bool]] = []
    bench.segment.observe(
        lambda _t, _n, frame, _e: seen.append((frame.arbitration_id, frame.is_extended_id))
    )
    sent = can.Message(arbitration_id=0x123, is_extended_id=True, data=b"12")
    bench.scheduler.call_at(MS, 0, lambda: port.send(sent))
    bench.scheduler.call_at(MS + 1, 0, lambda: port.send_raw(0x123, b"12"))
    for at_ms, (can_id, is_extended) in enumerate([(0x181, True), (0x181, False)], 3):
        message = can.Message(arbitration_id=can_id, is_extended_id=is_extended, data=b"1")
        bench.adapter.coming.append((bench.wall.now_ns + at_ms * MS, message))
    bench.scheduler.run_until(6 * MS)
    assert seen == [(0x123, True), (0x123, False), (0x181, True), (0x181, False)]
    assert [msg.is_extended_id for _, msg in bench.adapter.sent] == [True, False]
    figures = bench.segment.load()
    assert set(figures.worst_delay_ns) == {
        0x123, 0x181, 0x123 | EXTENDED_KEY, 0x181 | EXTENDED_KEY
    }  # fmt: skip
    frames = [Frame(i, data, True, False, len(data)) for i, data in ((0x123, b"12"), (0x181, b"1"))]
    frames += [data_frame(0x123, b"12"), data_frame(0x181, b"1")]
    assert figures.busy_bits == sum(map(frame_bits, frames))


def test_a_29_bit_frame_of_the_number_of_sync_is_no_sync(make_bench: Any) -> None:
    """Neither out, where nobody is waited for then, nor in."""
    bench = make_bench()
    segment, port = bench.segment, bench.segment.port("cnc")
    segment.expect([0x181])
    message = can.Message(arbitration_id=0x080, is_extended_id=True)
    bench.scheduler.call_at(MS, 0, lambda: port.send(message))
    bench.scheduler.run_until(2 * MS)
    assert (segment.is_waiting, bench.deadlines.cycles) == (False, 0)
    bench.scheduler.call_at(2 * MS, 0, lambda: port.send_raw(0x080, b""))
    bench.scheduler.run_until(3 * MS)
    assert (segment.is_waiting, bench.deadlines.cycles) == (True, 1)
    for is_extended in (True, False):
        sync = can.Message(arbitration_id=0x080, is_extended_id=is_extended)
        bench.adapter.coming.append((bench.wall.now_ns, sync))
        arrival = segment.receive(0.0)
        assert arrival is not None
        assert arrival[0] is not is_extended


def test_a_remote_frame_has_no_data_whatever_its_adapter_gives(make_bench: Any) -> None:
    bench = make_bench()
    seen: list[Frame] = []
    bench.segment.observe(lambda _t, _n, frame, _e: seen.append(frame))
    message = can.Message(arbitration_id=0x703, is_extended_id=False, is_remote_frame=True, dlc=2)
    message.data = bytearray(b"\7\7")
    bench.adapter.coming.append((bench.wall.now_ns + MS, message))
    bench.scheduler.run_until(3 * MS)
    assert seen == [Frame(0x703, b"", False, True, 2)]


def test_after_a_sync_those_are_waited_for_that_are_expected_by_then(
    make_bench: Any, make_frame: Any
) -> None:
    """An answer that stayed out is not waited for again once nobody expects it any more."""
    bench = make_bench()
    segment, port = bench.segment, bench.segment.port("cnc")
    for at_ms, expected in ((1, [0x181, 0x182]), (3, [0x183]), (5, [])):
        segment.expect(expected)
        bench.scheduler.call_at(at_ms * MS, 0, lambda: port.send_raw(0x080, b""))
        bench.scheduler.run_until(at_ms * MS + MS // 2)
        assert segment.is_waiting is bool(expected)
        for can_id in expected[-1:]:
            bench.adapter.coming.append((bench.wall.now_ns, make_frame(can_id)))
        bench.scheduler.run_until((at_ms + 1) * MS)
        assert segment.is_waiting is (len(expected) > 1)


def test_a_lost_bus_takes_the_time_of_a_wait_and_an_open_one_is_not_opened_again(
    make_bench: Any,
) -> None:
    bench = make_bench()
    segment = bench.segment
    assert segment.reopen()
    assert bench.openings == 1
    bench.adapter.broken = can.CanOperationError("gone")
    assert segment.receive(0.0) is None
    for wait_s in (0.25, 0.0, 0.005):
        begin_ns = bench.wall.now_ns
        assert segment.receive(wait_s) is None
        assert bench.wall.now_ns - begin_ns == round(wait_s * 1e9)
    bench.adapter.broken = None
    assert segment.reopen()
    assert segment.reopen()
    assert bench.openings == 2
    segment.close()
    assert segment.reopen()  # closed is not lost
    assert (bench.openings, segment.info) == (2, "no interface")
