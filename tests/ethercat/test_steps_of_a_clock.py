"""How a distributed clock takes a difference away, step by step, and how its oscillator drifts."""

import pytest

from axisrig.bench.drive.ethercat.distributed_clock import AHEAD, DistributedClock
from axisrig.bench.drive.ethercat.local_clock import LocalClock
from axisrig.bench.drive.ethercat.sync_unit import SyncUnit
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

MASK = (1 << 64) - 1


def _clock(ahead_ns: int) -> DistributedClock:
    """Return a clock that is ahead of the time of the reference by so many ns, at 1 ms."""
    clock = DistributedClock(LocalClock())
    clock.set_offset(ahead_ns & MASK, 0)
    clock.follow(1 * MS, 64, 1 * MS)
    return clock


@pytest.mark.parametrize("ahead_ns", [1, 2, 3, 4, 7, 1000, 1001])
@pytest.mark.parametrize("sign", [1, -1])
def test_half_of_a_difference_goes_at_once_toward_zero(ahead_ns: int, sign: int) -> None:
    """Of one ns all of it; the first time that comes is only noted. Either sign is the same."""
    clock = _clock(sign * ahead_ns)
    assert clock.system_ns(1 * MS) == 1 * MS + sign * ahead_ns
    clock.follow(2 * MS, 64, 2 * MS)
    assert clock.difference == ahead_ns | (AHEAD if sign > 0 else 0)
    left = ahead_ns - (ahead_ns // 2 or ahead_ns)
    assert clock.system_ns(2 * MS) == 2 * MS + sign * left


@pytest.mark.parametrize("sign", [1, -1])
def test_no_more_than_a_tenth_of_the_time_is_made_good(sign: int) -> None:
    """1 ms too far: 0.1 ms in each ms, as long as half of what is left is more than that."""
    clock = _clock(sign * MS)
    for number in range(2, 10):
        clock.follow(number * MS, 64, number * MS)
        left = MS - (number - 1) * MS // 10
        assert clock.system_ns(number * MS) == number * MS + sign * left


@pytest.mark.parametrize("sign", [1, -1])
def test_a_new_offset_drops_what_was_made_good(sign: int) -> None:
    clock = _clock(sign * 1000)
    clock.follow(2 * MS, 64, 2 * MS)
    steps = clock.steps
    clock.set_offset(sign * 1000 & MASK, 2 * MS)  # the same: nothing happens
    assert clock.system_ns(2 * MS) == 2 * MS + sign * 500
    assert clock.steps == steps
    clock.set_offset(sign * 777 & MASK, 2 * MS)
    assert clock.system_ns(2 * MS) == 2 * MS + sign * 777
    assert clock.steps == steps + 1


@pytest.mark.parametrize("offset_ns", [1000, -1000])
def test_an_offset_that_is_written_again_after_power_on_acts_again(offset_ns: int) -> None:
    """Registers 0920, 0928 and 092C are 0 after power on, and the copy is local time."""
    clock = DistributedClock(LocalClock())
    clock.delay = 7
    for number in (1, 3):
        clock.set_offset(offset_ns & MASK, number * MS)
        clock.follow(number * MS, 64, number * MS)
        assert clock.offset == offset_ns & MASK
        assert clock.system_ns(number * MS) == number * MS + offset_ns
        clock.reset()
        assert (clock.offset, clock.delay, clock.difference) == (0, 0, 0)
        assert clock.system_ns((number + 1) * MS) == (number + 1) * MS


@pytest.mark.parametrize("ahead_ns", [800, -800])
def test_a_rate_that_is_forgotten_moves_the_copy_no_more(ahead_ns: int) -> None:
    """800 ns in 1 ms leave an eighth of 0.8 parts of 1000; after a write of 0930 none."""
    clock = _clock(ahead_ns)
    clock.follow(2 * MS, 64, 2 * MS)
    at_once = clock.system_ns(2 * MS) - 2 * MS
    assert at_once == ahead_ns // 2
    assert clock.system_ns(3 * MS) - 3 * MS == at_once - ahead_ns // 8
    clock.forget(3 * MS)
    kept = clock.system_ns(3 * MS) - 3 * MS
    assert kept == at_once - ahead_ns // 8
    assert clock.system_ns(9 * MS) - 9 * MS == kept
    clock.follow(9 * MS, 64, 9 * MS)  # only noted again
    assert clock.system_ns(9 * MS) - 9 * MS == kept


@pytest.mark.parametrize("drift_ppm", [20.0, -20.0, 0.0])
@pytest.mark.parametrize("start_ns", [0, 10**15])
def test_the_start_of_an_oscillator_does_not_drift(drift_ppm: float, start_ns: int) -> None:
    clock = LocalClock(start_ns, drift_ppm)
    assert clock.at(0) == start_ns
    assert clock.at(10**9) == start_ns + 10**9 + round(drift_ppm * 1000)
    clock.jump(-500)
    assert clock.at(0) == start_ns - 500


@pytest.mark.parametrize("sign", [1, -1])
def test_whoever_counts_its_steps_knows_each_change_of_its_course(sign: int) -> None:
    """As long as `steps` stays the copy goes on as foreseen; SYNC0 is planned by that.

    An eighth of 200 us in 1 ms, four times: then the rate is a tenth and leaves nothing for a step.
    """
    clock = DistributedClock(LocalClock())
    changed = 0
    for number in range(1, 14):
        now_ns = number * MS
        off_ns = 0 if number < 3 else sign * MS // 5
        foreseen, steps = clock.system_ns(now_ns + MS), clock.steps
        clock.follow(clock.system_ns(now_ns) - off_ns, 64, now_ns)
        if clock.system_ns(now_ns + MS) != foreseen:
            changed += 1
            assert clock.steps > steps
    assert changed == 4
    ahead_ns = clock.system_ns(20 * MS) - clock.system_ns(19 * MS) - MS
    assert ahead_ns == -sign * MS // 10


@pytest.mark.parametrize("sign", [1, -1])
def test_sync0_follows_a_rate_that_grows_without_a_step(sign: int) -> None:
    """Each pulse is at the first instant at which the copy shows its time."""
    scheduler, clock = new_scheduler(), DistributedClock(LocalClock())
    shown: list[int] = []
    unit = SyncUnit(
        scheduler, clock, lambda: shown.append(clock.system_ns(scheduler.now_ns)), lambda: None
    )
    unit.cycle0, unit.start = 3 * MS, 4 * MS
    unit.activate(3)
    for number in range(1, 40):
        now_ns = number * MS
        scheduler.run_until(now_ns)
        off_ns = sign * MS // 5 if 3 <= number < 9 else 0
        clock.follow(clock.system_ns(now_ns) - off_ns, 64, now_ns)
        unit.moved()
    assert len(shown) > 9
    assert all(0 <= at - (4 + 3 * k) * MS <= 1 for k, at in enumerate(shown))
