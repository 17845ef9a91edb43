"""What the ports of this process get on a real bus, and in which order; interfaces that fail."""

from collections.abc import Callable
from typing import Any

import can
import pytest

from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.kernel.time.clock import MS, Phase

SYNC = 0x080


def test_two_ports_of_this_process_hear_each_other(make_bench: Any) -> None:
    bench = make_bench()
    ports = [bench.segment.port(name) for name in ("cnc", "x")]
    heard: list[tuple[int, int, bytes]] = []
    for number, port in enumerate(ports):
        port.attach_data(lambda can_id, data, _t, n=number: heard.append((n, can_id, data)))
    ports[0].send_raw(0x201, b"\x01")
    bench.scheduler.run_until(MS)
    ports[1].send_raw(0x181, b"\x02")
    bench.scheduler.run_until(2 * MS)
    assert heard == [(1, 0x201, b"\x01"), (0, 0x181, b"\x02")]


@pytest.mark.parametrize("ports", [2, 3])
def test_a_port_that_asks_for_its_own_frames_gets_them_as_its_own(
    make_bench: Any, ports: int
) -> None:
    """python-can: `is_rx` is False for a frame of one's own."""
    bench = make_bench()
    own = bench.segment.port("own", receive_own_messages=True)
    others = [bench.segment.port(f"other{n}") for n in range(ports - 1)]
    heard: list[tuple[int, bool]] = []
    own.attach(lambda msg: heard.append((msg.arbitration_id, msg.is_rx)))
    for port in others:
        port.attach(lambda msg: heard.append((-msg.arbitration_id, msg.is_rx)))
    own.send_raw(0x201, b"")
    bench.scheduler.run_until(MS)
    assert heard == [(0x201, False), *[(-0x201, True)] * len(others)]
    heard.clear()
    others[0].send_raw(0x181, b"")
    bench.scheduler.run_until(2 * MS)
    assert heard == [(0x181, True), *[(-0x181, True)] * (len(others) - 1)]


@pytest.mark.parametrize("from_outside", [True, False])
def test_a_frame_is_recorded_before_a_port_acts_on_it(
    make_bench: Any, make_frame: Any, from_outside: bool
) -> None:
    """An answer never stands before its request in a record."""
    bench = make_bench()
    drive, master = bench.segment.port("drive"), bench.segment.port("cnc")
    order: list[str] = []
    bench.segment.observe(lambda _t, _n, frame, _e: order.append(f"record {frame[0]:X}"))
    drive.attach_data(lambda can_id, _data, _time: order.append(f"port {can_id:X}"))
    if from_outside:
        bench.adapter.coming.append((bench.wall.now_ns + MS, make_frame(0x201, 1)))
    else:
        bench.scheduler.call_at(MS, Phase.APPLICATION, lambda: master.send_raw(0x201, b"\x01"))
    bench.scheduler.run_until(2 * MS)
    assert order == ["record 201", "port 201"]


def test_frames_that_are_expected_anew_replace_those_before(
    make_bench: Any, make_frame: Any
) -> None:
    bench = make_bench()
    segment, port = bench.segment, bench.segment.port("cnc")
    for expected in ([0x181, 0x182], [0x183], []):
        segment.expect(expected)
        port.send_raw(SYNC, b"")
        bench.scheduler.run_until(bench.scheduler.now_ns + MS)
        assert segment.is_waiting is bool(expected)
        for left, can_id in enumerate(reversed(expected)):
            assert segment.is_waiting, left
            bench.adapter.coming.append((bench.wall.now_ns, make_frame(can_id)))
            bench.scheduler.run_until(bench.scheduler.now_ns + MS)
        assert not segment.is_waiting


@pytest.mark.parametrize(
    ("can_id", "is_extended", "is_sync"),
    [(SYNC, False, True), (SYNC, True, False), (0x081, False, False), (0x181, False, False)],
)
def test_the_sync_from_outside_has_11_bits(
    make_bench: Any, can_id: int, is_extended: bool, is_sync: bool
) -> None:
    """CiA 301: 0x80 of 11 bits is the SYNC, by which the time of drives may go."""
    bench = make_bench()
    sent = can.Message(arbitration_id=can_id, is_extended_id=is_extended)
    bench.adapter.coming.append((bench.wall.now_ns, sent))
    arrival = bench.segment.receive(0.0)
    assert arrival is not None
    assert arrival[0] is is_sync


@pytest.mark.parametrize("error", [can.CanOperationError("gone"), OSError("gone")])
@pytest.mark.parametrize("by", ["close", "loss"])
def test_an_interface_that_cannot_be_shut_down_any_more_is_gone_all_the_same(
    make_bench: Any, error: Exception, by: str
) -> None:
    bench = make_bench()

    def fail() -> None:
        raise error

    bench.adapter.shutdown = fail
    if by == "close":
        bench.segment.close()
    else:
        bench.adapter.broken = can.CanOperationError("cable pulled")
        assert bench.segment.receive(0.0) is None
        assert bench.segment.lost == "cable pulled"
    assert bench.segment.info == "no interface"


@pytest.mark.parametrize(
    "error", [can.CanError("gone"), OSError("gone"), ValueError("gone")], ids=repr
)
def test_each_failure_of_receiving_loses_the_bus(make_bench: Any, error: Exception) -> None:
    """A ValueError is what `select` raises for a file that has been closed."""
    bench = make_bench()
    bench.adapter.broken = error
    bench.scheduler.run_until(MS)
    assert bench.segment.lost == "gone"


@pytest.mark.parametrize("timeout_ms", [0, 5, 250])
def test_a_lost_bus_takes_the_time_that_is_listened_to_it(make_bench: Any, timeout_ms: int) -> None:
    """Who asks again and again in vain would keep a processor busy."""
    bench = make_bench()
    bench.adapter.broken = can.CanError("gone")
    assert bench.segment.receive(0.0) is None
    begin_ns = bench.wall.now_ns
    assert bench.segment.receive(timeout_ms / 1000) is None
    assert bench.wall.now_ns - begin_ns == timeout_ms * MS


@pytest.mark.parametrize(
    "error",
    [NotImplementedError("none"), can.CanOperationError("none"), OSError("none")],
    ids=lambda error: type(error).__name__,
)
def test_an_interface_without_a_file_is_asked_with_its_timeout(
    make_bench: Any, make_frame: Any, error: Exception
) -> None:
    bench = make_bench()

    def no_file() -> int:
        raise error

    other: Callable[[], can.BusABC] = lambda: adapter  # noqa: E731
    adapter = type(bench.adapter)(bench.wall)
    adapter.fileno = no_file
    adapter.coming.append((bench.wall.now_ns + 3 * MS, make_frame(0x181)))
    segment = OutsideSegment("other", 1_000_000, bench.scheduler, other)
    assert segment.receive(0.002) is None
    assert segment.receive(0.002) is not None
    segment.close()
