"""The kernel's link against the drive node: latch, input level, lost telegrams, two lags."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.bus.can.faults import Drop, ErrorAtBit, FaultAction, FrameFault
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.bus.hits import Hits
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.cia402.ds402 import State

Make = Callable[..., Any]
MS, US = 1_000_000, 1_000
RPDO1, TPDO1, TPDO2, TPDO3 = 0x203, 0x183, 0x283, 0x383
INCREMENT_MM = 10 / 2**20


def _armed(bench: Any) -> None:
    """Arm and wait for the acknowledgement."""
    bench.link.arm()
    bench.cycle()
    bench.cycle()
    assert bench.link.is_armed


# Latch


@pytest.mark.parametrize(
    ("probe_input", "edge", "level"),
    [(1, "POS", False), (1, "NEG", True), (2, "POS", False), (2, "NEG", True)],
)
def test_latch_of_each_input_and_edge(
    link_bench: Make, probe_input: int, edge: str, level: bool
) -> None:
    bench = link_bench(
        start_mm=7.25,
        probe_input=probe_input,
        edge=edge,
        edges_ns=[60 * MS],
        level=level,
        counter=True,
    )
    bench.commission()
    assert bench.link.is_clear
    _armed(bench)
    while bench.scheduler.now_ns < 60 * MS:
        bench.cycle()
        assert not bench.link.has_latched
        assert bench.link.latched_mm is None
    bench.cycle()  # the SYNC at 60 ms arrives 47 us behind the edge
    assert bench.link.has_latched
    assert bench.link.latched_mm == pytest.approx(7.25, abs=INCREMENT_MM / 2)


def test_the_other_edge_latches_nothing(link_bench: Make) -> None:
    bench = link_bench(edge="NEG", edges_ns=[60 * MS])  # rises only
    bench.commission()
    _armed(bench)
    while bench.scheduler.now_ns < 63 * MS:
        bench.cycle()
    assert not bench.link.has_latched


def test_disarming_clears_the_status_and_the_value(link_bench: Make) -> None:
    bench = link_bench(start_mm=1.0, edges_ns=[60 * MS])
    bench.commission()
    _armed(bench)
    while not bench.link.has_latched:
        bench.cycle()
    bench.link.disarm()
    bench.cycle()  # sends 60B8 = 0
    assert not bench.link.is_clear
    bench.cycle()
    assert bench.link.is_clear
    assert bench.link.latched_mm is None


@pytest.mark.parametrize("lost", [TPDO1, TPDO2])
def test_a_value_needs_status_and_position_of_one_cycle(link_bench: Make, lost: int) -> None:
    """The first cycle behind the edge loses one of the two; the next one brings both."""
    bench = link_bench(start_mm=5.0, counter=True, edges_ns=[60 * MS])
    bench.commission()
    _armed(bench)
    while bench.scheduler.now_ns < 60 * MS:
        bench.cycle()
    bench.segment.add_fault(FrameFault(lost, hits=Hits(count=1)))
    bench.cycle()
    assert bench.link.latched_mm is None
    assert bench.link.has_latched is (lost == TPDO2)
    bench.cycle()
    assert bench.link.latched_mm == pytest.approx(5.0, abs=INCREMENT_MM / 2)


def test_the_old_position_is_not_taken_for_the_new_edge(link_bench: Make) -> None:
    """60BA still holds the first run's position when the second edge has come."""
    bench = link_bench(start_mm=5.0, counter=True, edges_ns=[60 * MS, 62 * MS, 70 * MS])
    bench.commission()
    _armed(bench)
    while not bench.link.has_latched:
        bench.cycle()
    bench.link.disarm()
    bench.axis.standing_m = 9e-3
    bench.cycle()
    bench.cycle()
    _armed(bench)
    while bench.scheduler.now_ns < 70 * MS:
        bench.cycle()
        assert bench.link.latched_mm is None
    bench.cycle()
    assert bench.link.latched_mm == pytest.approx(9.0, abs=INCREMENT_MM / 2)


