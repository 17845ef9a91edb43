"""Fault confinement of one controller, count by count, and what it loses with its part on the bus.

Source: ISO 11898-1; Bosch CAN 2.0 part A, section 8.
"""

import pytest

from axisrig.bench.bus.can.confinement import ErrorCounters, ErrorState
from axisrig.bench.bus.can.faults import Delay, ErrorAtBit
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

ACTIVE, PASSIVE, BUS_OFF = ErrorState.ACTIVE, ErrorState.PASSIVE, ErrorState.BUS_OFF


def counted(tec: int = 0, rec: int = 0) -> ErrorCounters:
    found = ErrorCounters()
    found.tec, found.rec = tec, rec
    return found


@pytest.mark.parametrize(
    ("tec", "rec", "state"),
    [(0, 0, ACTIVE), (127, 127, ACTIVE), (128, 0, PASSIVE), (0, 128, PASSIVE), (255, 500, PASSIVE)],
)
def test_either_count_makes_passive_and_neither_alone_bus_off(
    tec: int, rec: int, state: ErrorState
) -> None:
    assert counted(tec, rec).state is state


def test_bus_off_stays_whatever_is_counted_until_the_counts_begin_anew() -> None:
    counters = counted(tec=248)
    counters.transmit_failed()
    assert (counters.tec, counters.state) == (256, BUS_OFF)
    for _ in range(30):
        counters.transmitted()
    assert (counters.tec, counters.state) == (226, BUS_OFF)
    counters.transmit_failed()
    assert (counters.tec, counters.state) == (234, BUS_OFF)
    counters.reset()
    assert (counters.tec, counters.rec, counters.state) == (0, 0, ACTIVE)
    counters.transmit_failed()
    assert (counters.tec, counters.state) == (8, ACTIVE)


@pytest.mark.parametrize(("tec", "after"), [(0, 8), (120, 128), (127, 135), (128, 128), (248, 248)])
def test_a_missing_acknowledgement_counts_until_passive(tec: int, after: int) -> None:
    counters = counted(tec)
    counters.transmit_failed(is_unacknowledged=True)
    assert counters.tec == after
    assert counters.state is not BUS_OFF


@pytest.mark.parametrize(("rec", "after"), [(0, 0), (1, 0), (127, 126), (128, 127), (400, 127)])
def test_a_received_frame_counts_one_less_and_brings_passive_to_127(rec: int, after: int) -> None:
    counters = counted(rec=rec)
    counters.received()
    assert counters.rec == after


@pytest.mark.parametrize(("is_primary", "step"), [(False, 1), (True, 9)])
def test_who_sees_an_error_first_counts_8_more(is_primary: bool, step: int) -> None:
    counters = counted(rec=3)
    counters.receive_failed(is_primary=is_primary)
    assert (counters.tec, counters.rec) == (0, 3 + step)


@pytest.mark.parametrize("behind", [0, 3])
def test_a_controller_that_becomes_bus_off_loses_what_it_was_sending_and_what_waits(
    behind: int,
) -> None:
    """32 attempts of 8 each; `discarded` counts every request that is lost."""
    scheduler = new_scheduler()
    with Segment("counted", 1_000_000, scheduler, automatic_recovery=False) as segment:
        sender, near = segment.port("sender"), segment.port("near")
        segment.add_fault(lambda _frame, port, _attempt: ErrorAtBit(20) if port is sender else None)
        for number in range(1 + behind):
            sender.send_raw(0x100 + number, b"")
        scheduler.run_until(20 * MS)
        assert (sender.error_state, sender.tec) == (BUS_OFF, 256)
        assert sender.discarded == 1 + behind
        sender.send_raw(0x200, b"")
        assert sender.discarded == 2 + behind
        assert near.recv(0) is None
        assert segment.load().error_frames == 32


def test_requests_are_lost_with_the_power_each_counted_once() -> None:
    scheduler = new_scheduler()
    with Segment("counted", 1_000_000, scheduler) as segment:
        sender, near = segment.port("sender"), segment.port("near")
        for number in range(4):
            sender.send_raw(0x100 + number, b"")
        scheduler.run_until(10_000)  # the first is on the wire
        sender.power_off()
        sender.power_off()
        assert sender.discarded == 3
        sender.send_raw(0x200, b"")
        assert sender.discarded == 4
        scheduler.run_until(MS)
        assert (sender.discarded, sender.tec) == (4, 0)  # nothing is counted without power
        sender.power_on()
        assert (sender.tec, sender.rec, len(sender.pending)) == (0, 0, 0)
        sender.send_raw(0x300, b"")
        scheduler.run_until(2 * MS)
        received = near.recv(0)
        assert received is not None
        assert received.arbitration_id == 0x300
        assert near.recv(0) is None


def test_a_request_that_a_fault_delays_is_lost_when_its_controller_has_gone() -> None:
    """Back in its queue after 2 ms it meets a controller without power, or one that has it."""
    scheduler = new_scheduler()
    with Segment("counted", 1_000_000, scheduler) as segment:
        sender, other, near = (segment.port(name) for name in ("sender", "other", "near"))
        segment.add_fault(lambda _frame, _port, attempt: None if attempt else Delay(2 * MS))
        for port, can_id in ((sender, 0x100), (other, 0x200)):
            port.send_raw(can_id, b"")
        scheduler.run_until(MS)
        sender.power_off()
        assert sender.discarded == 0
        scheduler.run_until(3 * MS)
        assert (sender.discarded, other.discarded) == (1, 0)
        received = near.recv(0)
        assert received is not None
        assert received.arbitration_id == 0x200
