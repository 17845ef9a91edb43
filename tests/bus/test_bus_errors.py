"""Error counters, passive controllers and bus-off, at 1 Mbit/s: one bit is 1000 ns.

The expected counts are those of the fault confinement rules of ISO 11898-1, written out here.
"""

from collections.abc import Callable

import can
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.bus.conftest import fails

from axisrig.bench.bus.can.confinement import ErrorCounters, ErrorState
from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.frame import data_frame, wire_bits
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import Scheduler

Watch = Callable[[Segment], list[tuple[int, int, str]]]
SYNC_BITS = 48
PASSIVE, OFF = ErrorState.PASSIVE, ErrorState.BUS_OFF


# event -> (change of TEC, change of REC); the rules of ISO 11898-1 for what can occur here
RULES = {"transmit_failed": (8, 0), "receive_failed": (0, 1), "transmitted": (-1, 0)}


@given(st.lists(st.sampled_from([*RULES, "primary", "received", "unacknowledged"]), max_size=600))
@pytest.mark.long
def test_counters_follow_the_rules_of_the_standard(events: list[str]) -> None:
    counters, tec, rec, is_off = ErrorCounters(), 0, 0, False
    for event in events:
        if event == "primary":
            counters.receive_failed(is_primary=True)
            rec += 9
        elif event == "received":
            counters.received()
            rec = rec - 1 if 1 <= rec <= 127 else rec
            if rec > 127:
                rec = counters.rec
                assert 119 <= rec <= 127
        elif event == "unacknowledged":
            if not (tec >= 128 or rec >= 128) or is_off:
                tec += 8
            counters.transmit_failed(is_unacknowledged=True)
        else:
            getattr(counters, event)()
            tec, rec = max(tec + RULES[event][0], 0), rec + RULES[event][1]
        is_off = is_off or tec > 255
        assert (counters.tec, counters.rec) == (tec, rec)
        expected = "bus-off" if is_off else "error passive" if max(tec, rec) > 127 else None
        assert counters.state == (expected or "error active")


