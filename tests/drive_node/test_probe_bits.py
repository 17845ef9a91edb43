"""Every bit of 60B8 and 60B9, for both probes, on the bit tables of CiA 402-2 written out.

The unit is asked through its words and objects only. The position at t ns is t units.
"""

from collections.abc import Sequence

import pytest

from axisrig.bench.drive.axis.index_pulse import IndexPulse
from axisrig.bench.drive.axis.latch_position import LatchPosition
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.touch_probe import Encoders, TouchProbe

PROFILE = DriveProfile(input_delay_ns=0)


class Signal:
    def __init__(self, edges_ns: Sequence[int]) -> None:
        self.edges = [(t, n % 2 == 0) for n, t in enumerate(edges_ns)]
        self.level = False


class Bench:
    """Both inputs see a pulse every 1000 ns from 1100 (input 1) or 1300 ns (input 2) on.

    Input 1 rises at 1100 + 1000 k and falls at 1200 + 1000 k; input 2 at 1300 and 1400. The motor
    turns once in 10 us from 0 on: hardware mark at 90 degrees, so it passes at 2.5, 12.5 us ...
    """

    def __init__(self, profile: DriveProfile = PROFILE) -> None:
        self.image = ProcessImage()
        edges = [
            [base + 1000 * k + d for k in range(50) for d in (0, 100)] for base in (1100, 1300)
        ]
        metres = profile.lead_um * 1e-6 / 10_000
        index = IndexPulse(profile, lambda time_ns: time_ns * metres, 90.0)
        software = IndexPulse(profile, lambda time_ns: time_ns * metres, 0.0)
        self.probe = TouchProbe(
            (Signal(edges[0]), Signal(edges[1])),
            profile,
            Encoders(LatchPosition(profile, lambda time_ns: time_ns)),
            self.image,
            {5: index, 6: software},
        )

    def at(self, time_ns: int, word: int | None = None) -> int:
        self.probe.take_edges(time_ns)
        if word is not None:
            self.probe.set_function(word, time_ns)
        return self.probe.status

    @property
    def positions(self) -> tuple[int, int, int, int]:
        """60BA, 60BB, 60BC, 60BD."""
        i = self.image
        return (i.latch_1_positive, i.latch_1_negative, i.latch_2_positive, i.latch_2_negative)

    @property
    def counters(self) -> tuple[int, int, int, int]:
        """60D5, 60D6, 60D7, 60D8."""
        i = self.image
        return (i.count_1_positive, i.count_1_negative, i.count_2_positive, i.count_2_negative)


# word at 1000 ns; 60B9 at once, at 1150, 1250, 1350, 1450 ns; what is stored then
# Probe 1: bit 0 enable, 4 positive, 5 negative edge; probe 2 the same 8 bits higher
WORDS = [
    (0x0000, 0x0000, [0x0000, 0x0000, 0x0000, 0x0000], (0, 0, 0, 0)),
    (0x0001, 0x0001, [0x0001, 0x0001, 0x0001, 0x0001], (0, 0, 0, 0)),
    (0x0010, 0x0000, [0x0000, 0x0000, 0x0000, 0x0000], (0, 0, 0, 0)),
    (0x0011, 0x0001, [0x0003, 0x0003, 0x0003, 0x0003], (1100, 0, 0, 0)),
    (0x0021, 0x0001, [0x0001, 0x0005, 0x0005, 0x0005], (0, 1200, 0, 0)),
    (0x0031, 0x0001, [0x0003, 0x0007, 0x0007, 0x0007], (1100, 1200, 0, 0)),
    (0x0100, 0x0100, [0x0100, 0x0100, 0x0100, 0x0100], (0, 0, 0, 0)),
    (0x1100, 0x0100, [0x0100, 0x0100, 0x0300, 0x0300], (0, 0, 1300, 0)),
    (0x2100, 0x0100, [0x0100, 0x0100, 0x0100, 0x0500], (0, 0, 0, 1400)),
    (0x3100, 0x0100, [0x0100, 0x0100, 0x0300, 0x0700], (0, 0, 1300, 1400)),
    (0x1111, 0x0101, [0x0103, 0x0103, 0x0303, 0x0303], (1100, 0, 1300, 0)),
    (0x3131, 0x0101, [0x0103, 0x0107, 0x0307, 0x0707], (1100, 1200, 1300, 1400)),
    # bits 3..2 and 11..10: 10 = what 60D0 names (the own input at power on)
    (0x0019, 0x0001, [0x0003, 0x0003, 0x0003, 0x0003], (1100, 0, 0, 0)),
    (0x1900, 0x0100, [0x0100, 0x0100, 0x0300, 0x0300], (0, 0, 1300, 0)),
    # 01 = zero pulse of the encoder, which has not come yet
    (0x0015, 0x0001, [0x0001, 0x0001, 0x0001, 0x0001], (0, 0, 0, 0)),
    (0x1500, 0x0100, [0x0100, 0x0100, 0x0100, 0x0100], (0, 0, 0, 0)),
    # 11 is reserved: not acknowledged
    (0x001D, 0x0000, [0x0000, 0x0000, 0x0000, 0x0000], (0, 0, 0, 0)),
    (0x1D00, 0x0000, [0x0000, 0x0000, 0x0000, 0x0000], (0, 0, 0, 0)),
    (0x1D11, 0x0001, [0x0003, 0x0003, 0x0003, 0x0003], (1100, 0, 0, 0)),
    # bits 6, 7, 14, 15 are the manufacturer's and mean nothing here
    (0xC0D1, 0x0001, [0x0003, 0x0003, 0x0003, 0x0003], (1100, 0, 0, 0)),
    (0xD1C0, 0x0100, [0x0100, 0x0100, 0x0300, 0x0300], (0, 0, 1300, 0)),
]


