"""Worst case of the cycle against sums written by hand and against a searched simulation."""

import random
from dataclasses import replace

import pytest

from axisrig.bench.bus.can.arithmetic import SYNC, PlannedFrame, cycle_arithmetic
from axisrig.bench.bus.can.frame import worst_case_bits
from axisrig.kernel.time.clock import MS, US

RATE = 1_000_000


def tpdos(drives: int) -> list[PlannedFrame]:
    first = [PlannedFrame(f"TPDO1 drive {n}", 0x180 + n, 8) for n in range(1, drives + 1)]
    return first + [PlannedFrame(f"TPDO2 drive {n}", 0x280 + n, 4) for n in range(1, drives + 1)]


def rpdos(drives: int) -> list[PlannedFrame]:
    return [PlannedFrame(f"RPDO1 drive {n}", 0x200 + n, 8) for n in range(1, drives + 1)]


def test_two_drives_take_785_us() -> None:
    """55 + 2 * (135 + 95 + 135); deliveries are 3 bits before the end of the intermission."""
    found = cycle_arithmetic(RATE, MS, 600 * US, tpdos(2), rpdos(2))
    assert found.busy_ns == (55 + 2 * (135 + 95 + 135)) * US == 785 * US
    assert found.last_tpdo_ns == (55 + 2 * (135 + 95) - 3) * US
    assert found.last_rpdo_ns == (600 + 2 * 135 - 3) * US
    assert found.fits


def test_three_drives_do_not_fit() -> None:
    """55 + 3 * 365 = 1150 us. RPDOs (0x201) overtake the waiting TPDO2s (0x281) at the offset."""
    found = cycle_arithmetic(RATE, MS, 600 * US, tpdos(3), rpdos(3))
    assert found.busy_ns == 1150 * US
    assert not found.fits
    assert found.last_tpdo_ns == (55 + 3 * (135 + 95) + 3 * 135 - 3) * US
    assert found.last_rpdo_ns == (600 + 95 + 3 * 135 - 3) * US


def test_event_of_lower_priority_blocks_once_and_the_longest_counts() -> None:
    events = [PlannedFrame("TPDO3", 0x381, 4), PlannedFrame("heartbeat", 0x701, 1)]
    found = cycle_arithmetic(RATE, MS, 600 * US, tpdos(2), rpdos(2), events)
    assert found.last_tpdo_ns == (95 + 515 - 3) * US
    assert not found.tpdos_in_time
    assert found.last_rpdo_ns == (600 + 95 + 270 - 3) * US
    assert found.rpdos_in_time
    assert (found.busy_ns, found.event_ns) == (785 * US, (95 + 65) * US)


def test_an_event_that_blocks_sync_delays_rpdos_that_are_asked_for_soon() -> None:
    """Busy from before SYNC on: heartbeat 65, SYNC 55, TPDO1 135, RPDO1 135; of two one blocks.

    TPDO2 (0x281) loses against the RPDO that waits since 100 us.
    """
    blocking = [PlannedFrame("heartbeat", 0x701, 1), PlannedFrame("guard", 0x702, 0)]
    found = cycle_arithmetic(RATE, MS, 100 * US, tpdos(1), rpdos(1), blocking)
    assert found.last_rpdo_ns == (65 + 55 + 135 + 135 - 3) * US
    assert found.last_tpdo_ns == (65 + 55 + 135 + 95 + 135 - 3) * US


def test_events_of_higher_priority_all_count() -> None:
    """Two EMCYs of 135 bits go before the PDOs; a heartbeat of 65 bits was on the wire."""
    events = [PlannedFrame(f"EMCY {n}", 0x80 + n, 8) for n in (1, 2)]
    events.append(PlannedFrame("heartbeat", 0x701, 1))
    found = cycle_arithmetic(RATE, MS, 640 * US, tpdos(1), rpdos(1), events)
    assert found.last_tpdo_ns == (65 + 55 + 135 + 95 + 2 * 135 - 3) * US
    assert found.last_rpdo_ns == (640 + 65 + 2 * 135 + 135 - 3) * US


