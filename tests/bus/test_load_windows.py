"""The worst window is never an artefact of where the windows begin."""

import math

import pytest

from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.load import LoadMeter
from axisrig.kernel.time.clock import MS


def test_a_run_shorter_than_the_window_is_judged_by_its_own_length() -> None:
    """45 ms of a bus that is never idle are 100 %, not 45."""
    meter = LoadMeter(1_000_000)
    meter.occupy(0, 45 * MS, 45_000)
    load = meter.figures(45 * MS)
    assert (load.busy_share, load.worst_100ms_share) == (1.0, 1.0)


def test_the_worst_window_lies_anywhere() -> None:
    """80 ms of load around 100 ms are 80 % of the window from 60 to 160 ms."""
    meter = LoadMeter(1_000_000)
    meter.occupy(60 * MS, 140 * MS, 80_000)
    load = meter.figures(300 * MS)
    assert load.worst_100ms_share == pytest.approx(0.8)
    assert load.worst_100ms_bits == 80_000


def test_an_even_load_is_the_same_in_every_window() -> None:
    meter = LoadMeter(1_000_000)
    for ms in range(150):
        meter.occupy(ms * MS, ms * MS + 300_000, 300)
    load = meter.figures(150 * MS)
    assert load.worst_100ms_share == pytest.approx(load.busy_share) == pytest.approx(0.3)


@pytest.mark.parametrize("busy_ms", [0, 1, 99, 100, 250, 299])
def test_the_worst_window_is_found_wherever_it_is(busy_ms: int) -> None:
    """1000 bits there, the first and the last window included; 500 far away, 1 in the last ms."""
    meter = LoadMeter(1_000_000)
    far_ms = (busy_ms + 150) % 300
    for begin_ms, length_us in sorted(((busy_ms, 1000), (far_ms, 500), (299, 1))):
        meter.occupy(begin_ms * MS, begin_ms * MS + length_us * 1000, length_us)
    load = meter.figures(300 * MS)
    assert load.worst_100ms_bits - (busy_ms in (250, 299)) == 1000
    assert load.worst_1ms_bits - (busy_ms == 299) == 1000


@pytest.mark.parametrize(
    ("until_ms", "span_ms", "share"),
    [(4, 10, 0.5), (4, 4, 0.5), (4, 2, 0.0), (4, 3, 1 / 3), (2, 1, 1.0), (0, 10, 0.0), (4, 0, 0.0)],
)
def test_the_load_of_now_is_of_the_time_that_has_been(
    until_ms: int, span_ms: int, share: float
) -> None:
    """Busy for the first 2 ms of 4; a longer span than the run is the whole run."""
    meter = LoadMeter(1_000_000)
    meter.occupy(0, 2 * MS, 2000)
    meter.occupy(4 * MS, 5 * MS, 1000)
    assert meter.now(until_ms * MS, span_ms * MS).busy_share == pytest.approx(share)
    assert meter.now(until_ms * MS + MS - 1, span_ms * MS).busy_share == pytest.approx(share)


@pytest.mark.parametrize("extended", [False, True])
def test_frames_and_delays_are_of_an_identifier_with_its_kind(extended: bool) -> None:
    """Bit 31 for 29-bit ones, as in SocketCAN, of what was sent and of what still waits."""
    meter = LoadMeter(1_000_000)
    mark = 0x8000_0000 if extended else 0
    meter.count_frame(0x123, extended, 700)
    meter.count_frame(0x123, extended, 300)
    meter.count_frame(0x123, not extended, 100)
    meter.count_error()
    waiting = [
        (Frame(0x080, b"", extended, False, 0), 400),
        (Frame(0x123, b"", extended, False, 0), 900),
    ]
    load = meter.figures(1000, waiting)
    assert load.worst_delay_ns == {
        0x080 | mark: 600,
        0x123 | mark: 700,
        0x123 | mark ^ 0x8000_0000: 100,
    }
    assert list(load.worst_delay_ns) == sorted(load.worst_delay_ns)
    assert (load.frames, load.error_frames) == (3, 1)


@pytest.mark.parametrize("past_bits", [-1, 0, 1, 2, 999, 1000, 1001, 2500])
@pytest.mark.parametrize("is_frame", [True, False])
def test_what_ends_past_a_border_is_shared_to_the_bit(past_bits: int, is_frame: bool) -> None:
    """It begins 100 bits before the end of the first ms, at 1 Mbit/s."""
    meter = LoadMeter(1_000_000)
    bits = 100 + past_bits
    begin_ns, end_ns = 900_000, 900_000 + bits * 1000
    if is_frame:
        meter.passed.append((begin_ns, end_ns, bits, 0x181, False, 0))
    else:
        meter.occupy(begin_ns, end_ns, bits)
    found = meter.busy_bits(MS)
    expected = [min(100, bits)]
    for window in range(1, 4):
        expected.append(min(max(past_bits - 1000 * (window - 1), 0), 1000))
    assert found == expected[: len(found)]
    assert sum(found) == bits
    assert meter.figures(4 * MS).worst_1ms_bits == max(expected)


@pytest.mark.parametrize("bits", [1, 10, 47, 131])
@pytest.mark.parametrize("bitrate", [800_000, 750_000, 83_333, 3_000_000])
def test_busy_bits_are_to_the_nearest_bit(bits: int, bitrate: int) -> None:
    """A bit need not be a whole number of ns: a frame ends at the one before or after its end."""
    length_ns = bits * 1e9 / bitrate
    for end_ns in (math.floor(length_ns), math.ceil(length_ns)):
        meter = LoadMeter(bitrate)
        meter.occupy(0, end_ns, bits)
        assert sum(meter.busy_bits(4 * MS)) == bits
        assert meter.figures(4 * MS).worst_100ms_bits == bits


@pytest.mark.parametrize("window_ns", [0, -MS, MS - 1, MS + 1, 2 * MS - 1, 5 * MS // 2])
def test_a_window_is_a_whole_number_of_ms(window_ns: int) -> None:
    meter = LoadMeter(1_000_000)
    with pytest.raises(ValueError, match=f"window of {window_ns} ns is not a multiple of 1000000"):
        meter.busy_bits(window_ns)
    meter.occupy(0, 5 * MS, 5000)
    assert meter.busy_bits(2 * MS) == [2000, 2000, 1000]
