"""Frames that are held back, destroyed late or asked for out of turn, to the bit."""

from collections.abc import Callable

import pytest
from tests.bus.conftest import fails

from axisrig.bench.bus.can.arithmetic import PlannedFrame, cycle_arithmetic
from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.controller import Controller
from axisrig.bench.bus.can.faults import Swap
from axisrig.bench.bus.can.frame import Frame, data_frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS, US, Phase
from axisrig.kernel.time.scheduler import Scheduler

Watch = Callable[[Segment], list[tuple[int, int, str]]]
Bits = Callable[[Frame], int]

FIRST, SECOND, THIRD = (data_frame(can_id, b"\x11\x22") for can_id in (0x100, 0x200, 0x300))


def test_of_frames_that_are_all_to_change_places_the_second_goes_at_once(
    segment: Segment, watch: Watch, naive_bits: Bits
) -> None:
    """One of a port waits for the next of it; the next one does not wait for a third."""
    frames, sender = watch(segment), segment.port("sender")
    segment.port("receiver")
    segment.add_fault(lambda _frame, _port, attempt: None if attempt else Swap())
    for frame in (FIRST, SECOND, THIRD):
        sender.send_raw(frame.arbitration_id, frame.data)
    segment.scheduler.run_until(MS)
    first, second, third = (naive_bits(frame) for frame in (FIRST, SECOND, THIRD))
    assert sorted(can_id for _, can_id, _ in frames) == [0x100, 0x200, 0x300]
    ends = {can_id: end_ns for end_ns, can_id, _ in frames}
    assert ends[frames[0][1]] == ({0x200: second, 0x300: third}[frames[0][1]] - 3) * US
    assert max(ends.values()) == (first + second + third - 3) * US  # nobody leaves a gap


def test_a_frame_that_changes_places_is_behind_the_next_of_its_port(
    segment: Segment, watch: Watch, naive_bits: Bits
) -> None:
    frames, sender, other = watch(segment), segment.port("sender"), segment.port("other")

    def hook(frame: Frame, _port: Controller, attempt: int) -> Swap | None:
        return Swap() if frame.arbitration_id == 0x100 and not attempt else None

    segment.add_fault(hook)
    sender.send_raw(0x100, b"\x11\x22")
    other.send_raw(0x300, b"\x11\x22")
    segment.scheduler.run_until(MS)
    assert frames == [((naive_bits(THIRD) - 3) * US, 0x300, "data")]  # that of another port is none
    sender.send_raw(0x200, b"\x11\x22")
    segment.scheduler.run_until(2 * MS)
    second, first = naive_bits(SECOND), naive_bits(FIRST)
    assert frames[1:] == [
        (MS + (second - 3) * US, 0x200, "data"), (MS + (second + first - 3) * US, 0x100, "data"),
    ]  # fmt: skip


def test_a_sender_that_loses_its_power_in_a_late_error_frame_repeats_nothing(
    segment: Segment, watch: Watch, naive_bits: Bits
) -> None:
    """The receivers have the frame; the flag of 6 bits and 8 bits of delimiter pass as ever."""
    frames = watch(segment)
    sender, receiver = segment.port("sender"), segment.port("receiver")
    received: list[int] = []
    receiver.attach_data(lambda can_id, _data, _time: received.append(can_id))
    segment.add_fault(fails(1, bit=999))
    sender.send_raw(0x100, b"\x11\x22")
    whole = naive_bits(FIRST) - 3
    segment.scheduler.call_at((whole + 2) * US, Phase.APPLICATION, sender.power_off)
    segment.scheduler.run_until(MS)
    assert frames == [(whole * US, 0x100, "data"), ((whole + 6 + 8) * US, 0x100, "error")]
    assert (received, receiver.rec) == ([0x100], 0)
    assert (sender.takes_part, sender.discarded, len(sender.pending)) == (False, 1, 0)
    sender.send_raw(0x200, b"")
    segment.scheduler.run_until(2 * MS)
    assert (received, sender.discarded) == ([0x100], 2)
    sender.power_on()
    assert (sender.takes_part, sender.tec) == (True, 0)
    sender.send_raw(0x300, b"")
    segment.scheduler.run_until(3 * MS)
    assert received == [0x100, 0x300, 0x300]  # late as well, and with power it is repeated


@pytest.mark.parametrize(
    ("bit", "seen_by", "flag_bits", "counts"),
    [
        (20, {"b"}, 12, (8, 9, 1)),  # b saw it first: a dominant bit is behind its flag
        (20, {"b", "c"}, 12, (8, 9, 9)),
        (20, {"a", "b", "c"}, 6, (8, 1, 1)),  # all at the same bit, as without names
        (20, None, 6, (8, 1, 1)),
        (999, None, 6, (8, 0, 0)),  # too late for the receivers, whoever has seen it
        (999, {"a"}, 6, (8, 0, 0)),
        (999, {"a", "b"}, 6, (8, 0, 0)),
    ],
)
def test_a_flag_is_as_long_as_nodes_see_the_error_one_after_the_other(
    segment: Segment,
    watch: Watch,
    naive_bits: Bits,
    bit: int,
    seen_by: set[str] | None,
    flag_bits: int,
    counts: tuple[int, int, int],
) -> None:
    """6 bits where all do at once, 12 superposed ones else; counts of sender and receivers."""
    frames = watch(segment)
    ports = [segment.port(name) for name in ("a", "b", "c")]
    found: list[tuple[int, ...]] = []
    names = None if seen_by is None else frozenset(seen_by)
    segment.add_fault(fails(1, bit=bit, seen_by=names))
    ports[0].send_raw(0x100, b"\x11\x22")
    whole = naive_bits(FIRST) - 3
    end_ns = (min(bit, whole) + flag_bits + 8) * US

    def count() -> None:
        found.append((ports[0].tec, ports[1].rec, ports[2].rec))

    segment.scheduler.call_at(end_ns + 1, Phase.APPLICATION, count)
    segment.scheduler.run_until(MS)
    assert [at for at, _, kind in frames if kind == "error"] == [end_ns]
    assert found == [counts]


