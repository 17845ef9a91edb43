"""Order, times, faults and load of a segment at 1 Mbit/s: one bit is 1000 ns."""

import random
from collections.abc import Callable
from itertools import pairwise

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.bus.can import registry
from axisrig.bench.bus.can.frame import Frame, data_frame
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import Scheduler, new_scheduler

Bits = Callable[[Frame], int]
Watch = Callable[[Segment], list[tuple[int, int, str]]]


def test_sync_is_delivered_48_bits_after_its_request(
    scheduler: Scheduler, segment: Segment
) -> None:
    """51 bits (test_frame), 3 of them intermission."""
    sender, receiver = segment.port("sender"), segment.port("receiver")
    seen: list[tuple[int, can.Message]] = []
    receiver.attach(lambda msg: seen.append((segment.now_ns, msg)))
    scheduler.run_until(12_345)
    sender.send_raw(0x080, b"")
    scheduler.run_until(MS)
    (time_ns, msg), *more = seen
    assert not more
    assert time_ns == 12_345 + 48_000
    assert (msg.timestamp, msg.arbitration_id, msg.dlc) == (60_345e-9, 0x080, 0)


def test_frames_follow_each_other_after_three_bits(
    scheduler: Scheduler, segment: Segment, watch: Watch, naive_bits: Bits
) -> None:
    seen = watch(segment)
    port = segment.port("only")
    segment.port("listener")
    numbers = random.Random(2)
    sent = [data_frame(numbers.randrange(0x800), numbers.randbytes(8)) for _ in range(200)]
    expected, start_ns = [], 0
    for frame in sent:
        port.send_raw(frame.arbitration_id, frame.data)
        end_ns = start_ns + 1000 * naive_bits(frame)
        expected.append((end_ns - 3000, frame.arbitration_id, "data"))
        start_ns = end_ns
    scheduler.run_until(100 * MS)
    assert seen == expected


@pytest.mark.parametrize(
    ("request_ns", "start_ns"), [(48_000, 51_000), (50_999, 51_000), (51_001, 51_001)]
)
def test_request_around_the_intermission(
    scheduler: Scheduler, segment: Segment, watch: Watch, request_ns: int, start_ns: int
) -> None:
    """SYNC ends at 48 us, the bus is free at 51 us."""
    seen = watch(segment)
    port = segment.port("only")
    segment.port("listener")
    port.send_raw(0x080, b"")
    scheduler.call_at(request_ns, Phase.APPLICATION, lambda: port.send_raw(0x080, b""))
    scheduler.run_until(MS)
    assert [time_ns for time_ns, *_ in seen] == [48_000, start_ns + 48_000]


def test_frame_time_is_rounded_when_a_bit_is_no_whole_ns(
    scheduler: Scheduler, watch: Watch
) -> None:
    """48 bits at 3 Mbit/s are 16000 ns; 51 bits are 17000 ns; at 7 Mbit/s 6857.14 and 7285.71."""
    for bitrate, ends in ((3_000_000, [16_000, 33_000]), (7_000_000, [6857, 7286 + 6857])):
        with Segment("odd", bitrate, new_scheduler()) as segment:
            seen = watch(segment)
            port = segment.port("only")
            segment.port("listener")
            port.send_raw(0x080, b"")
            port.send_raw(0x080, b"")
            segment.scheduler.run_until(MS)
            assert [time_ns for time_ns, *_ in seen] == ends


