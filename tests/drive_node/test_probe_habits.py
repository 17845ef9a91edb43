"""What differs from drive to drive in the touch probe unit, one habit after the other.

The position at t ns is t units, so a latched value is the instant it was taken at.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from axisrig.bench.drive.axis.latch_position import LatchPosition
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.profiles import named_profile
from axisrig.bench.drive.cia402.functions.touch_probe import Encoders, TouchProbe

POS, NEG, BOTH, CONTINUOUS = 0x0011, 0x0021, 0x0031, 0x0002
US = 1000


class Signal:
    def __init__(self, edges_ns: Sequence[int]) -> None:
        self.edges = [(t, n % 2 == 0) for n, t in enumerate(edges_ns)]
        self.level = False


class Unit:
    """A touch probe unit with edges at input 1; `sync` is what a SYNC does with it."""

    def __init__(self, edges_ns: Sequence[int] = (), seed: int = 0, **habits: Any) -> None:
        profile = habits.pop("profile", DriveProfile(input_delay_ns=0))
        self.profile = replace(profile, **habits)
        self.image = ProcessImage()
        encoders = Encoders(
            LatchPosition(self.profile, lambda time_ns: time_ns),
            LatchPosition(self.profile, lambda time_ns: -time_ns),
        )
        self.probe = TouchProbe(
            (Signal(edges_ns), None), self.profile, encoders, self.image, {}, seed
        )

    def at(self, time_ns: int, word: int | None = None) -> int:
        self.probe.take_edges(time_ns)
        if word is not None:
            self.probe.set_function(word, time_ns)
        return self.probe.status

    def sync(self, time_ns: int, word: int) -> tuple[int, int, int]:
        """60B9, 60BA, 60D5 as a SYNC samples them, with the function word that acts with it."""
        self.probe.take_edges(time_ns)
        self.probe.cycle(word, time_ns)
        return self.probe.status, self.image.latch_1_positive, self.image.count_1_positive


# Input circuit


def test_jitter_lies_between_none_and_its_most_and_is_the_same_again() -> None:
    def latches(seed: int) -> list[int]:
        unit = Unit(range(1000, 1000 + 400 * 1000, 1000), seed, input_jitter_ns=300)
        unit.at(500, BOTH | CONTINUOUS)
        unit.at(500_000)
        return [t % 1000 for t in unit.probe.probes[0].latch_instants_ns]

    found = latches(7)
    assert len(found) == 400
    assert min(found) < 15
    assert 285 < max(found) <= 300
    assert 140 < sum(found) / len(found) < 160
    assert found == latches(7)
    assert found != latches(8)


def test_least_pulse_width_costs_no_delay() -> None:
    """4 us: a pulse of 3.999 us is lost, one of 4 us is latched where it began."""
    short = Unit([10_000, 13_999], profile=named_profile("lenze-i950-like"), input_delay_ns=0)
    short.at(0, BOTH)
    assert short.at(1_000_000) == 0x0001
    long = Unit([10_000, 14_000], profile=named_profile("lenze-i950-like"), input_delay_ns=0)
    long.at(0, BOTH)
    assert long.at(13_999) == 0x0001  # not known yet whether it counts
    assert long.at(18_000) == 0x0007
    assert (long.image.latch_1_positive, long.image.latch_1_negative) == (10_000, 14_000)


@pytest.mark.parametrize(("gap_us", "latched"), [(249, 1), (250, 2)])
def test_dead_time_of_a_250_us_grid(gap_us: int, latched: int) -> None:
    edges = [1_000_000, 1_000_000 + gap_us * US]
    unit = Unit(edges, profile=named_profile("lenze-i700-like"), input_delay_ns=0)
    unit.at(0, BOTH)
    unit.at(3_000_000)
    assert unit.image.count_1_positive + unit.image.count_1_negative == latched


def test_edges_less_than_2_ms_apart_are_one() -> None:
    unit = Unit(range(1_000_000, 21_000_000, 1_000_000), profile=named_profile("ax2000-like"))
    unit.at(0, BOTH | CONTINUOUS)
    unit.at(30_000_000)
    assert len(unit.probe.probes[0].latch_instants_ns) == 10


def test_compensation_takes_the_delay_back() -> None:
    unit = Unit([50_000], input_delay_ns=4 * US, delay_compensation_ns=4 * US)
    unit.at(0, POS)
    assert unit.at(53_999) == 0x0001
    assert unit.at(54_000) == 0x0003
    assert unit.image.latch_1_positive == 50_000


# Position at the latch


def line(profile: DriveProfile, motion: Any, latch_ns: int) -> int:
    return LatchPosition(profile, motion).units(latch_ns)


def test_linear_interpolation_lies_on_the_chord() -> None:
    """x = a t^2/2: the chord of T is above the parabola by a/2 (t - t0)(t1 - t)."""
    profile = DriveProfile(latch_mode="linear", grid_ns=250_000)
    acceleration = 4e-9  # units/ns2

    def motion(time_ns: int) -> int:
        return round(acceleration * time_ns * time_ns / 2)

    latch_ns = 10_000_000 + 100_000
    above = acceleration / 2 * 100_000 * 150_000
    assert abs(line(profile, motion, latch_ns) - motion(latch_ns) - above) <= 2


def test_the_chord_is_known_with_the_sample_after_the_edge() -> None:
    unit = Unit([1_010_000], latch_mode="linear", grid_ns=250_000)
    unit.at(0, POS)
    assert unit.at(1_249_999) == 0x0001
    assert unit.at(1_250_000) == 0x0003
    assert unit.image.latch_1_positive == 1_010_000


@pytest.mark.parametrize("bits", [22, 23, 26])
@pytest.mark.parametrize("direction", [1, -1])
def test_fine_encoders_at_speed_do_not_overflow(bits: int, direction: int) -> None:
    """100 rev/s; the position itself wraps at 32 bits and the latch with it."""
    profile = DriveProfile(encoder_increments=1 << bits, latch_mode="linear", grid_ns=250_000)

    def motion(time_ns: int) -> int:
        units = direction * ((1 << bits) * time_ns // 10_000_000)
        return (units + 2**31) % 2**32 - 2**31

    for latch_ns in range(1_000_000, 700_000_000, 13_337_000):
        difference = line(profile, motion, latch_ns) - motion(latch_ns)
        assert abs((difference + 2**31) % 2**32 - 2**31) <= 2


@pytest.mark.parametrize(
    ("bits", "revolutions_s", "is_wrong"), [(20, 100, False), (22, 25, False), (22, 50, True)]
)
def test_a_product_of_32_bits_overflows_from_22_bits_on(
    bits: int, revolutions_s: int, is_wrong: bool
) -> None:
    """The fault of a drive that was mended: right when slow or coarse, far off at speed."""
    profile = DriveProfile(latch_mode="linear", grid_ns=250_000, latch_bits=32)

    def motion(time_ns: int) -> int:
        return (1 << bits) * revolutions_s * time_ns // 1_000_000_000

    error = abs(line(profile, motion, 10_240_000) - motion(10_240_000))
    assert (error > 30_000) is is_wrong
    assert is_wrong or error <= 2


# Arming


def test_re_arming_by_the_enable_bit_only() -> None:
    unit = Unit(
        [1100, 1200, 2100, 2200, 3100], profile=named_profile("ep7211-like"), input_delay_ns=0
    )
    unit.at(1000, POS)
    assert unit.at(1500) == 0x0003
    assert unit.at(1500, 0x0001) == 0x0003  # the edge bit off and on again means nothing
    assert unit.at(1600, POS) == 0x0003
    assert unit.at(2500) == 0x0003
    assert unit.image.latch_1_positive == 1100
    unit.at(2600, 0)
    assert unit.at(2700, POS) == 0x0001
    assert unit.at(3200) == 0x0003
    assert unit.image.latch_1_positive == 3100


def test_a_new_edge_needs_0_first() -> None:
    unit = Unit(
        [1100, 1200, 1300, 1400], profile=named_profile("steppeonline-like"), input_delay_ns=0
    )
    unit.at(1000, POS)
    assert unit.at(1050, NEG) == 0x0001
    assert unit.at(1250) == 0x0003  # still the positive edge
    assert unit.at(1250, 0) == 0x0000
    assert unit.at(1260, NEG) == 0x0001
    assert unit.at(1350) == 0x0001
    assert unit.at(1450) == 0x0005


def test_one_edge_at_a_time() -> None:
    unit = Unit([1100, 1200], profile=named_profile("asi8100-like"), input_delay_ns=0)
    assert not unit.probe.supports(BOTH)
    assert unit.at(1000, BOTH) == 0x0000
    assert unit.at(1050, POS) == 0x0001
    assert unit.at(1300) == 0x0003


def test_source_bits_that_have_no_function() -> None:
    for source in (0x0004, 0x0008, 0x000C):
        unit = Unit([1100], profile=named_profile("ep7211-like"), input_delay_ns=0)
        assert unit.probe.supports(POS | source)
        unit.at(1000, POS | source)
        assert unit.at(1200) == 0x0003


def test_a_drive_with_one_probe() -> None:
    unit = Unit([1100], profile=named_profile("epos4-like"), input_delay_ns=0)
    assert not unit.probe.supports(0x1100)
    assert unit.at(1000, 0x1111) == 0x0001
    assert unit.probe.supports(POS | 0x0008)  # 60D0:1 is there


# What the bus shows


def test_counters_that_switching_off_clears() -> None:
    unit = Unit([1100, 1200, 1300], profile=named_profile("epos4-like"), input_delay_ns=0)
    unit.at(1000, BOTH | CONTINUOUS)
    unit.at(1500)
    assert (unit.image.count_1_positive, unit.image.count_1_negative) == (2, 1)
    unit.at(1600, 0)
    assert (unit.image.count_1_positive, unit.image.count_1_negative) == (0, 0)
    assert unit.image.latch_1_positive == 1300


def test_toggle_bits_tell_every_latch_in_continuous_mode() -> None:
    unit = Unit([1100, 1200, 1300, 1400], profile=named_profile("yaskawa-like"), input_delay_ns=0)
    unit.at(1000, BOTH | CONTINUOUS)
    seen = [unit.at(time_ns) for time_ns in (1050, 1150, 1250, 1350, 1450)]
    assert seen == [0x0001, 0x0043, 0x00C7, 0x0087, 0x0007]
    single = Unit([1100], profile=named_profile("yaskawa-like"), input_delay_ns=0)
    single.at(1000, POS)
    assert single.at(1200) == 0x0003


def test_bit_6_takes_the_second_encoder() -> None:
    for word, position in ((POS, 1100), (POS | 0x0040, -1100)):
        unit = Unit([1100], profile=named_profile("yaskawa-like"), input_delay_ns=0)
        unit.at(1000, word)
        unit.at(1200)
        assert unit.image.latch_1_positive == position


def test_the_second_encoder_is_latched_when_the_drive_is_set_so() -> None:
    unit = Unit([1100], latch_encoder="second")
    unit.at(1000, POS)
    unit.at(1200)
    assert unit.image.latch_1_positive == -1100


@pytest.mark.parametrize(
    ("habits", "armed", "stored", "value"),
    [
        ({}, 1, 4, 4),
        ({"sampling": "before_rpdo"}, 2, 4, 4),
        ({"status_delay_cycles": 1}, 2, 5, 5),
        ({"status_delay_cycles": 2}, 3, 6, 6),
        ({"value_delay_cycles": 2}, 1, 4, 6),
        ({"sampling": "before_rpdo", "status_delay_cycles": 2, "value_delay_cycles": 1}, 4, 6, 7),
    ],
)
def test_age_of_status_and_value(
    habits: dict[str, Any], armed: int, stored: int, value: int
) -> None:
    """Armed with SYNC 1, edge between SYNC 3 and 4: the SYNC that first shows each of them."""
    unit = Unit([3500], **habits)
    seen = {k: unit.sync(1000 * k, POS if k else 0) for k in range(10)}
    assert min(k for k in seen if seen[k][0] & 0x0001) == armed
    assert min(k for k in seen if seen[k][0] & 0x0002) == stored
    assert min(k for k in seen if seen[k][1] == 3500) == value
    assert min(k for k in seen if seen[k][2] == 1) == value


# Homing


@pytest.mark.parametrize("habit", ["independent", "off", "clears"])
def test_homing_forgets_all_of_a_latch_of_each_edge_or_nothing(habit: str) -> None:
    """Position, time stamp (in us here) and counter of both edges."""
    unit = Unit([1_100_000, 1_200_000, 1_300_000, 1_400_000], homing=habit)
    unit.at(1_000_000, BOTH | CONTINUOUS)
    unit.at(1_500_000)
    names = [f"{what}_1_{edge}" for what in ("latch", "stamp", "count")
             for edge in ("positive", "negative")]  # fmt: skip

    def shown() -> list[int]:
        return [getattr(unit.image, name) for name in names]

    before = shown()
    assert all(before)
    assert before[:2] == [1_300_000, 1_400_000]
    assert before[4:] == [2, 2]
    unit.probe.homing(True, 1_500_000)
    assert shown() == ([0] * 6 if habit == "clears" else before)
    unit.probe.homing(False, 1_600_000)
    assert shown() == ([0] * 6 if habit == "clears" else before)


@pytest.mark.parametrize(
    ("habit", "status", "position"),
    [("independent", 0x0003, 1100), ("probe_1_off", 0, 1100), ("off", 0, 1100), ("clears", 0, 0)],
)
def test_homing_and_the_probe(habit: str, status: int, position: int) -> None:
    unit = Unit([1100, 1200, 1300, 1400, 2100], homing=habit)
    unit.at(1000, POS)
    unit.at(1150)
    unit.probe.homing(True, 1150)
    assert unit.at(1160) == status
    assert unit.image.latch_1_positive == position
    if habit == "independent":
        return
    assert unit.at(1250, 0) == 0
    assert unit.at(1260, POS) == 0  # not while homing
    unit.probe.homing(False, 1450)
    assert unit.at(1450) == 0  # nor by itself afterwards
    unit.at(1500, 0)
    assert unit.at(1600, POS) == 0x0001
    assert unit.at(2200) == 0x0003
    assert unit.image.latch_1_positive == 2100


def test_the_encoder_of_a_probe_is_chosen_each_time_it_is_armed() -> None:
    """Bit 6 on, off, on, off: each latch is of the encoder that was asked for."""
    edges = [1100, 1200, 2100, 2200, 3100, 3200, 4100, 4200]
    unit = Unit(edges, profile=named_profile("yaskawa-like"), input_delay_ns=0)
    found = []
    for number, bit in enumerate((0x0040, 0, 0x0040, 0), 1):
        unit.at(1000 * number, POS | bit)
        unit.at(1000 * number + 500)
        found.append(unit.image.latch_1_positive)
        unit.at(1000 * number + 600, 0)
    assert found == [-1100, 2100, -3100, 4100]
