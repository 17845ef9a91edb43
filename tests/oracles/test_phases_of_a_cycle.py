"""Phases of a cycle on EtherCAT against a walk by nanoseconds, with small numbers."""

from itertools import count, product

import pytest

from axisrig.bench.oracles.phases import Phases

PERIOD = 5
PLACES = list(product(range(PERIOD), repeat=4))
"""Of NC cycle, frame, SYNC0 and sample."""


def first(phase: int, since: int) -> int:
    """The first instant of a grid, not before another one."""
    return next(ns for ns in count(since) if (ns - phase) % PERIOD == 0)


@pytest.mark.parametrize(("passing", "back"), [(0, 0), (1, 2), (2, 4), (4, 9), (5, 5)])
def test_a_set_value_is_seen_as_the_walk_sees_it(passing: int, back: int) -> None:
    """Sent with the first frame from its cycle on, acting at the SYNC0 after it has passed.

    A sample after that leaves with the first frame that passes later, which an NC cycle reads when
    it is back.
    """
    for cycle, frame, sync, sample in PLACES:
        acts = first(sync, first(frame, cycle) + passing)
        sampled = first(sample, acts + 1)
        carried = next(ns for ns in count(-PERIOD) if ns >= sampled - passing
                       and (ns - frame) % PERIOD == 0)  # fmt: skip
        reads = next(n for n in count() if n * PERIOD + cycle >= carried + back)
        fresh = next(n for n in count() if n * PERIOD + cycle >= acts + PERIOD)
        found = Phases(PERIOD, cycle, frame, sync, sample, passing, back)
        assert found.acts_ns() == acts
        assert (found.way, found.late_cycles) == (reads, reads - 2), found
        assert found.fresh_late_cycles == fresh - 2, found


@pytest.mark.parametrize(
    ("time_ns", "cycle"), [(-3, 0), (1, 0), (2, 0), (3, 1), (12, 1), (13, 2), (1002, 100)]
)
def test_a_sample_is_read_by_the_cycle_after_its_frame_is_back(time_ns: int, cycle: int) -> None:
    """Of 10 ns: samples at 2, frames at 3 that pass 1 ns and are back 4 ns later, cycles at 8."""
    phases = Phases(10, 8, 3, 0, 2, 1, 4)
    assert phases.seen_in(time_ns) == cycle


@pytest.mark.parametrize(("back_ns", "cycle"), [(5, 0), (6, 1), (15, 1), (16, 2)])
def test_a_frame_that_is_back_in_the_cycle_itself_is_read_by_it(back_ns: int, cycle: int) -> None:
    assert Phases(10, 8, 3, 0, 2, 1, back_ns).seen_in(2) == cycle
