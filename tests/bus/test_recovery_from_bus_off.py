"""The way back from bus-off, at 1 Mbit/s: one bit is 1000 ns.

ISO 11898-1: 128 times 11 recessive bits; a frame has 11 of them at its end.
"""

from collections.abc import Callable

import can
import pytest
from tests.bus.conftest import fails

from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.faults import ErrorAtBit
from axisrig.bench.bus.can.frame import data_frame, wire_bits
from axisrig.bench.bus.can.segment import Segment
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import Scheduler

Watch = Callable[[Segment], list[tuple[int, int, str]]]
PASSIVE, OFF = ErrorState.PASSIVE, ErrorState.BUS_OFF


def test_recovery_takes_128_times_11_recessive_bits(scheduler: Scheduler, segment: Segment) -> None:
    """On a bus at rest 1408 bits, from the end of the intermission behind the last error frame."""
    sender = segment.port("sender")
    segment.port("receiver")
    segment.add_fault(fails(32))
    sender.send_raw(0x080, b"")
    scheduler.run_until(10 * MS)
    (off_ns, *_), (active_ns, *_) = segment.state_changes[-2:]
    assert [state for *_, state in segment.state_changes] == [PASSIVE, OFF, ErrorState.ACTIVE]
    assert active_ns - off_ns == 3_000 + 128 * 11_000
    assert (sender.tec, sender.rec) == (0, 0)


def test_a_controller_forced_off_the_bus_comes_back_in_the_same_time(
    scheduler: Scheduler, segment: Segment, watch: Watch
) -> None:
    """Forced in bit 20 of its own frame: 20 bits, 6 recessive, flag 6, delimiter 8, then 1408."""
    seen = watch(segment)
    sender, other = segment.port("sender"), segment.port("other")
    found: list[ErrorState] = []
    sender.on_error_state(found.append)
    sender.send_raw(0x123, b"\x01\x02")
    scheduler.call_at(19_500, Phase.APPLICATION, sender.force_bus_off)
    scheduler.run_until(MS)
    assert seen == [(40_000, 0x123, "error")]
    assert (sender.error_state, sender.takes_part, other.rec) == (OFF, False, 1)
    scheduler.run_until(10 * MS)
    assert found == [OFF, ErrorState.ACTIVE]
    names = [(name, state) for _, name, state in segment.state_changes]
    assert names == [("sender", OFF), ("sender", ErrorState.ACTIVE)]
    # The error frame that its silence caused ends with 11 recessive bits as any other does
    assert segment.state_changes[1][0] == 43_000 + 127 * 11_000
    assert (sender.tec, sender.takes_part) == (0, True)


def test_on_a_busy_bus_every_frame_counts_once_for_the_recovery(scheduler: Scheduler) -> None:
    """Frames without a gap: 128 of them; recovery begins only when it is asked for."""
    with Segment("busy", 1_000_000, scheduler, automatic_recovery=False) as segment:
        sender, busy, _ = (segment.port(name) for name in ("sender", "busy", "receiver"))
        segment.add_fault(lambda frame, port, attempt: ErrorAtBit(9) if port is sender else None)
        sender.send_raw(0x000, b"")
        scheduler.run_until(5 * MS)
        assert sender.error_state is OFF
        for _ in range(200):
            busy.send_raw(0x100, b"")
        scheduler.run_until(5 * MS + 10_000)  # in the middle of the first one
        sender.recover()
        sender.recover()
        scheduler.run_until(60 * MS)
        assert sender.error_state is ErrorState.ACTIVE
        bits = len(wire_bits(data_frame(0x100, b""))) + 13
        assert segment.state_changes[-1][0] == 5 * MS + 128 * bits * 1000


def test_rest_frame_and_rest_add_up_for_the_recovery(scheduler: Scheduler) -> None:
    """500 bits at rest hold 45 times 11 recessive ones, the frame ends with one, 82 are left."""
    with Segment("half busy", 1_000_000, scheduler, automatic_recovery=False) as segment:
        sender, other, _ = (segment.port(name) for name in ("sender", "other", "receiver"))
        sender.force_bus_off()
        scheduler.run_until(5 * MS)
        sender.recover()
        scheduler.run_until(5 * MS + 500_000)
        other.send_raw(0x100, b"")
        scheduler.run_until(10 * MS)
        bits = len(wire_bits(data_frame(0x100, b""))) + 13
        back_ns, _, state = segment.state_changes[-1]
        assert state is ErrorState.ACTIVE
        assert back_ns == 5 * MS + (500 + bits + 82 * 11) * 1000