def test_who_sends_the_same_bits_does_not_get_its_own_frame_late(
    segment: Segment, naive_bits: Bits
) -> None:
    """Two drives with one number send the same: an error in the last bit repeats it for both."""
    received: dict[str, list[tuple[int, int]]] = {name: [] for name in "abc"}
    ports = {name: segment.port(name) for name in "abc"}
    for name, port in ports.items():
        port.attach_data(
            lambda can_id, _data, _time, name=name: received[name].append((can_id, segment.now_ns))
        )
    segment.add_fault(fails(1, bit=999))
    for name in "ab":
        ports[name].send_raw(0x100, b"\x11\x22")
    segment.scheduler.run_until(MS)
    whole = naive_bits(FIRST) - 3
    again = whole + 6 + 8 + 3 + whole
    assert received == {"a": [], "b": [], "c": [(0x100, whole * US), (0x100, again * US)]}
    assert [ports[name].tec for name in "ab"] == [7, 7]  # 8 for the error, one less after it


@pytest.mark.parametrize("starts_us", [(1000,), (300, 600), (300, 600, 900), (100, 101, 700)])
def test_a_recovery_counts_frames_and_the_rest_between_them(
    segment: Segment, naive_bits: Bits, starts_us: tuple[int, ...]
) -> None:
    """Each frame is one of the 128, a rest as many as it has 11 bits; nobody else has a count."""
    off, other = segment.port("off"), segment.port("other")
    segment.port("third")
    off.force_bus_off()
    bits, missing, free_us = naive_bits(FIRST), 128, 0
    for start_us in starts_us:
        segment.scheduler.call_at(
            start_us * US, Phase.APPLICATION, lambda: other.send_raw(0x100, b"\x11\x22")
        )
        begin_us = max(start_us, free_us)
        missing -= (begin_us - free_us) // 11 + 1
        free_us = begin_us + bits
    segment.scheduler.run_until(5 * MS)
    assert segment.state_changes[1:] == [
        ((free_us + 11 * missing) * US, "off", ErrorState.ACTIVE)
    ]  # fmt: skip


@pytest.mark.parametrize("attaches", ["attach", "attach_data"])
def test_frames_of_a_port_with_a_callback_are_not_for_recv(segment: Segment, attaches: str) -> None:
    port = segment.port("drive")
    assert port.recv(0) is None
    getattr(port, attaches)(lambda *_: None)
    with pytest.raises(RuntimeError, match="frames go to the attached callbacks"):
        port.recv(0)


def test_a_port_that_is_shut_down_waits_for_nothing(segment: Segment) -> None:
    port, other = segment.port("drive"), segment.port("other")
    for number in range(3):
        port.send_raw(0x100 + number, b"")
    assert len(port.pending) == 3
    port.shutdown()
    assert (len(port.pending), other.recv(0.01)) == (0, None)


@pytest.mark.parametrize(
    ("bitrate", "end_ns"),
    [(1_000_000, 1_408_000), (800_000, 1_760_000), (300_000, 4_693_334), (83_333, 16_896_068)],
)
def test_a_recovery_ends_with_its_last_bit_whatever_the_bit_rate(
    scheduler: Scheduler, bitrate: int, end_ns: int
) -> None:
    """128 times 11 bits from 0 on, rounded up: 1408 bits at 300 kbit/s are 4 693 333.3 ns."""
    assert (end_ns - 1) * bitrate < 1408 * 10**9 <= end_ns * bitrate
    with Segment("odd", bitrate, scheduler) as segment:
        port, _ = segment.port("off"), segment.port("other")
        port.force_bus_off()
        scheduler.run_until(20 * MS)
        assert segment.state_changes == [
            (0, "off", ErrorState.BUS_OFF), (end_ns, "off", ErrorState.ACTIVE)
        ]  # fmt: skip


# The worst case of a cycle

TPDO1, TPDO2 = PlannedFrame("TPDO1", 0x181, 8), PlannedFrame("TPDO2", 0x281, 4)


def test_a_sync_of_low_priority_waits_for_every_event_before_it() -> None:
    """Of 0x7FF: 65 and 55 bits go first, where SYNC of 0x80 waits for the longer one alone."""
    events = [PlannedFrame("heartbeat", 0x701, 1), PlannedFrame("guard", 0x702, 0)]
    late = PlannedFrame("SYNC", 0x7FF, 0)
    for sync, waits in ((late, 65 + 55), (PlannedFrame("SYNC", 0x80, 0), 65)):
        found = cycle_arithmetic(
            1_000_000, MS, 600 * US, [TPDO1, TPDO2], [], events, sync
        )  # fmt: skip
        assert found.last_tpdo_ns == (waits + 55 + 135 + 95 - 3) * US


def test_a_late_tpdo_waits_for_no_rpdo_that_loses_against_it() -> None:
    """At 100 us TPDO2 (0x281) still waits: 0x201 overtakes it, and 0x301 does not."""
    rpdos = [PlannedFrame("RPDO1", 0x201, 8), PlannedFrame("RPDO2", 0x301, 8)]
    for given, before in ((rpdos, 135), (rpdos[1:], 0), (rpdos[:1], 135), ([], 0)):
        found = cycle_arithmetic(1_000_000, MS, 100 * US, [TPDO1, TPDO2], given)
        assert found.last_tpdo_ns == (55 + 135 + 95 + before - 3) * US