def test_an_error_that_all_see_costs_sender_8_and_receivers_1(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    seen = watch(segment)
    sender, one, two = (segment.port(name) for name in ("sender", "one", "two"))
    segment.add_fault(fails(1))
    sender.send_raw(0x080, b"")
    scheduler.run_until(35_000)
    assert [(p.tec, p.rec) for p in (sender, one, two)] == [(8, 0), (0, 1), (0, 1)]
    scheduler.run_until(MS)
    assert [(p.tec, p.rec) for p in (sender, one, two)] == [(7, 0), (0, 0), (0, 0)]
    assert [time_ns for time_ns, *_ in seen] == [34_000, 34_000 + 3000 + 48_000]


def test_who_sees_an_error_first_pays_nine_and_the_flags_take_twelve_bits(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """20 bits of the frame, flags of 6 bits one after the other, delimiter 8."""
    seen = watch(segment)
    sender, first, other = (segment.port(name) for name in ("sender", "first", "other"))
    segment.add_fault(fails(1, seen_by=frozenset({"first"})))
    sender.send_raw(0x080, b"")
    scheduler.run_until(50_000)
    assert [(p.tec, p.rec) for p in (sender, first, other)] == [(8, 0), (0, 9), (0, 1)]
    assert seen == [(40_000, 0x080, "error")]


@pytest.mark.parametrize("bit", [48, 999])
def test_an_error_in_the_last_bit_makes_a_duplicate(
    scheduler: Scheduler, segment: Segment, watch: Watch, bit: int
) -> None:
    """SYNC has 48 bits: delivered, then flag 6 and delimiter 8, intermission 3, and once more."""
    seen = watch(segment)
    sender, receiver = segment.port("sender"), segment.port("receiver")
    segment.add_fault(fails(1, bit))
    sender.send_raw(0x080, b"")
    scheduler.run_until(64_000)
    assert (sender.tec, receiver.rec) == (8, 0)
    scheduler.run_until(MS)
    assert seen == [
        (48_000, 0x080, "data"),
        (62_000, 0x080, "error"),
        (65_000 + 48_000, 0x080, "data"),
    ]
    assert [receiver.recv(0) is not None for _ in range(3)] == [True, True, False]
    assert segment.load().busy_bits == 48 + 14 + 3 + 51


@pytest.mark.parametrize("wait_us", [0, 7])
def test_a_wait_ends_where_a_frame_begins_that_fails_in_its_last_bit(
    scheduler: Scheduler, segment: Segment, wait_us: int
) -> None:
    """0x081 is requested while a SYNC has the bus; 51 us later it begins, and its wait is over.

    It is delivered and fails in its last bit; without power it is not sent again.
    """
    sender, other = segment.port("sender"), segment.port("other")
    segment.port("receiver")
    segment.add_fault(
        lambda frame, port, attempt: ErrorAtBit(999) if frame.arbitration_id == 0x081 else None
    )
    other.send_raw(0x080, b"")
    scheduler.call_at(wait_us * 1000, Phase.APPLICATION, lambda: sender.send_raw(0x081, b""))
    scheduler.run_until((51 + 48 + 5) * 1000)
    sender.power_off()
    scheduler.run_until(MS)
    load = segment.load()
    assert load.worst_delay_ns == {0x080: 0, 0x081: (51 - wait_us) * 1000}
    assert load.frames == 2


def test_the_last_but_one_bit_still_destroys_the_frame(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    seen = watch(segment)
    sender, receiver = segment.port("sender"), segment.port("receiver")
    segment.add_fault(fails(1, 47))
    sender.send_raw(0x080, b"")
    scheduler.run_until(MS)
    assert [kind for *_, kind in seen] == ["error", "data"]
    assert [receiver.recv(0) is not None for _ in range(2)] == [True, False]


def test_sender_becomes_passive_after_16_errors_and_bus_off_after_32(
    scheduler: Scheduler, segment: Segment
) -> None:
    """TEC 128 after 16 attempts, 256 after 32; receivers have one count for each."""
    sender, receiver = segment.port("sender"), segment.port("receiver")
    found: list[tuple[int, ErrorState]] = []
    offs: list[int] = []
    sender.on_error_state(lambda state: found.append((sender.tec, state)))
    sender.on_bus_off(lambda: offs.append(segment.load().error_frames))
    segment.add_fault(fails(99))
    sender.send_raw(0x080, b"")
    sender.send_raw(0x081, b"")
    scheduler.run_until(2 * MS)
    assert found == [(128, PASSIVE), (256, OFF)]
    assert offs == [32]
    assert (sender.state, receiver.state) == (can.BusState.ERROR, can.BusState.ACTIVE)
    assert receiver.rec == 32
    assert sender.discarded == 2
    sender.send_raw(0x080, b"")
    assert sender.discarded == 3
    states = [(name, state) for _, name, state in segment.state_changes]
    assert states == [("sender", PASSIVE), ("sender", OFF)]


def test_passive_sender_waits_eight_bits_longer_after_its_own_frame(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """16 errors of 20 + 14 + 3 bits, then 8 bits more before the frame that gets through."""
    seen = watch(segment)
    sender = segment.port("sender")
    segment.port("receiver")
    segment.add_fault(fails(16))
    sender.send_raw(0x080, b"")
    scheduler.run_until(MS)
    assert [kind for *_, kind in seen] == ["error"] * 16 + ["data"]
    assert seen[15][0] == 16 * 37_000 - 3_000
    assert seen[16][0] == 16 * 37_000 + 8_000 + SYNC_BITS * 1000
    assert (sender.tec, sender.error_state) == (127, ErrorState.ACTIVE)


def test_during_the_suspension_another_sender_goes_first(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """It asks 4 bits after the intermission, with a higher identifier."""
    seen = watch(segment)
    sender, other = segment.port("sender"), segment.port("other")
    segment.add_fault(fails(16))
    sender.send_raw(0x080, b"")
    at_ns = 16 * 37_000 + 4_000
    scheduler.call_at(at_ns, Phase.APPLICATION, lambda: other.send_raw(0x700, b""))
    scheduler.run_until(2 * MS)
    assert seen[16][1] == 0x700


def test_alone_on_the_bus_a_sender_stays_passive_and_never_goes_off(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """ACK slot is bit 40 of the 48; 6 + 8 bits of error frame, 3 of intermission, 8 suspended."""
    seen = watch(segment)
    sender = segment.port("sender")
    sender.send_raw(0x080, b"")
    scheduler.run_until(20 * MS)
    assert (sender.tec, sender.rec, sender.error_state) == (128, 0, PASSIVE)
    assert {kind for *_, kind in seen} == {"error"}
    times = [time_ns for time_ns, *_ in seen]
    assert times[:3] == [54_000, 54_000 + 57_000, 54_000 + 2 * 57_000]
    assert times[30] - times[29] == 57_000 + 8_000
    receiver = segment.port("late")
    scheduler.run_until(21 * MS)
    assert receiver.recv(0) is not None
    assert (sender.tec, sender.error_state) == (127, ErrorState.ACTIVE)


def test_an_error_that_a_passive_receiver_alone_sees_costs_it_the_frame(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """Its flag is recessive. REC is 15 * 9 = 135, 127 after a frame, 136 and passive, then 137."""
    seen = watch(segment)
    sender, weak, other = (segment.port(name) for name in ("sender", "weak", "other"))
    weak_sees = frozenset({"weak"})
    segment.add_fault(
        lambda frame, port, attempt: (
            ErrorAtBit(20, weak_sees) if attempt < 15 or frame.arbitration_id == 0x081 else None
        )
    )
    sender.send_raw(0x080, b"")
    scheduler.run_until(MS)
    assert weak.recv(0) is not None
    assert (weak.rec, weak.error_state) == (127, ErrorState.ACTIVE)
    sender.send_raw(0x081, b"")
    scheduler.run_until(MS + 50_000)
    assert (weak.rec, weak.error_state) == (136, PASSIVE)
    scheduler.run_until(2 * MS)
    assert (weak.rec, weak.recv(0)) == (137, None)
    assert [other.recv(0) is not None for _ in range(3)] == [True, True, False]
    assert [entry[1:] for entry in seen[16:]] == [(0x081, "error"), (0x081, "data")]


def test_same_frame_from_two_ports_at_once_appears_once(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    seen = watch(segment)
    one, two, receiver = (segment.port(name) for name in ("one", "two", "receiver"))
    for port in (one, two):
        port.send_raw(0x200, b"\x05")
    scheduler.run_until(MS)
    assert [entry[1:] for entry in seen] == [(0x200, "data")]
    assert receiver.recv(0) is not None
    assert (one.recv(0), two.recv(0), len(one.pending), len(two.pending)) == (None, None, 0, 0)


def test_same_identifier_with_other_data_collides_until_the_recessive_one_is_passive(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """0x200, DLC 1, data 00 against 01: the last data bit differs.

    15 collisions make TEC 120 in both; after the 16th both are passive. The one that sends
    recessive then fails in silence, the other gets through, and at last the first one too.
    """
    seen = watch(segment)
    low, high, receiver = (segment.port(name) for name in ("low", "high", "receiver"))
    high.send_raw(0x200, b"\x01")
    low.send_raw(0x200, b"\x00")
    texts = [wire_bits(data_frame(0x200, data)) for data in (b"\x00", b"\x01")]
    place = next(i for i, (a, b) in enumerate(zip(*texts, strict=False), 1) if a != b)
    scheduler.run_until(10 * MS)
    assert seen[0] == (1000 * (place + 12 + 8), 0x200, "error")
    assert [kind for *_, kind in seen] == ["error"] * 16 + ["data"] * 2
    got = [receiver.recv(0), receiver.recv(0)]
    assert [bytes(msg.data) for msg in got if msg is not None] == [b"\x00", b"\x01"]
    assert high.recv(0) is None  # in its own error flag while the other's frame went out
    assert low.recv(0) is not None
    assert (low.tec, high.tec) == (127, 16 * 8 + 8 - 1)
    assert receiver.rec == 16 - 2


def test_node_that_loses_power_while_sending_leaves_a_stuff_error(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """Cut in bit 20: 20 bits, 6 recessive ones, flag 6, delimiter 8; nobody tries again."""
    seen = watch(segment)
    sender, other, receiver = (segment.port(name) for name in ("sender", "other", "receiver"))
    sender.send_raw(0x123, b"\x01\x02")
    scheduler.call_at(19_500, Phase.APPLICATION, sender.power_off)
    scheduler.run_until(MS)
    assert seen == [(40_000, 0x123, "error")]
    assert (other.rec, receiver.rec, sender.takes_part) == (1, 1, False)
    other.send_raw(0x080, b"")
    scheduler.run_until(2 * MS)
    sender.power_on()
    assert sender.recv(0) is None
    other.send_raw(0x081, b"")
    scheduler.run_until(3 * MS)
    assert sender.recv(0) is not None


def test_a_node_that_gets_power_again_has_seen_no_errors(
    scheduler: Scheduler, segment: Segment
) -> None:
    """Error passive, bus-off or merely disturbed: both counts 0, error active, and it sends."""
    sender, receiver = segment.port("sender"), segment.port("receiver")
    for failures in (1, 20, 40):
        for _ in range(failures):
            sender.errors.transmit_failed()
            sender.errors.receive_failed()
        sender.update_state()
        assert sender.tec > 0
        sender.power_off()
        sender.send_raw(0x123, b"")
        sender.power_on()
        assert (sender.tec, sender.rec, sender.error_state) == (0, 0, ErrorState.ACTIVE)
        assert sender.takes_part
        sender.send_raw(0x124, b"")
        scheduler.run_until(scheduler.now_ns + MS)
        got = [receiver.recv(0), receiver.recv(0)]
        assert [message and message.arbitration_id for message in got] == [0x124, None]


def test_power_lost_behind_the_check_sum_spoils_nothing(
    scheduler: Scheduler, segment: Segment
) -> None:
    sender, receiver = segment.port("sender"), segment.port("receiver")
    sender.send_raw(0x080, b"")
    scheduler.call_at(40_000, Phase.APPLICATION, sender.power_off)
    scheduler.run_until(MS)
    assert receiver.recv(0) is not None
    assert segment.load().error_frames == 0


def test_a_passive_sender_notices_an_error_of_its_own(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """Its recessive flag breaks the stuffing of its own frame: all others see that."""
    seen = watch(segment)
    sender, receiver = segment.port("sender"), segment.port("receiver")
    alone = frozenset({"sender"})
    segment.add_fault(
        lambda frame, port, attempt: (
            ErrorAtBit(20) if attempt < 16 else ErrorAtBit(20, alone) if attempt == 16 else None
        )
    )
    sender.send_raw(0x080, b"")
    scheduler.run_until(2 * MS)
    assert [kind for *_, kind in seen] == ["error"] * 17 + ["data"]
    assert sender.tec == 17 * 8 - 1
    assert [receiver.recv(0) is not None for _ in range(2)] == [True, False]
