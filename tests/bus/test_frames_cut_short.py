"""A sender that goes in the middle of a frame, whatever else is the matter with that frame.

At 1 Mbit/s, one bit is 1000 ns. The line stays recessive: six bits later the others see a stuff
error, flag 6 bits and delimiter 8.
"""

from collections.abc import Callable

import pytest

from axisrig.bench.bus.can.faults import Alter, Drop, Duplicate, ErrorAtBit, FaultAction
from axisrig.bench.bus.can.frame import data_frame, frame_bits
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import Scheduler

Watch = Callable[[Segment], list[tuple[int, int, str]]]
FRAME = data_frame(0x123, b"\x01\x02")
WHOLE_NS = (frame_bits(FRAME) - 3) * 1000
ACTIONS: dict[str, FaultAction | None] = {
    "none": None,
    "dropped for one": Drop(frozenset({"x"})),
    "altered": Alter(b"\x03\x04"),
    "duplicated": Duplicate(),
}


def going(
    scheduler: Scheduler, segment: Segment, action: FaultAction | None, at_ns: int, by: str
) -> dict[str, list[bytes]]:
    """Let the sender go `at_ns` after the begin of its first frame; return what others get."""
    ports = {name: segment.port(name) for name in ("sender", "x", "y")}
    got: dict[str, list[bytes]] = {name: [] for name in ("x", "y")}
    for name, heard in got.items():
        ports[name].attach_data(lambda _id, data, _time, heard=heard: heard.append(data))
    segment.add_fault(lambda frame, port, attempt: None if attempt else action)
    ports["sender"].send_raw(FRAME.arbitration_id, FRAME.data)
    leave = ports["sender"].power_off if by == "power" else ports["sender"].force_bus_off
    scheduler.call_at(at_ns, Phase.APPLICATION, leave)
    scheduler.run_until(MS)
    return got


@pytest.mark.parametrize("by", ["power", "bus-off"])
@pytest.mark.parametrize("kind", ACTIONS)
def test_a_frame_ends_with_its_sender(
    scheduler: Scheduler, segment: Segment, watch: Watch, kind: str, by: str
) -> None:
    """In its bit 20: 20 + 6 + 6 + 8; nobody gets it, and nobody repeats it."""
    frames = watch(segment)
    got = going(scheduler, segment, ACTIONS[kind], 19_500, by)
    assert frames == [(40_000, 0x123, "error")]
    assert got == {"x": [], "y": []}
    figures = segment.load()
    assert (figures.frames, figures.error_frames, figures.busy_bits) == (0, 1, 43)


@pytest.mark.parametrize("bit", [1, 2, 30, WHOLE_NS // 1000 - 10])
def test_up_to_the_last_bit_of_its_check_sum_a_frame_ends_with_its_sender(
    scheduler: Scheduler, segment: Segment, watch: Watch, bit: int
) -> None:
    """In the middle of that bit, which still counts: 6 + 6 + 8 bits more."""
    frames = watch(segment)
    got = going(scheduler, segment, None, bit * 1000 - 500, "power")
    assert frames == [((bit + 20) * 1000, 0x123, "error")]
    assert got == {"x": [], "y": []}
    assert segment.load().busy_bits == bit + 23


@pytest.mark.parametrize("kind", ACTIONS)
def test_a_frame_whose_check_sum_is_out_gets_through(
    scheduler: Scheduler, segment: Segment, watch: Watch, kind: str
) -> None:
    """Delimiters, acknowledgement and end of frame are recessive, or of others: 10 bits."""
    frames = watch(segment)
    got = going(scheduler, segment, ACTIONS[kind], WHOLE_NS - 9_500, "power")
    action = ACTIONS[kind]
    data = action.data if isinstance(action, Alter) else FRAME.data
    assert [each[1:] for each in frames] == [(0x123, "data")]
    assert got == {"x": [] if isinstance(action, Drop) else [data], "y": [data]}


@pytest.mark.parametrize("after_bits", [1, 5, 13])
def test_a_frame_that_is_destroyed_already_ends_as_it_would(
    scheduler: Scheduler, segment: Segment, watch: Watch, after_bits: int
) -> None:
    """Destroyed after bit 20: flag 6 and delimiter 8, also where the sender goes meanwhile."""
    frames = watch(segment)
    going(scheduler, segment, ErrorAtBit(20), (20 + after_bits) * 1000 - 500, "power")
    assert frames == [(34_000, 0x123, "error")]
    assert segment.load().busy_bits == 20 + 6 + 8 + 3


def test_who_sends_nothing_cuts_nothing(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """Another port goes in the middle of the frame."""
    frames = watch(segment)
    sender, other, _ = (segment.port(name) for name in ("sender", "other", "receiver"))
    sender.send_raw(FRAME.arbitration_id, FRAME.data)
    scheduler.call_at(19_500, Phase.APPLICATION, other.power_off)
    scheduler.run_until(MS)
    assert frames == [(WHOLE_NS, 0x123, "data")]


def test_what_still_waits_counts_of_every_port_with_its_own_request(
    scheduler: Scheduler, segment: Segment
) -> None:
    """Asked at 30, 40 and 50 us; the first one goes out at once, the others wait until 60 us."""
    ports = [segment.port(name) for name in "abc"]
    for number, port in enumerate(ports):
        send = lambda port=port, number=number: port.send_raw(0x100 + number, b"12345678")  # noqa: E731
        scheduler.call_at((30 + 10 * number) * 1000, Phase.APPLICATION, send)
    scheduler.call_at(55_000, Phase.APPLICATION, lambda: ports[2].send_raw(0x050, b""))
    scheduler.run_until(60_000)
    figures = segment.load()
    assert figures.worst_delay_ns == {0x050: 5_000, 0x101: 20_000, 0x102: 10_000}
    scheduler.run_until(MS)
    assert set(segment.load().worst_delay_ns) == {0x050, 0x100, 0x101, 0x102}
