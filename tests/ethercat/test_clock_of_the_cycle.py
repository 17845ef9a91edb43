"""The clock of a drive's cycle alone: what 1C32 and 1C33 say, counts of SYNC0 without outputs."""

from types import SimpleNamespace
from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.ethercat.cycle import CycleClock, Timing
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

OUTPUTS, INPUTS = 0x1C32, 0x1C33
TYPE, CYCLE, LEAST, MISSED, ERROR = 1, 2, 5, 11, 32


class Far:
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
def test_both_objects_say_what_runs(timing: int, outputs: int, inputs: int) -> None:
    """1C33:01: 34 = with the outputs, where these are the clock; else it is as 1C32:01."""
    far = Far(timing)
    assert far.made.read(OUTPUTS, TYPE) is None  # nothing runs: what was written
    assert far.made.start() is None
    assert far.made.read(OUTPUTS, TYPE) == outputs
    assert far.made.read(INPUTS, TYPE) == inputs
    cycle_ns = 2 * MS if timing == 2 else MS
    assert far.made.read(OUTPUTS, CYCLE) == far.made.cycle_ns == cycle_ns
    assert far.made.read(OUTPUTS, LEAST) == 250 * US
    far.made.stop()
    assert far.made.read(INPUTS, TYPE) is None


@pytest.mark.parametrize(
    ("period_us", "least_us", "cycle_us"), [(1000, 250, 1000), (100, 250, 250)]
)
def test_a_free_run_has_the_cycle_of_60c2_or_its_least(
    period_us: int, least_us: int, cycle_us: int
) -> None:
    far = Far(0, period_us * US, least_us * US)
    far.made.start()
    far.run_us(4 * cycle_us)
    assert far.cycles == [cycle_us * number for number in (1, 2, 3, 4)]
    far.made.stop()
    far.made.start()  # the first train ends with the stop
    far.run_us(2 * cycle_us)
    assert len(far.cycles) == 6
    far.made.outputs_came()
    far.made.sync0()
    far.run_us(1)
    assert len(far.cycles) == 6


def test_outputs_are_the_clock_where_they_are_and_not_after_a_stop() -> None:
    far = Far(1)
    far.made.outputs_came()
    far.run_us(10)
    assert far.cycles == []
    far.made.start()
    far.made.outputs_came()
    far.made.sync0()
    far.run_us(10)
    assert far.cycles == [10.0]
    far.made.outputs_came()
    far.made.stop()
    far.run_us(10)
    assert len(far.cycles) == 1


def test_sync0_without_outputs_is_counted_in_all_and_in_a_row() -> None:
    far = Far(2)
    far.made.start()
    far.made.outputs_came()
    seen = []
    for comes in (False, False, True, False, False, True, True):
        far.made.sync0()
        seen.append((far.made.missing, far.made.missed, far.made.read(OUTPUTS, ERROR)))
        if comes:
            far.made.outputs_came()
    assert seen == [(0, 0, 0), (1, 1, 1), (2, 2, 1), (0, 2, 0), (1, 3, 1), (2, 4, 1), (0, 4, 0)]
    assert len(far.cycles) == 7
    assert far.made.read(OUTPUTS, MISSED) == 4
    far.made.outputs_came()
    far.made.start()
    assert (far.made.missing, far.made.missed) == (0, 0)
    far.made.sync0()
    assert far.made.missing == 1  # outputs of before the start are none


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
    """SYNC0 that is active is the clock, whatever 1C32:01 says."""
    far = Far(timing)
    far.sync.has_sync0, far.sync.cycle0 = has_sync0, cycle0
    assert far.made.start() == refused
    if refused is None:
        assert far.made.timing is (Timing.SYNC0 if has_sync0 else Timing(timing))
        assert far.made.has_begun is not has_sync0
        far.sync.pulses = 1
        assert far.made.has_begun
        assert far.made.has_clock
        far.sync.has_sync0 = False
        assert far.made.has_clock is not has_sync0


@pytest.mark.parametrize(
    ("cycle0", "refused"),
    [(MS, None), (2 * MS, "INVALID_SYNC_CYCLE"), (249 * US, "INVALID_SYNC0_CYCLE")],
)
def test_sync0_agrees_with_60c2(cycle0: int, refused: str | None) -> None:
    far = Far(2)
    far.sync.cycle0 = cycle0
    far.made.start()
    assert far.made.disagrees() == refused
    other = Far(1)
    other.sync.cycle0 = cycle0
    other.made.start()
    assert other.made.disagrees() is None


def test_a_timing_changes_where_the_state_allows_it() -> None:
    """What is there, or what runs now, may be written always."""
    far = Far(1)
    far.made.start()
    far.may_change = False
    for index, value in ((OUTPUTS, 1), (INPUTS, 34), (INPUTS, 1)):
        far.made.check(index, TYPE, value)
    for index, value in ((OUTPUTS, 2), (INPUTS, 2)):
        with pytest.raises(SdoAbortedError) as error:
            far.made.check(index, TYPE, value)
        assert error.value.code == 0x08000022
    far.may_change = True
    far.made.check(OUTPUTS, TYPE, 2)