@pytest.mark.parametrize(("pulse_us", "latches"), [(299, False), (300, True)])
def test_a_pulse_shorter_than_the_filter_is_no_latch_and_no_value(
    link_bench: Make, pulse_us: int, latches: bool
) -> None:
    bench = link_bench(
        start_mm=5.0,
        counter=True,
        edges_ns=[60 * MS, 60 * MS + pulse_us * US],
        profile=DriveProfile(input_delay_ns=0, input_filter_ns=300 * US),
    )
    bench.commission()
    _armed(bench)
    while bench.scheduler.now_ns < 70 * MS:
        bench.cycle()
        assert bench.link.is_actuated is False  # both levels came and went between two SYNCs
    assert bench.link.has_latched is latches
    assert (bench.link.latched_mm is not None) is latches


class _Disturbance:
    """Keeps TPDO2 of one cycle off the bus by errors until `late_ns`, then drops the next one."""

    def __init__(self, late_ns: int, clock: Any) -> None:
        self._late_ns, self._clock = late_ns, clock
        self._came_through = 0

    def __call__(self, frame: Frame, _port: SimBus, _attempt: int) -> FaultAction | None:
        if frame.arbitration_id != TPDO2:
            return None
        if self._clock.now_ns < self._late_ns:
            return ErrorAtBit(60)
        self._came_through += 1
        return Drop() if self._came_through == 2 else None


def test_a_position_that_comes_late_does_not_prove_the_next_status(link_bench: Make) -> None:
    """TPDO2 of SYNC k is delayed behind the NC cycle, the edge comes, TPDO2 of k+1 is lost.

    What then lies there was sampled before the edge and must not count for it.
    """
    bench = link_bench(start_mm=5.0, counter=True, edges_ns=[60 * MS + 500 * US])
    bench.commission()
    _armed(bench)
    while bench.scheduler.now_ns < 60 * MS:
        bench.cycle()
    bench.segment.add_fault(_Disturbance(60 * MS + 620 * US, bench.scheduler))
    bench.cycle()
    assert not bench.link.has_latched
    bench.cycle()
    assert bench.link.has_latched
    assert bench.link.latched_mm is None


# Level of the input


@pytest.mark.parametrize(
    ("edge", "level", "actuated"),
    [("POS", True, True), ("POS", False, False), ("NEG", True, False), ("NEG", False, True)],
)
@pytest.mark.parametrize("probe_input", [1, 2])
def test_actuated_is_the_level_that_the_edge_brings(
    link_bench: Make, probe_input: int, edge: str, level: bool, actuated: bool
) -> None:
    bench = link_bench(probe_input=probe_input, edge=edge, level=level)
    assert bench.link.is_actuated is None  # nothing has come yet
    bench.commission()  # the drive tells its inputs when it becomes operational
    assert bench.link.is_actuated is actuated


def test_actuated_follows_the_input(link_bench: Make) -> None:
    bench = link_bench(edges_ns=[60 * MS, 65 * MS])
    bench.commission()
    seen = []
    while bench.scheduler.now_ns < 68 * MS:
        bench.cycle()
        if bench.scheduler.now_ns > 58 * MS:
            seen.append(bench.link.is_actuated)
    # The cycles of 58 and 59 ms, of 60 to 64 ms, of 65 to 67 ms
    assert seen == [False] * 2 + [True] * 5 + [False] * 3


def test_actuated_is_unknown_without_the_inputs_telegram(link_bench: Make) -> None:
    bench = link_bench(level=True)
    bench.segment.add_fault(FrameFault(TPDO3))
    bench.commission()
    for _ in range(5):
        bench.cycle()
    assert bench.link.is_actuated is None


# Lost telegrams


def test_900006_in_the_fourth_cycle_without_tpdo1(link_bench: Make) -> None:
    bench = link_bench()
    bench.commission()
    bench.cycle()
    bench.segment.add_fault(FrameFault(TPDO1))
    for _ in range(3):
        bench.cycle()
    with pytest.raises(Alarm) as caught:
        bench.cycle()
    assert caught.value.id == 900006
    assert caught.value.values == {"axis": "Z", "pdo": "TPDO1", "cycles": 4}


