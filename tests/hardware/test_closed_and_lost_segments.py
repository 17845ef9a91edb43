"""A segment on a real interface that is closed, or lost while it sends or receives."""

from typing import Any

import can
import pytest

from axisrig.bench.bus.can import real_segment
from axisrig.bench.bus.can.real_segment import SEND_ERRORS_MAX, OutsideSegment
from axisrig.kernel.errors import UserError

MS = 1_000_000


def _shut_downs(bench: Any) -> list[str]:
    """Note each time that the interface of a bench is shut down."""
    noted: list[str] = []
    shut_down = bench.adapter.shutdown

    def note() -> None:
        noted.append("down")
        shut_down()

    bench.adapter.shutdown = note
    return noted


def test_a_closed_segment_has_shut_its_interface_down_once(make_bench: Any) -> None:
    bench = make_bench()
    noted = _shut_downs(bench)
    assert bench.segment.info != "no interface"
    bench.segment.close()
    assert (noted, bench.segment.info) == (["down"], "no interface")
    bench.segment.close()
    assert noted == ["down"]


@pytest.mark.parametrize("by", ["send", "receive"])
def test_a_lost_segment_has_shut_its_interface_down_and_waits_for_nobody(
    make_bench: Any, by: str
) -> None:
    bench = make_bench()
    noted, segment = _shut_downs(bench), bench.segment
    port = segment.port("cnc")
    segment.expect([0x181])
    bench.scheduler.call_at(MS, 0, lambda: port.send_raw(0x080, b""))
    bench.scheduler.run_until(2 * MS)
    assert segment.is_waiting
    refused = can.CanOperationError("no device")

    def fail(*_: object) -> None:
        raise refused

    if by == "receive":
        bench.adapter.recv = fail
    else:
        bench.adapter.send = fail
        for _ in range(SEND_ERRORS_MAX + 1):
            port.send_raw(0x201, b"")
    bench.scheduler.run_until(3 * MS)
    assert (segment.lost, noted, segment.info) == ("no device", ["down"], "no interface")
    assert not segment.is_waiting
    assert bench.deadlines.send_errors == (SEND_ERRORS_MAX + 1 if by == "send" else 0)
    bench.scheduler.run_until(5 * MS)  # time goes on without it
    assert bench.scheduler.now_ns == 5 * MS


