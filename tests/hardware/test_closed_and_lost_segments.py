"""A segment on a real interface that is closed, or lost while it sends or receives."""

from typing import Any

import can
import pytest

from axisrig.bench.bus.can import real_segment
from axisrig.bench.bus.can.real_segment import SEND_ERRORS_MAX

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