def test_three_missing_telegrams_are_forgiven_again_and_again(link_bench: Make) -> None:
    bench = link_bench(start_mm=3.0)
    bench.commission()
    for _ in range(3):
        bench.cycle(3.0)
        bench.segment.add_fault(FrameFault(TPDO1, hits=Hits(count=3)))
        for _ in range(3):
            bench.cycle(3.0)
            # What came last
            assert bench.link.actual_mm == pytest.approx(3.0, abs=INCREMENT_MM / 2)
    bench.cycle(3.0)


# State machine


def test_power_leads_to_operation_enabled_one_step_a_sync(link_bench: Make) -> None:
    bench = link_bench()
    bench.commission()
    bench.link.order(PowerOrder.SWITCH_ON)
    states = []
    for _ in range(6):
        bench.cycle()
        states.append(bench.link.state)
    assert states == [
        State.SWITCH_ON_DISABLED,
        State.READY_TO_SWITCH_ON,
        State.SWITCHED_ON,
        State.OPERATION_ENABLED,
        State.OPERATION_ENABLED,
        State.OPERATION_ENABLED,
    ]


def test_without_power_the_drive_stays_ready(link_bench: Make) -> None:
    bench = link_bench()
    bench.commission()
    for _ in range(5):
        bench.cycle()
    assert bench.link.state is State.READY_TO_SWITCH_ON


def test_a_fault_is_told_with_its_emergency_code(link_bench: Make) -> None:
    """Following error: window 6065 of 0.1 mm, time-out 6066 of 0, the axis 0.5 mm behind."""
    bench = link_bench(behind_mm=0.5)
    bench.commission()
    bench.remote.sdo[0x6065].raw = round(0.1 / INCREMENT_MM)
    bench.remote.sdo[0x6066].raw = 0
    bench.link.order(PowerOrder.SWITCH_ON)
    for _ in range(12):
        bench.cycle(0.0)
        if bench.link.emergency:
            break
    assert bench.link.emergency.code == 0x8611
    assert bench.link.state in (State.FAULT_REACTION_ACTIVE, State.FAULT)


# Two position lags


@pytest.mark.parametrize("delay_cycles", [0, 1, 2, 4])
@pytest.mark.parametrize("speed_mm_s", [16.0, -25.0])
def test_the_two_lags_differ_by_the_cycles_between_them(
    link_bench: Make, delay_cycles: int, speed_mm_s: float
) -> None:
    """Derived for steady motion with v and a drive that is L behind its demand:

    Cycle k sends s(k). SYNC k+1 gives it to the drive, which reaches it at SYNC k+2. So at SYNC k
    the demand is s(k-2), the encoder x(k) = s(k-2) - L, and 60F4 = L.
    The CNC has x(k) in cycle k and with the set value of this cycle counted its lag is
    e(k) = s(k-d) - x(k) = s(k-d) - s(k-2) + L = (2-d) v T + L.
    What the cycle judges before s(k) is made is the same; there d = 0 counts as 1.
    """
    behind_mm, period_s = 0.5, 1e-3
    bench = link_bench(behind_mm=behind_mm, lag_delay_cycles=delay_cycles)
    bench.commission()
    bench.enable()
    for k in range(1, 21):
        bench.cycle(speed_mm_s * period_s * k)
    for lag_mm, drive_lag_mm in bench.lags_mm[-10:]:
        assert drive_lag_mm == pytest.approx(behind_mm, abs=2 * INCREMENT_MM)
        difference = (2 - delay_cycles) * speed_mm_s * period_s
        assert lag_mm - drive_lag_mm == pytest.approx(difference, abs=3 * INCREMENT_MM)
    judged_mm = behind_mm + (2 - max(delay_cycles, 1)) * speed_mm_s * period_s
    assert bench.judged_lags_mm[-10:] == pytest.approx([judged_mm] * 10, abs=3 * INCREMENT_MM)


def test_both_lags_agree_at_standstill(link_bench: Make) -> None:
    bench = link_bench(behind_mm=0.25, lag_delay_cycles=2)
    bench.commission()
    bench.enable()
    for _ in range(5):
        bench.cycle(0.0)
    lag_mm, drive_lag_mm = bench.lags_mm[-1]
    assert lag_mm == pytest.approx(0.25, abs=2 * INCREMENT_MM)
    assert drive_lag_mm == pytest.approx(0.25, abs=2 * INCREMENT_MM)