@pytest.mark.parametrize(
    ("word", "at_once", "later", "positions"), WORDS, ids=[f"{w[0]:04X}" for w in WORDS]
)
def test_each_word(
    word: int, at_once: int, later: list[int], positions: tuple[int, int, int, int]
) -> None:
    bench = Bench()
    assert bench.at(1000, word) == at_once
    assert [bench.at(time_ns) for time_ns in (1150, 1250, 1350, 1450)] == later
    assert bench.positions == positions
    assert bench.counters == tuple(int(position > 0) for position in positions)


@pytest.mark.parametrize(("first", "second"), [(0x0031, 0x3100), (0x3131, 0x3131)])
def test_first_event_only_or_every_event(first: int, second: int) -> None:
    """Bit 1 and bit 9: five pulses, the first or the last of them is what remains."""
    for word in (first, second):
        single, continuous = Bench(), Bench()
        single.at(1000, word)
        continuous.at(1000, word | (0x0002 if word & 0x0001 else 0) | (0x0200 if word >> 8 else 0))
        assert single.at(5500) == continuous.at(5500)
        first_pulse = (1100, 1200, 1300, 1400)
        for one, every, position, count in zip(
            single.positions, continuous.positions, first_pulse, continuous.counters, strict=True
        ):
            assert (one, every, count) in ((0, 0, 0), (position, position + 4000, 5))


@pytest.mark.parametrize("shift", [0, 8])
def test_switching_off_clears_the_status_and_keeps_the_position(shift: int) -> None:
    bench = Bench()
    bench.at(1000, 0x31 << shift)
    assert bench.at(1950) == 0x07 << shift
    kept, counted = bench.positions, bench.counters
    assert bench.at(1950, 0x30 << shift) == 0
    assert (bench.positions, bench.counters) == (kept, counted)
    assert bench.at(1960, 0x31 << shift) == 0x01 << shift
    assert bench.positions == kept  # until the next edge: a trap for a careless master


@pytest.mark.parametrize("shift", [0, 8])
@pytest.mark.parametrize(("edge", "stored"), [(0x10, 0x02), (0x20, 0x04)])
def test_an_edge_bit_off_and_on_arms_that_edge_again(shift: int, edge: int, stored: int) -> None:
    bench = Bench()
    bench.at(1000, 0x31 << shift)
    assert bench.at(1950) == 0x07 << shift
    assert bench.at(1950, (0x31 ^ edge) << shift) == (0x07 ^ stored) << shift
    assert bench.at(1960, 0x31 << shift) == (0x07 ^ stored) << shift
    assert bench.at(2950) == 0x07 << shift
    assert sorted(bench.counters) == [0, 0, 1, 2]


# Sources


@pytest.mark.parametrize(("probe", "word", "own"), [(1, 0x0019, 1100), (2, 0x1900, 1300)])
@pytest.mark.parametrize("source", [1, 2, 5, 6])
def test_60d0_names_the_source(probe: int, word: int, own: int, source: int) -> None:
    """1, 2: the inputs, also crosswise; 5: mark at 90 degrees; 6: zero of the position."""
    bench = Bench()
    if probe == 1:
        bench.image.source_1 = source
    else:
        bench.image.source_2 = source
    bench.at(1000, word)
    bench.at(11_000)
    latched = bench.positions[0 if probe == 1 else 2]
    assert 0 <= latched - {1: 1100, 2: 1300, 5: 2500, 6: 10_000}[source] <= (source > 2)