def test_requests_of_one_instant_compete_by_identifier_not_by_call_order(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    seen = watch(segment)
    ports = [segment.port(f"drive {n}") for n in range(4)]

    def request() -> None:
        for port, can_id in zip(ports, (0x281, 0x182, 0x080, 0x181), strict=True):
            port.send_raw(can_id, b"\x55")

    scheduler.call_at(MS, Phase.APPLICATION, request)
    scheduler.run_until(2 * MS)
    assert [can_id for _, can_id, _ in seen] == [0x080, 0x181, 0x182, 0x281]


def test_standard_data_beats_remote_beats_extended_of_the_same_base(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    seen = watch(segment)
    base = 0x123
    extended_id = base << 18
    for remote, extended in ((True, True), (False, True), (True, False), (False, False)):
        port = segment.port(f"{remote} {extended}")
        can_id = extended_id if extended else base
        port.send(
            can.Message(arbitration_id=can_id, is_extended_id=extended, is_remote_frame=remote)
        )
    segment.port("higher base").send(can.Message(arbitration_id=base + 1, is_extended_id=False))
    scheduler.run_until(MS)
    assert [(can_id, kind) for _, can_id, kind in seen] == [
        (base, "data"),
        (base, "remote"),
        (extended_id, "data"),
        (extended_id, "remote"),
        (base + 1, "data"),
    ]


@pytest.mark.parametrize(
    ("queue", "order"), [("fifo", [0x200, 0x300, 0x100]), ("mailbox", [0x100, 0x200, 0x300])]
)
def test_fifo_inverts_priorities_where_mailboxes_do_not(
    scheduler: Scheduler, segment: Segment, watch: Watch, queue: str, order: list[int]
) -> None:
    seen = watch(segment)
    both, other = SimBus(segment, queue=queue), segment.port("other")  # type: ignore[arg-type]
    both.send_raw(0x300, b"")
    both.send_raw(0x100, b"")
    other.send_raw(0x200, b"")
    scheduler.run_until(MS)
    assert [can_id for _, can_id, _ in seen] == order


def test_mailbox_keeps_the_order_of_equal_identifiers(
    scheduler: Scheduler, segment: Segment
) -> None:
    sender, receiver = segment.port("sender", "mailbox"), segment.port("receiver")
    for value in (3, 1, 2):
        sender.send_raw(0x200, bytes([value]))
    scheduler.run_until(MS)
    received = [receiver.recv(0) for _ in range(3)]
    assert [msg.data[0] for msg in received if msg is not None] == [3, 1, 2]


@given(
    st.lists(
        st.tuples(
            st.integers(0, 2), st.integers(0, 900), st.integers(0, 0x7F0), st.binary(max_size=8)
        ),
        max_size=30,
    )
)
@pytest.mark.long
def test_bus_never_overlaps_and_loses_nothing(
    naive_bits: Bits, requests: list[tuple[int, int, int, bytes]]
) -> None:
    """Every request appears once per receiver; ends are a frame apart at least.

    No identifier has two senders: those could collide (test_bus_errors).
    """
    requests = [(port, at, can_id // 3 * 3 + port, data) for port, at, can_id, data in requests]
    scheduler = new_scheduler()
    with Segment("random", 1_000_000, scheduler) as segment:
        ports = [segment.port("fifo"), segment.port("mailbox", "mailbox"), segment.port("third")]
        got: list[list[Frame]] = [[] for _ in ports]
        ends: list[int] = []
        segment.observe(lambda time_ns, *_: ends.append(time_ns))
        for port, heard in zip(ports, got, strict=True):
            port.attach_data(
                lambda can_id, data, _, heard=heard: heard.append(data_frame(can_id, data))
            )
        for port_index, time_us, can_id, data in requests:
            scheduler.call_at(
                time_us * 1000,
                Phase.APPLICATION,
                lambda port=ports[port_index], can_id=can_id, data=data: port.send_raw(
                    can_id, data
                ),
            )
        scheduler.run_until(20 * MS)
        for index, heard in enumerate(got):
            foreign = [data_frame(i, d) for port_index, _, i, d in requests if port_index != index]
            assert sorted(heard) == sorted(foreign)
        total_ns = sum(1000 * naive_bits(data_frame(i, d)) for _, _, i, d in requests)
        assert segment.load().busy_bits * 1000 == total_ns
        assert all(later - earlier >= 44_000 for earlier, later in pairwise(ends))


def test_sender_hears_itself_only_when_it_asks_to(scheduler: Scheduler, segment: Segment) -> None:
    deaf, hearing = segment.port("deaf"), segment.port("hearing", receive_own_messages=True)
    own: list[can.Message] = []
    hearing.attach(own.append)
    hearing.attach_data(lambda *_: pytest.fail("data callbacks are for frames of others"))
    hearing.send_raw(0x080, b"")
    scheduler.run_until(MS)
    assert [(msg.arbitration_id, msg.is_rx, msg.timestamp) for msg in own] == [
        (0x080, False, 48e-6)
    ]
    received = deaf.recv(0)
    assert received is not None
    assert received.is_rx
    assert deaf.recv(0) is None


def test_every_receiver_gets_its_own_copy(scheduler: Scheduler, segment: Segment) -> None:
    sender, one, two = (segment.port(name) for name in ("sender", "one", "two"))
    seen: list[can.Message] = []

    def spoil(msg: can.Message) -> None:
        seen.append(msg)
        msg.data[0] = 0xEE

    data = bytearray(b"\x01")
    one.attach(spoil)
    sender.send(can.Message(arbitration_id=1, is_extended_id=False, data=data))
    data[0] = 0xDD  # the caller's buffer is free after the request
    scheduler.run_until(MS)
    untouched = two.recv(0)
    assert untouched is not None
    assert untouched.data == b"\x01"
    assert untouched.data is not seen[0].data


def test_load_by_hand(scheduler: Scheduler, segment: Segment) -> None:
    """Ten SYNCs of 51 bits, the last from 0.98 to 1.031 ms: 20 bits before the border, 31 after."""
    sender, other = segment.port("sender"), segment.port("other")
    for k in range(9):
        scheduler.call_at(k * 60_000, Phase.APPLICATION, lambda: sender.send_raw(0x080, b""))
    scheduler.call_at(980_000, Phase.APPLICATION, lambda: sender.send_raw(0x080, b""))
    scheduler.call_at(1_000_000, Phase.APPLICATION, lambda: other.send_raw(0x081, b""))
    scheduler.run_until(4 * MS)
    load = segment.load()
    other_bits = load.busy_bits - 510
    assert 47 <= other_bits <= 55
    assert segment.busy_bits(MS) == [9 * 51 + 20, 31 + other_bits]
    assert segment.busy_bits(100 * MS) == [510 + other_bits]
    assert (load.worst_1ms_bits, load.worst_100ms_bits) == (479, 510 + other_bits)
    assert load.busy_share == (510 + other_bits) / 4000
    assert load.worst_delay_ns == {0x080: 0, 0x081: 31_000}
    with pytest.raises(ValueError, match="multiple"):
        segment.busy_bits(MS + 1)


def test_frame_that_ends_on_a_border_does_not_touch_the_next_window(
    scheduler: Scheduler, segment: Segment
) -> None:
    port = segment.port("only")
    segment.port("listener")
    scheduler.call_at(949_000, Phase.APPLICATION, lambda: port.send_raw(0x080, b""))
    scheduler.run_until(2 * MS)
    assert segment.busy_bits(MS) == [51]


def test_queueing_delay_is_the_worst_per_identifier(scheduler: Scheduler, segment: Segment) -> None:
    """Three SYNCs requested at once wait 0, 51 and 102 us; bit 31 marks extended identifiers."""
    port = segment.port("only")
    segment.port("listener")
    for _ in range(3):
        port.send_raw(0x080, b"")
    port.send_raw(0x800, b"")
    scheduler.run_until(MS)
    assert segment.load().worst_delay_ns == {0x080: 102_000, 0x8000_0800: 153_000}


def test_saturated_bus_is_busy_all_the_time(scheduler: Scheduler, segment: Segment) -> None:
    port = segment.port("only")
    segment.port("listener")
    for _ in range(100):
        port.send_raw(0x100, bytes(8))
    scheduler.run_until(5 * MS)
    assert segment.busy_bits(MS)[:4] == [1000] * 4


def test_exception_of_a_receiver_ends_the_run_after_the_frame_is_logged(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    seen = watch(segment)
    sender, receiver = segment.port("sender"), segment.port("receiver")
    receiver.attach(lambda msg: msg.data[1])  # type: ignore[arg-type]
    sender.send_raw(0x080, b"")
    with pytest.raises(IndexError):
        scheduler.run_until(MS)
    assert [can_id for _, can_id, _ in seen] == [0x080]
    assert scheduler.now_ns == 48_000


def test_closed_segment_frees_its_name_and_its_ports(scheduler: Scheduler) -> None:
    with Segment("named", 500_000, scheduler) as segment:
        port = segment.port("only")
        segment.port("listener")
        assert registry.find("named") is segment
        with pytest.raises(ValueError, match="open already"):
            Segment("named", 500_000, scheduler)
    assert registry.find("named") is None
    assert segment.ports == ()
    with pytest.raises(can.CanOperationError):
        port.send_raw(1, b"")
    segment.close()


def test_a_segment_that_is_closed_twice_leaves_a_later_one_of_its_name_open(
    scheduler: Scheduler,
) -> None:
    first, other = Segment("named", 500_000, scheduler), Segment("other", 500_000, scheduler)
    with pytest.raises(ValueError, match="open already"):
        Segment("named", 500_000, scheduler)
    assert registry.find("named") is first
    first.close()
    second = Segment("named", 500_000, scheduler)
    first.close()
    assert registry.find("named") is second
    assert registry.names()[-2:] == ["other", "named"]
    second.close()
    assert (registry.find("named"), registry.find("other")) == (None, other)
    other.close()


def test_bit_rate_is_positive(scheduler: Scheduler) -> None:
    with pytest.raises(ValueError, match="bit rate"):
        Segment("none", 0, scheduler)


@pytest.mark.parametrize(
    ("bitrate", "bit_ns"),
    [(125_000, 8000), (250_000, 4000), (500_000, 2000), (800_000, 1250), (1_000_000, 1000)],
)
def test_bit_rates_of_cia_301(
    scheduler: Scheduler, watch: Watch, bitrate: int, bit_ns: int
) -> None:
    """Two SYNCs of 48 bits, 3 bits apart; the load counts bits, not time."""
    with Segment("rate", bitrate, scheduler) as segment:
        seen = watch(segment)
        sender, _ = segment.port("sender"), segment.port("receiver")
        sender.send_raw(0x080, b"")
        sender.send_raw(0x080, b"")
        scheduler.run_until(2 * MS)
        assert [time_ns for time_ns, *_ in seen] == [48 * bit_ns, (51 + 48) * bit_ns]
        load = segment.load()
        assert load.busy_bits == 2 * 51
        assert load.busy_share == pytest.approx(2 * 51 * bit_ns / (2 * MS))
        assert load.worst_delay_ns == {0x080: 51 * bit_ns}