def test_a_bus_that_is_open_again_is_waited_for_by_its_own_file(
    make_bench: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each opening has another file; one without any is asked with its time-out."""
    bench = make_bench()
    segment, waited = bench.segment, list[tuple[int, float]]()
    monkeypatch.setattr(real_segment.select, "select", lambda files, *rest: (
        waited.append((files[0], rest[-1]))))  # fmt: skip
    for file in (11, 12, None):
        bench.adapter.broken = can.CanOperationError("gone")
        assert segment.receive(0.0) is None
        assert segment.lost == "gone"
        bench.adapter.broken = None
        if file is None:
            monkeypatch.delattr(type(bench.adapter), "fileno")
        else:
            monkeypatch.setattr(type(bench.adapter), "fileno", lambda _, f=file: f, raising=False)
        assert segment.reopen()
        begin_ns = bench.wall.now_ns
        assert (segment.lost, segment.receive(0.25)) == (None, None)
        # Whoever has a file is not asked to wait as well
        assert bench.wall.now_ns - begin_ns == (250 * MS if file is None else 0)
    assert waited == [(11, 0.25), (12, 0.25)]


@pytest.mark.parametrize("refused_in_a_row", [1, 7, SEND_ERRORS_MAX])
def test_frames_that_were_not_taken_count_in_a_row_only(
    make_bench: Any, refused_in_a_row: int
) -> None:
    """However many there are in a long run: one that is taken begins a new row."""
    bench = make_bench()
    port, send = bench.segment.port("drive"), bench.adapter.send
    left = [0]

    def sometimes(message: can.Message, timeout: float | None = None) -> None:
        if left[0]:
            left[0] -= 1
            raise can.CanOperationError("buffer full")
        send(message, timeout)

    bench.adapter.send = sometimes
    rows = 3 * SEND_ERRORS_MAX // refused_in_a_row + 2
    for row in range(1, rows + 1):
        left[0] = refused_in_a_row
        for _ in range(refused_in_a_row):
            port.send_raw(0x201, b"")
        port.send_raw(0x202, bytes([row]))
        bench.scheduler.run_until(row * MS)
        assert bench.segment.lost is None
    assert bench.deadlines.send_errors == rows * refused_in_a_row > SEND_ERRORS_MAX
    assert bench.sent_ids() == [0x202] * rows
    left[0] = SEND_ERRORS_MAX + 1
    for _ in range(SEND_ERRORS_MAX + 1):
        port.send_raw(0x201, b"")
    bench.scheduler.run_until((rows + 1) * MS)
    assert bench.segment.lost == "buffer full"


def test_a_sync_that_is_not_taken_is_not_waited_for_and_not_counted(make_bench: Any) -> None:
    """Its answers cannot come; the one after it is a SYNC again."""
    bench = make_bench()
    segment, port, send = bench.segment, bench.segment.port("cnc"), bench.adapter.send
    segment.expect([0x181])

    def fail(*_: object) -> None:
        raise can.CanOperationError("buffer full")

    bench.adapter.send = fail
    port.send_raw(0x080, b"")
    bench.scheduler.run_until(MS)
    assert (segment.is_waiting, bench.deadlines.cycles) == (False, 0)
    bench.adapter.send = send
    port.send_raw(0x080, b"")
    bench.scheduler.run_until(2 * MS)
    assert (segment.is_waiting, bench.deadlines.cycles) == (True, 1)


@pytest.mark.parametrize(
    ("can_id", "is_extended", "waits"),
    [(0x080, False, True), (0x080, True, False), (0x081, False, False), (0x100, False, False)],
)
def test_the_sync_alone_is_waited_for(
    make_bench: Any, can_id: int, is_extended: bool, waits: bool
) -> None:
    """CiA 301: identifier 0x80 with 11 bits."""
    bench = make_bench()
    bench.segment.expect([0x181])
    bench.segment.port("cnc").send(can.Message(arbitration_id=can_id, is_extended_id=is_extended))
    bench.scheduler.run_until(MS)
    assert bench.sent_ids() == [can_id]
    assert bench.segment.is_waiting is waits


@pytest.mark.parametrize("is_extended", [True, False])
def test_a_frame_of_can_fd_is_passed_over_and_the_next_one_is_heard(
    make_bench: Any, make_frame: Any, is_extended: bool
) -> None:
    bench = make_bench()
    heard: list[tuple[int, bytes]] = []
    bench.segment.observe(lambda _t, _n, f, _e: heard.append((f.arbitration_id, f.data)))
    now_ns = bench.wall.now_ns
    long = can.Message(
        arbitration_id=0x181, is_extended_id=is_extended, is_fd=True, data=bytes(12), dlc=12
    )
    bench.adapter.coming += [(now_ns + MS, long), (now_ns + 2 * MS, make_frame(0x182, 7))]
    bench.scheduler.run_until(3 * MS)
    assert heard == [(0x182, b"\x07")]
    assert bench.segment.load().frames == 1


def test_a_lost_bus_that_cannot_be_opened_stays_lost_and_keeps_its_reason(make_bench: Any) -> None:
    """One that is there is not opened a second time."""
    bench, openings = make_bench(), list[bool]()
    is_there = True

    def opened() -> can.BusABC:
        openings.append(is_there)
        if not is_there:
            raise UserError("no such interface")
        return bench.adapter

    segment = OutsideSegment("other", 1_000_000, bench.scheduler, opened)
    assert segment.reopen()
    assert openings == [True]
    is_there, bench.adapter.broken = False, can.CanOperationError("gone")
    assert segment.receive(0.0) is None
    for _ in range(2):
        assert (segment.reopen(), segment.lost, segment.info) == (False, "gone", "no interface")
    is_there, bench.adapter.broken = True, None
    assert (segment.reopen(), segment.lost) == (True, None)
    assert openings == [True, False, False, True]
    segment.close()