def test_nothing_but_sync() -> None:
    found = cycle_arithmetic(500_000, 4 * MS, 2 * MS, [], [])
    assert (found.last_tpdo_ns, found.last_rpdo_ns) == (104 * US, 2 * MS)
    assert found.rpdo_limit_ns == 4 * MS - 6 * US


def test_times_are_rounded_up() -> None:
    """52 bits at 3 Mbit/s are 17333.3 ns."""
    assert cycle_arithmetic(3_000_000, MS, MS // 2, [], []).last_tpdo_ns == 17_334


def test_table_shows_every_frame_and_the_sums() -> None:
    events = [PlannedFrame("heartbeat", 0x701, 1)]
    lines = cycle_arithmetic(RATE, MS, 570 * US, tpdos(2), rpdos(2), events).table().splitlines()
    assert [line.split() for line in lines[1:3]] == [
        ["0", "SYNC", "0x80", "0", "55", "55.0", "55.0"],
        ["SYNC", "TPDO1", "drive", "1", "0x181", "8", "135", "135.0", "190.0"],
    ]
    assert lines[7].split()[-1] == "785.0"
    assert lines[8].split() == ["event", "heartbeat", "0x701", "1", "65", "65.0", "850.0"]
    assert [line.split(":")[-1].strip() for line in lines[9:]] == ["7.0 over", "in time", "in time"]
    assert lines[9].startswith("last TPDO delivered    577.0 of 570.0 us")


@pytest.mark.parametrize("offset", [100, 190, 600])
def test_frames_may_be_given_in_any_order(offset: int) -> None:
    """Their identifiers say which is the last; the table has each request by identifier."""
    events = [PlannedFrame("heartbeat", 0x701, 1), PlannedFrame("EMCY", 0x81, 8)]
    given = tpdos(2), rpdos(2), events
    found = cycle_arithmetic(RATE, MS, offset * US, *given)
    for turned in (
        [each[::-1] for each in given],
        [each[1:] + each[:1] for each in given],
    ):
        assert cycle_arithmetic(RATE, MS, offset * US, *turned) == found
    # The last RPDO is that with the highest identifier: it alone waits for what is before it
    late = PlannedFrame("RPDO2", 0x301, 8)
    between = [PlannedFrame(f"TPDO of {n}", 0x2F0 + n, 8) for n in (1, 2)]
    for rpdos_given in ([*rpdos(1), late], [late, *rpdos(1)]):
        one = cycle_arithmetic(RATE, MS, 600 * US, tpdos(1), rpdos_given, between)
        # Four frames of at most 135 bits, the last without the 3 bits of its intermission
        assert one.last_rpdo_ns == (600 + 4 * 135 - 3) * US
    shown = [(request, frame.can_id) for request, frame in found.frames]
    assert shown == [
        ("0", 0x80),
        *(("SYNC", can_id) for can_id in (0x181, 0x182, 0x281, 0x282)),
        *(("offset", can_id) for can_id in (0x201, 0x202)),
        *(("event", can_id) for can_id in (0x81, 0x701)),
    ]


def test_frames_of_one_request_are_in_the_order_of_arbitration() -> None:
    """0x1000 has the base 0 and goes before SYNC; 0x8040000 has the base 0x201 and yields to it."""
    ids = [0x201, 0x804_0000, 0x81, 0x1000, 0x202]
    frames = [PlannedFrame(f"{can_id:x}", can_id, 1) for can_id in ids]
    found = cycle_arithmetic(RATE, 5 * MS, MS, [], [], frames)
    wanted = [0x80, 0x1000, 0x81, 0x201, 0x804_0000, 0x202]
    assert [frame.can_id for _, frame in found.frames] == wanted
    lines = found.table().splitlines()[1 : len(wanted) + 1]
    assert [int(line[30:40], 16) for line in lines] == wanted


def test_limits_that_are_just_met_are_met() -> None:
    """Two drives: 512 us for the TPDOs, 270 us for the RPDOs, 785 us in all; 1 ns less does not."""
    found = cycle_arithmetic(RATE, 785 * US, 515 * US, tpdos(2), rpdos(2))
    assert (found.last_tpdo_ns, found.last_rpdo_ns) == (512 * US, 782 * US)
    assert (found.rpdo_limit_ns, found.busy_ns) == (782 * US, 785 * US)
    assert found.fits
    assert replace(found, cycle_offset_ns=512 * US).tpdos_in_time
    for late in (
        replace(found, cycle_offset_ns=512 * US - 1),
        replace(found, last_rpdo_ns=782 * US + 1),
        replace(found, busy_ns=785 * US + 1),
    ):
        assert not late.fits
        assert late.table().count("0.0 over") == 1


@pytest.mark.parametrize(("offset", "delivered"), [(190, 417), (191, 282)])
def test_an_rpdo_overtakes_a_tpdo_that_begins_at_its_request(offset: int, delivered: int) -> None:
    """TPDO2 (0x281) would begin at 55 + 135 us: an RPDO (0x201) of that instant goes first."""
    found = cycle_arithmetic(RATE, MS, offset * US, tpdos(1), rpdos(1))
    assert found.last_tpdo_ns == delivered * US


@pytest.mark.parametrize(
    ("event", "waits"),
    [
        (PlannedFrame("same base", 0x181 << 18, 8), False),
        (PlannedFrame("base below", (0x181 << 18) - 1, 8), True),
        (PlannedFrame("the same", 0x181, 8), False),
    ],
)
def test_an_extended_frame_loses_against_its_own_base(event: PlannedFrame, waits: bool) -> None:
    """ISO 11898-1: 11 bits, then IDE, which is dominant in a base frame. 160 bits at the most.

    A frame that loses may be on the wire already, one that wins waits for nothing: both cost its
    time here; the table has them in the order of the bus.
    """
    tpdo = PlannedFrame("TPDO1", 0x181, 8)
    found = cycle_arithmetic(RATE, MS, 600 * US, [tpdo], [], [event])
    assert (event.key < tpdo.key) == waits
    longest = 0 if event.key == tpdo.key else worst_case_bits(8, event.can_id > 0x7FF)
    assert found.last_tpdo_ns == (55 + 135 + longest - 3) * US


def simulated(
    frames: list[tuple[float, PlannedFrame]], up: list[PlannedFrame], offset: int
) -> dict[str, float]:
    """Run one cycle in bit times: non-preemptive, lowest identifier first; end of each frame."""
    waiting, ends, now = list(frames), {}, min(time for time, _ in frames)
    while waiting:
        ready = [item for item in waiting if item[0] <= now]
        if not ready:
            now = min(time for time, _ in waiting)
            continue
        item = min(ready, key=lambda item: item[1].can_id)
        waiting.remove(item)
        now += worst_case_bits(item[1].data_bytes)
        ends[item[1].name] = now
        if item[1] is SYNC:
            waiting += [(now - 3, frame) for frame in up]
    return ends


@pytest.mark.long(but=1)
@pytest.mark.parametrize("offset", [200, 400, 600, 700])
@pytest.mark.parametrize("drives", [1, 2, 3])
def test_no_moment_of_the_events_is_worse_than_the_arithmetic(drives: int, offset: int) -> None:
    """Events at random moments around both requests; the bound holds and is nearly reached."""
    numbers = random.Random(drives * 1000 + offset)
    events = [
        PlannedFrame("EMCY", 0x81, 8),
        PlannedFrame("TPDO3", 0x381, 4),
        PlannedFrame("SDO", 0x581, 8),
    ]
    up, down = tpdos(drives), rpdos(drives)
    found = cycle_arithmetic(RATE, 10 * MS, offset * US, up, down, events)
    worst_up = worst_down = 0.0
    for _ in range(4000):
        moments = [
            numbers.choice((-0.01, 0, 60, offset - 0.01, numbers.uniform(-135, 900)))
            for _ in events
        ]
        frames: list[tuple[float, PlannedFrame]] = list(zip(moments, events, strict=True))
        frames += [(0, SYNC), *((offset, frame) for frame in down)]
        ends = simulated(frames, up, offset)
        worst_up = max(worst_up, *(ends[frame.name] for frame in up))
        worst_down = max(worst_down, *(ends[frame.name] for frame in down))
    assert found.last_tpdo_ns / US - 100 < worst_up - 3 <= found.last_tpdo_ns / US
    assert found.last_rpdo_ns / US - 100 < worst_down - 3 <= found.last_rpdo_ns / US
