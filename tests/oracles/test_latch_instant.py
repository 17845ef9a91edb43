"""The instant of a latch: delay and compensation of an input, samples, stamps of a terminal."""

import pytest

from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.bench.oracles.sources.chain import Stamps
from axisrig.bench.oracles.sources.telegrams import counting

FAST = Stamps(drift_ppm=1e6)
"""A clock that goes twice as fast."""


@pytest.mark.parametrize(
    ("times", "edge_ns", "instant_ns"),
    [
        (LatchTimes(), 5_000, 5_000),
        (LatchTimes(delay_ns=300), 5_000, 5_300),
        (LatchTimes(compensation_ns=300), 5_000, 4_700),
        (LatchTimes(delay_ns=300, compensation_ns=100), 5_000, 5_200),
        (LatchTimes(jitter_ns=999), 5_000, 5_000),
        # The sample before: at a sample it is that one
        (LatchTimes(sample_ns=1_000), 5_000, 5_000),
        (LatchTimes(sample_ns=1_000), 5_999, 5_000),
        (LatchTimes(sample_ns=1_000), 6_000, 6_000),
        (LatchTimes(delay_ns=2, sample_ns=1_000), 5_999, 6_000),
        (LatchTimes(compensation_ns=1, sample_ns=1_000), 6_000, 5_000),
        # Nothing is before 0
        (LatchTimes(compensation_ns=300), 300, 0),
        (LatchTimes(compensation_ns=300), 200, 0),
        (LatchTimes(compensation_ns=300, sample_ns=1_000), 200, 0),
        # A terminal stamps what comes behind its input, and the CNC takes its clock back
        (LatchTimes(delay_ns=300, stamps=Stamps(resolution_ns=1_000)), 5_900, 6_000),
        (LatchTimes(compensation_ns=100, stamps=Stamps(assumed_offset_ns=50)), 5_000, 4_850),
        (LatchTimes(delay_ns=500, stamps=FAST), 5_000, 11_000),
    ],
)
def test_the_instant_of_an_edge(times: LatchTimes, edge_ns: int, instant_ns: int) -> None:
    assert times.instant_ns(edge_ns) == instant_ns


# Telegrams of a node


A, B = b"\x01", b"\x02"


@pytest.mark.parametrize(
    ("telegrams", "left"),
    [
        ([(200, A), (1_300, B), (2_599, A)], [0, 1, 2]),
        # Both ends of the time for an answer belong to it
        ([(155, A), (1_600, A)], [0, 1]),
        ([(154, A), (1_601, A)], []),
        # Two alike say the same, two that differ say nothing
        ([(200, A), (300, A)], [0, 1]),
        ([(200, A), (300, B)], []),
        ([(200, A), (300, A), (400, B)], []),
        ([(200, A), (300, b"\x01\x00")], []),
        ([(200, A), (300, B), (1_200, A), (2_200, B)], [2, 3]),
        # What comes outside of the time contradicts nothing
        ([(100, B), (200, A), (700, B)], [1]),
        ([(200, A), (1_154, B), (1_200, B)], [0, 2]),
        ([], []),
    ],
)
def test_a_telegram_counts_that_answers_its_sync_without_a_contradiction(
    telegrams: list[tuple[int, bytes]], left: list[int]
) -> None:
    """SYNCs each 1000 ns; an answer ends from 155 to 600 ns after one."""
    assert counting(telegrams, 1_000, 155, 600) == [telegrams[place] for place in left]
