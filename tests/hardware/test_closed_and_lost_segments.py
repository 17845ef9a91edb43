"""A segment on a real interface that is closed, lost, or keeps no load for days of a run."""

from typing import Any

import can
import pytest

from axisrig.bench.bus.can.frame import data_frame, frame_bits
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


@pytest.mark.parametrize("keeps_load", [True, False])
def test_the_load_of_what_goes_out_and_comes_in_is_kept_where_it_is_wanted(
    make_bench: Any, make_frame: Any, keeps_load: bool
) -> None:
    bench = make_bench()
    segment = bench.segment
    segment.keeps_load = keeps_load
    seen: list[int] = []
    segment.observe(lambda _time, _name, frame, _is_error: seen.append(frame.arbitration_id))
    port = segment.port("cnc")
    bench.scheduler.call_at(MS, 0, lambda: port.send_raw(0x201, b"\x01\x02"))
    bench.adapter.coming.append((bench.wall.now_ns + 2 * MS, make_frame(0x181, 1, 2, 3)))
    bench.scheduler.run_until(4 * MS)
    assert seen == [0x201, 0x181]
    bits = frame_bits(data_frame(0x201, b"\x01\x02")) + frame_bits(data_frame(0x181, b"\1\2\3"))
    figures = segment.load()
    assert (figures.frames, figures.busy_bits) == ((2, bits) if keeps_load else (0, 0))
    assert set(figures.worst_delay_ns) == ({0x201, 0x181} if keeps_load else set())
