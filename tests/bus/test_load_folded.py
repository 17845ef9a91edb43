"""A long run keeps the figures of its load and not every window."""

import random
from itertools import pairwise

import pytest

from axisrig.bench.bus.can.load import KEPT_WINDOWS, LoadMeter
from axisrig.kernel.time.clock import MS

BITRATE = 1_000_000
BIT_NS = 1000


def traffic(seed: int, until_ms: int) -> list[tuple[int, int]]:
    """Occupations of a bus, (begin, end) in ns: frames in bursts, and silence of up to 300 ms."""
    numbers, at_ns, found = random.Random(seed), 0, []
    while at_ns < until_ms * MS:
        for _ in range(numbers.randrange(1, 200)):
            bits = numbers.randrange(47, 160)
            found.append((at_ns, at_ns + bits * BIT_NS))
            at_ns += bits * BIT_NS + numbers.choice((0, 0, 0, 137_000, 800_000))
        at_ns += numbers.choice((0, MS, 7 * MS, 300 * MS))
    return found


def windows_of(found: list[tuple[int, int]]) -> list[int]:
    """Busy ns of each ms, counted by borders: apart from how the meter does it."""
    busy = [0] * (found[-1][1] // MS + 1)
    for begin_ns, end_ns in found:
        borders = [b * MS for b in range(begin_ns // MS + 1, -(-end_ns // MS))]
        for one, other in pairwise([begin_ns, *borders, end_ns]):
            busy[one // MS] += other - one
    return busy


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("errors", [0, 37])
def test_the_figures_of_a_long_run_are_those_of_all_its_windows(seed: int, errors: int) -> None:
    """errors: each so many-th occupation is an error frame, which the meter takes at once."""
    found = traffic(seed, 4 * KEPT_WINDOWS)
    meter = LoadMeter(BITRATE)
    sizes = []
    for number, (begin_ns, end_ns) in enumerate(found):
        bits = (end_ns - begin_ns) // BIT_NS
        if errors and number % errors == 0:
            meter.occupy(begin_ns, end_ns, bits)
        else:
            meter.passed.append((begin_ns, end_ns, bits, 0x181, False, number))
        if number % 500 == 499:
            meter.settle()
            sizes.append(len(meter._busy_ns))
    until_ns = found[-1][1]
    load, busy = meter.figures(until_ns), windows_of(found)
    assert load.busy_bits == sum(busy) // BIT_NS
    assert load.busy_share == sum(busy) / until_ns
    assert load.worst_1ms_bits == round(max(busy) / BIT_NS)
    worst_ns = max(sum(busy[at : at + 100]) for at in range(len(busy) - 99))
    assert load.worst_100ms_share == worst_ns / (100 * MS)
    assert max(sizes) < 2 * KEPT_WINDOWS
    with pytest.raises(ValueError, match="are summed up"):
        meter.busy_bits(MS)


def test_the_load_of_now_is_that_of_the_last_windows_however_long_the_run_is() -> None:
    """A bus that is busy for 0.1 ms of each ms, and from some ms on for 0.3 ms of each."""
    meter, seen = LoadMeter(BITRATE), []
    for window in range(3 * KEPT_WINDOWS):
        bits = 300 if window % 1000 >= 900 else 100
        begin_ns = window * MS
        meter.passed.append((begin_ns, begin_ns + bits * BIT_NS, bits, 0x181, False, 0))
        if window % 1000 in (99, 899, 949, 999):
            now = meter.now((window + 1) * MS, 100 * MS)
            assert now.frames == window + 1
            seen.append(now.busy_share)
    assert seen == pytest.approx(([0.1, 0.1, 0.2, 0.3] * 7)[: len(seen)])
    assert len(seen) > 3 * KEPT_WINDOWS // 250 - 2


FOLDED = KEPT_WINDOWS + 1 - 100
"""Windows of a fold, where each one is settled: one more than are kept leaves the last 100."""
BURSTS = [
    (-100, 100),
    (-99, 100),
    (0, 1),
    (-50, 100),
    (-1, 100),
    (99, 1),
    (0, 100),
    (50, 0),
    (50, 0),
]
"""Of each fold: where its burst begins, counted from its border, and how many ms it has."""


def test_a_burst_counts_wherever_the_windows_are_summed_up() -> None:
    """100 bits in each ms, and each burst has more in each of its ms than those before."""
    bits_of = [100] * (FOLDED * len(BURSTS) + 300)
    for number, (begin, length) in enumerate(BURSTS, 1):
        at = FOLDED * number + begin
        bits_of[at : at + length] = [400 + 50 * number] * length
    meter = LoadMeter(BITRATE)
    most, worst_100ms = [100], [100 * 100]
    for window, bits in enumerate(bits_of):
        begin_ns = window * MS
        if window % 7:
            meter.passed.append((begin_ns, begin_ns + bits * BIT_NS, bits, 1, False, 0))
        else:
            meter.occupy(begin_ns, begin_ns + bits * BIT_NS, bits)
            meter.count_error()
        meter.settle()
        number, past = divmod(window + 1, FOLDED)
        if past != 250 or not number:
            continue
        # 250 ms after a border its burst is over, and its windows are summed up or kept
        length, height = BURSTS[number - 1][1], 400 + 50 * number
        most.append(height if length else 100)
        worst_100ms.append(height * length + 100 * (100 - length))
        load = meter.figures((window + 1) * MS)
        assert (load.worst_1ms_bits, load.worst_100ms_bits) == (max(most), max(worst_100ms)), number
        assert load.worst_100ms_share == load.worst_100ms_bits / 100_000
        assert load.busy_bits == sum(bits_of[: window + 1])
        assert load.busy_share == pytest.approx(load.busy_bits / (window + 1) / 1000, rel=1e-12)
        assert load.frames + load.error_frames == window + 1