def test_60d0_counts_when_the_probe_is_enabled() -> None:
    bench = Bench()
    bench.at(1000, 0x0019)
    bench.image.source_1 = 2
    bench.at(1150)
    assert bench.positions[0] == 1100


def test_a_source_that_nothing_is_wired_to_never_comes() -> None:
    bench = Bench(DriveProfile(input_delay_ns=0, trigger_sources="1 2 3 -1", source_1=3))
    assert bench.at(1000, 0x0019) == 0x0001
    assert bench.at(40_000) == 0x0001


@pytest.mark.parametrize("shift", [0, 8])
def test_another_source_arms_a_probe_anew(shift: int) -> None:
    """Bits 3..2 from the input to the zero pulse and back: each keeps its own first event."""
    bench = Bench()
    place = 2 * (shift // 8)
    bench.at(1000, 0x11 << shift)
    assert bench.at(1950) == 0x03 << shift
    assert bench.at(1950, 0x15 << shift) == 0x01 << shift
    assert bench.at(9950) == 0x03 << shift
    assert 0 <= bench.positions[place] - 2500 <= 1
    assert bench.at(9950, 0x11 << shift) == 0x01 << shift
    assert bench.at(11_950) == 0x03 << shift
    assert bench.positions[place] == (10_100 if shift == 0 else 10_300)
    assert bench.counters[place] == 3


def test_the_zero_pulse_comes_once_in_a_revolution() -> None:
    bench = Bench()
    bench.at(1000, 0x0017)  # source 01, continuous, positive
    bench.at(49_000)
    assert 0 <= bench.positions[0] - 42_500 <= 1  # the first whole nanosecond behind the mark
    assert bench.counters[0] == 5


@pytest.mark.parametrize("shift", [0, 8])
@pytest.mark.parametrize("source", [5, 6])
def test_the_zero_pulse_is_looked_for_while_a_probe_is_armed_and_in_that_time_alone(
    shift: int, source: int
) -> None:
    """Of the past a plant keeps a part only. Armed, switched off and armed again."""
    asked: list[int] = []

    def place_m(time_ns: int) -> float:
        asked.append(time_ns)
        return time_ns * 1e-6

    image = ProcessImage()
    encoders = Encoders(LatchPosition(PROFILE, lambda time_ns: time_ns))
    pulses = {source: IndexPulse(PROFILE, place_m, 90.0)}
    probe = TouchProbe((None, None), PROFILE, encoders, image, pulses)
    image.source_1 = image.source_2 = source
    for begun_ns in (3000, 23_000):
        probe.take_edges(begun_ns)
        assert asked == []
        probe.set_function(0x19 << shift, begun_ns)
        for later_ns in (500, 2000):
            probe.take_edges(begun_ns + later_ns)
        assert (min(asked), max(asked)) == (begun_ns, begun_ns + 2000)
        probe.set_function(0, begun_ns + 2000)
        asked.clear()


# Time stamps


@pytest.mark.parametrize(
    ("unit", "start", "expected"),
    [("ns", 0, 1100), ("us", 0, 1), ("ns", 2**32 - 1000, 100), ("us", 2**32 - 1, 0)],
)
def test_time_stamps_have_unit_start_and_wrap(unit: str, start: int, expected: int) -> None:
    profile = DriveProfile(
        input_delay_ns=0,
        timestamp_unit=unit,  # type: ignore[arg-type]
        timestamp_start=start,
    )
    bench = Bench(profile)
    bench.at(1000, 0x0011)
    bench.at(1150)
    assert bench.image.stamp_1_positive == expected


def test_nanoseconds_wrap_after_4295_ms() -> None:
    late_ns = 2**32 + 77
    image = ProcessImage()
    encoders = Encoders(LatchPosition(PROFILE, lambda time_ns: 0))
    probe = TouchProbe((Signal([late_ns]), None), PROFILE, encoders, image)
    probe.set_function(0x0011, 1000)
    probe.take_edges(late_ns)
    assert image.stamp_1_positive == 77


def test_each_edge_has_its_own_time_stamp() -> None:
    bench = Bench()
    bench.at(1000, 0x3131)
    bench.at(1500)
    i = bench.image
    assert (i.stamp_1_positive, i.stamp_1_negative) == (1100, 1200)
    assert (i.stamp_2_positive, i.stamp_2_negative) == (1300, 1400)
