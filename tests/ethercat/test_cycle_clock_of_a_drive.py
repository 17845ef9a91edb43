"""The clock of a drive's cycle alone: what 1C32 and 1C33 show, counts of SYNC0 without outputs."""

from types import SimpleNamespace
from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.ethercat.cycle import CycleClock, Timing
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

OUTPUTS, INPUTS = 0x1C32, 0x1C33
TYPE, CYCLE, LEAST, MISSED, ERROR = 1, 2, 5, 11, 32


class Cycle:
    """A clock with 1C32:01 as `timing`; sync: of the distributed clock; cycles: in us."""

    def __init__(self, timing: int, period_ns: int = MS, least_ns: int = 250 * US) -> None:
        self.clock, self.cycles = new_scheduler(), list[float]()
        self.sync: Any = SimpleNamespace(has_sync0=timing == 2, cycle0=2 * MS, pulses=0)
        self.period_ns, self.may_change = period_ns, True
        store: Any = SimpleNamespace(value=lambda index, sub: timing)
        self.made = CycleClock(
            self.clock, store, self.sync, lambda: self.period_ns, least_ns, self._cycle,
            lambda: self.may_change,
        )  # fmt: skip

    def _cycle(self) -> None:
        self.cycles.append(self.clock.now_ns / US)

    def run_us(self, time_us: int) -> None:
        self.clock.run_until(self.clock.now_ns + time_us * US)


@pytest.mark.parametrize(("timing", "outputs", "inputs"), [(0, 0, 0), (1, 1, 34), (2, 2, 2)])
def test_both_objects_show_what_runs(timing: int, outputs: int, inputs: int) -> None:
    """1C33:01: 34 = with the outputs, where these are the clock; else it is as 1C32:01."""
    on = Cycle(timing)
    assert on.made.read(OUTPUTS, TYPE) is None  # nothing runs: what was written
    assert on.made.start() is None
    assert on.made.read(OUTPUTS, TYPE) == outputs
    assert on.made.read(INPUTS, TYPE) == inputs
    cycle_ns = 2 * MS if timing == 2 else MS
    assert on.made.read(OUTPUTS, CYCLE) == on.made.cycle_ns == cycle_ns
    assert on.made.read(OUTPUTS, LEAST) == 250 * US
    on.made.stop()
    assert on.made.read(INPUTS, TYPE) is None


@pytest.mark.parametrize(
    ("period_us", "least_us", "cycle_us"), [(1000, 250, 1000), (100, 250, 250)]
)
def test_a_free_run_has_the_cycle_of_60c2_or_its_least(
    period_us: int, least_us: int, cycle_us: int
) -> None:
    on = Cycle(0, period_us * US, least_us * US)
    on.made.start()
    on.run_us(4 * cycle_us)
    assert on.cycles == [cycle_us * number for number in (1, 2, 3, 4)]
    on.made.stop()
    on.made.start()  # the first train ends with the stop
    on.run_us(2 * cycle_us)
    assert len(on.cycles) == 6
    on.made.outputs_came()
    on.made.sync0()
    on.run_us(1)
    assert len(on.cycles) == 6


def test_outputs_are_the_clock_where_they_are_and_not_after_a_stop() -> None:
    on = Cycle(1)
    on.made.outputs_came()
    on.run_us(10)
    assert on.cycles == []
    on.made.start()
    on.made.outputs_came()
    on.made.sync0()
    on.run_us(10)
    assert on.cycles == [10.0]
    on.made.outputs_came()
    on.made.stop()
    on.run_us(10)
    assert len(on.cycles) == 1


def test_sync0_without_outputs_is_counted_in_all_and_in_a_row() -> None:
    on = Cycle(2)
    on.made.start()
    on.made.outputs_came()
    counts = []
    for comes in (False, False, True, False, False, True, True):
        on.made.sync0()
        counts.append((on.made.missing, on.made.missed, on.made.read(OUTPUTS, ERROR)))
        if comes:
            on.made.outputs_came()
    assert counts == [(0, 0, 0), (1, 1, 1), (2, 2, 1), (0, 2, 0), (1, 3, 1), (2, 4, 1), (0, 4, 0)]
    assert len(on.cycles) == 7
    assert on.made.read(OUTPUTS, MISSED) == 4
    on.made.outputs_came()
    on.made.start()
    assert (on.made.missing, on.made.missed) == (0, 0)
    on.made.sync0()
    assert on.made.missing == 1  # outputs of before the start are none


@pytest.mark.parametrize(
    ("has_sync0", "cycle0", "timing", "refused"),
    [
        (True, 0, 2, "INVALID_DC"),
        (True, 0, 1, "INVALID_DC"),
        (False, MS, 2, "INVALID_DC"),
        (False, 0, 1, None),
        (True, MS, 1, None),
        (True, MS, 0, None),
    ],
)
def test_a_start_needs_a_sync0_that_it_is_to_have(
    has_sync0: bool, cycle0: int, timing: int, refused: str | None
) -> None:
    """SYNC0 that is active is the clock, whatever 1C32:01 has."""
    on = Cycle(timing)
    on.sync.has_sync0, on.sync.cycle0 = has_sync0, cycle0
    assert on.made.start() == refused
    if refused is None:
        assert on.made.timing is (Timing.SYNC0 if has_sync0 else Timing(timing))
        assert on.made.has_begun is not has_sync0
        on.sync.pulses = 1
        assert on.made.has_begun
        assert on.made.has_clock
        on.sync.has_sync0 = False
        assert on.made.has_clock is not has_sync0


@pytest.mark.parametrize(
    ("cycle0", "refused"),
    [(MS, None), (2 * MS, "INVALID_SYNC_CYCLE"), (249 * US, "INVALID_SYNC0_CYCLE")],
)
def test_sync0_agrees_with_60c2(cycle0: int, refused: str | None) -> None:
    on = Cycle(2)
    on.sync.cycle0 = cycle0
    on.made.start()
    assert on.made.disagrees() == refused
    other = Cycle(1)
    other.sync.cycle0 = cycle0
    other.made.start()
    assert other.made.disagrees() is None


@pytest.mark.parametrize("period_ns", [250 * US, 249 * US])
def test_the_least_cycle_of_sync0_is_taken_where_60c2_is_the_same(period_ns: int) -> None:
    """1C32:05 = 250 us is what the drive can do."""
    on = Cycle(2, period_ns)
    on.sync.cycle0 = period_ns
    on.made.start()
    assert on.made.disagrees() == (None if period_ns == 250 * US else "INVALID_SYNC0_CYCLE")
    assert on.made.read(OUTPUTS, CYCLE) == period_ns


def test_what_is_counted_ends_at_16_bits() -> None:
    """1C32:0B is an UNSIGNED16; those in a row go on, for the drive gives up by them."""
    on = Cycle(2)
    on.made.start()
    on.made.missed = 0xFFFE
    for _ in range(3):
        on.made.sync0()
    assert (on.made.read(OUTPUTS, MISSED), on.made.missing) == (0xFFFF, 3)


def test_a_timing_changes_where_the_state_allows_it() -> None:
    """What is there, or what runs now, may be written always."""
    on = Cycle(1)
    on.made.start()
    on.may_change = False
    for index, value in ((OUTPUTS, 1), (INPUTS, 34), (INPUTS, 1)):
        on.made.check(index, TYPE, value)
    for index, value in ((OUTPUTS, 2), (INPUTS, 2)):
        with pytest.raises(SdoAbortedError) as error:
            on.made.check(index, TYPE, value)
        assert error.value.code == 0x08000022
    on.may_change = True
    on.made.check(OUTPUTS, TYPE, 2)