def test_state_of_python_can_can_be_set_to_recover(scheduler: Scheduler) -> None:
    with Segment("manual", 1_000_000, scheduler, automatic_recovery=False) as segment:
        sender, _ = segment.port("sender"), segment.port("receiver")
        segment.add_fault(fails(32))
        sender.send_raw(0x080, b"")
        scheduler.run_until(10 * MS)
        assert sender.state is can.BusState.ERROR
        sender.state = can.BusState.ACTIVE
        scheduler.run_until(20 * MS)
        assert sender.state is can.BusState.ACTIVE
        with pytest.raises(NotImplementedError):
            sender.state = can.BusState.PASSIVE


def test_power_that_goes_during_the_recovery_ends_it(
    scheduler: Scheduler, segment: Segment
) -> None:
    """Off while it counts, and again after power on: the old count ends nothing.

    Without power none begins, whoever asks for it.
    """
    sender, other = segment.port("sender"), segment.port("receiver")
    sender.force_bus_off()
    scheduler.run_until(MS)
    sender.power_off()
    sender.recover()
    scheduler.run_until(3 * MS)
    assert [state for *_, state in segment.state_changes] == [OFF]
    sender.power_on()
    sender.send_raw(0x080, b"")
    scheduler.run_until(4 * MS)
    assert (sender.error_state, other.recv(0) is not None) == (ErrorState.ACTIVE, True)
    sender.force_bus_off()
    for since_ns in (4 * MS, 5 * MS):
        scheduler.run_until(since_ns)
        sender.power_off()
        sender.power_on()
        sender.force_bus_off()
    scheduler.run_until(5 * MS + 128 * 11_000 - 1)
    assert sender.error_state is OFF
    scheduler.run_until(5 * MS + 128 * 11_000)
    assert (sender.error_state, sender.tec) == (ErrorState.ACTIVE, 0)


@pytest.mark.parametrize("again_us", [0, 11, 700, 1407])
def test_asking_again_does_not_begin_the_recovery_anew(scheduler: Scheduler, again_us: int) -> None:
    """128 times 11 bits from the first question on, at rest; there is one end."""
    with Segment("again", 1_000_000, scheduler, automatic_recovery=False) as segment:
        sender, _ = segment.port("sender"), segment.port("receiver")
        sender.force_bus_off()
        scheduler.run_until(MS)
        sender.recover()
        scheduler.run_until(MS + again_us * 1000)
        sender.recover()
        scheduler.run_until(5 * MS)
        found = [(time_ns, state) for time_ns, _, state in segment.state_changes]
        assert found == [(0, OFF), (MS + 128 * 11_000, ErrorState.ACTIVE)]
        sender.recover()  # nothing to recover from
        scheduler.run_until(10 * MS)
        assert len(segment.state_changes) == 2


def test_two_that_are_off_count_each_for_itself(scheduler: Scheduler) -> None:
    """One asks 500 us after the other; a frame in between counts once for both."""
    with Segment("two", 1_000_000, scheduler, automatic_recovery=False) as segment:
        ports = {name: segment.port(name) for name in ("a", "b", "busy", "receiver")}
        for name in "ab":
            ports[name].force_bus_off()
        scheduler.run_until(MS)
        ports["a"].recover()
        scheduler.run_until(MS + 500_000)
        ports["b"].recover()
        scheduler.run_until(2 * MS)
        ports["busy"].send_raw(0x100, b"")
        scheduler.run_until(10 * MS)
        bits = len(wire_bits(data_frame(0x100, b""))) + 13
        # 1000 bits at rest hold 90 times 11, 500 hold 45; the frame has one more
        left = {"a": 128 - 90 - 1, "b": 128 - 45 - 1}
        back = {name: time_ns for time_ns, name, state in segment.state_changes if state is not OFF}
        assert back == {name: 2 * MS + (bits + 11 * count) * 1000 for name, count in left.items()}
