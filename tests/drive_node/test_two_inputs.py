"""Both inputs of a drive beside each other: each has its own circuit, probe, latch and bits."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.drive.axis.index_pulse import IndexPulse
from axisrig.bench.drive.axis.latch_position import LatchPosition
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.touch_probe import Encoders, TouchProbe

BOTH_POSITIVE, BOTH_CONTINUOUS = 0x1111, 0x3333


def _unit(edges: tuple[Any, Any], seed: int = 4, **habits: Any) -> tuple[TouchProbe, ProcessImage]:
    profile, image = DriveProfile(**{"input_delay_ns": 0, **habits}), ProcessImage()
    encoders = Encoders(LatchPosition(profile, lambda time_ns: time_ns))
    signals: Any = [
        None if given is None else SimpleNamespace(
            edges=[(t, n % 2 == 0) for n, t in enumerate(given)], level=len(given) % 2 == 1
        )
        for given in edges
    ]  # fmt: skip
    unit = TouchProbe((signals[0], signals[1]), profile, encoders, image, {}, seed)
    return unit, image


def test_the_same_edges_have_another_jitter_at_the_other_input() -> None:
    edges = [1000 * number for number in range(1, 60)]
    unit, _ = _unit((edges, edges), input_jitter_ns=400)
    unit.set_function(BOTH_CONTINUOUS, 0)
    unit.take_edges(10**6)
    first, second = (probe.latch_instants_ns for probe in unit.probes)
    assert len(first) == len(second) == 59
    late = [[t - edge for t, edge in zip(of, edges, strict=True)] for of in (first, second)]
    assert max(map(max, late)) <= 400
    # Two draws of 401 values agree once in 401 times: 0.15 of 59 pairs
    assert sum(a == b for a, b in zip(*late, strict=True)) <= 2
    again, _ = _unit((edges, edges), input_jitter_ns=400)
    again.set_function(BOTH_CONTINUOUS, 0)
    again.take_edges(10**6)
    assert [probe.latch_instants_ns for probe in again.probes] == [first, second]


@pytest.mark.parametrize("wired", [(True, False), (False, True), (True, True)])
def test_an_edge_is_of_its_own_input_and_the_open_one_stays(wired: tuple[bool, bool]) -> None:
    edges = ([1000], [2000])
    there = [edges[n] if wired[n] else None for n in (0, 1)]
    unit, image = _unit((there[0], there[1]))
    unit.set_function(BOTH_POSITIVE, 0)
    assert unit.take_edges(5000)
    assert unit.status == 0x0101 | (0x0002 if wired[0] else 0) | (0x0200 if wired[1] else 0)
    assert unit.inputs == wired[0] | wired[1] << 1
    assert image.latch_1_positive == (1000 if wired[0] else 0)
    assert image.latch_2_positive == (2000 if wired[1] else 0)
    assert (image.count_1_positive, image.count_2_positive) == wired
    assert (image.latch_1_negative, image.latch_2_negative) == (0, 0)
    assert not unit.take_edges(6000)


@pytest.mark.parametrize("source", [1, 2])
def test_both_probes_may_have_one_input_as_their_source(source: int) -> None:
    """60D0 = 1 or 2 for both: one edge is stored by each, with its own edge bits."""
    unit, image = _unit(([1000, 3000], [1500, 3500]))
    image.source_1 = image.source_2 = source
    unit.set_function(0x2919, 0)  # object as source; probe 1 rising, probe 2 falling
    unit.take_edges(9000)
    place = 500 * (source - 1)
    assert (image.latch_1_positive, image.latch_2_negative) == (1000 + place, 3000 + place)
    assert (image.latch_2_positive, image.latch_1_negative) == (0, 0)
    assert unit.status == 0x0503


@pytest.mark.parametrize("number", [0, 1])
def test_one_probe_switched_off_and_on_leaves_the_other_as_it_is(number: int) -> None:
    edges = [1000, 2000, 5000, 6000]
    unit, image = _unit((edges, edges), counters_cleared_on_disarm=True, toggle_bits=True)
    unit.set_function(0x3333, 0)
    unit.take_edges(3000)
    other = 0x3333 & ~(0xFF << 8 * number)
    unit.set_function(other, 3000)
    counts = [image.count_1_positive, image.count_2_positive]
    assert counts == [int(number != 0), int(number != 1)]
    assert unit.status >> 8 * number & 0xFF == 0
    assert unit.status >> 8 * (1 - number) & 0xFF == 0x07 | 0xC0  # both stored, toggled once
    unit.set_function(0x3333, 4000)
    unit.take_edges(9000)
    own, kept = unit.probes[number], unit.probes[1 - number]
    assert [latch.count for latch in own.latches.values()] == [1, 1]
    assert [latch.count for latch in kept.latches.values()] == [2, 2]
    assert kept.status == 0x07
    assert own.status == 0x07 | 0xC0


@pytest.mark.parametrize(
    "habits",
    [
        {},
        {"status_delay_cycles": 2},
        {"value_delay_cycles": 2},
        {"sampling": "before_rpdo"},
        {"status_delay_cycles": 1, "value_delay_cycles": 1, "counters_cleared_on_disarm": True},
    ],
)
def test_power_takes_what_a_late_drive_has_still_to_show(habits: dict[str, Any]) -> None:
    """Status, positions, stamps and counters of both are 0 at once, and stay so."""
    unit, image = _unit(([1000, 1500], [1200, 1700]), **habits)
    for time_ns in range(0, 12_000, 1000):
        unit.take_edges(time_ns)
        unit.cycle(0x3333, time_ns)
    names = [
        f"{name}_{number}_{edge}"
        for name in ("latch", "stamp", "count")
        for number in (1, 2)
        for edge in ("positive", "negative")
    ]
    assert all(getattr(image, name) for name in names)
    assert unit.status == 0x0707
    unit.reset()
    for time_ns in (12_000, 13_000, 14_000, 15_000):
        assert unit.status == 0
        assert unit.function == 0
        assert [getattr(image, name) for name in names] == [0] * len(names)
        unit.take_edges(time_ns)
        unit.cycle(0, time_ns)


@pytest.mark.parametrize("number", [0, 1])
def test_counters_are_cleared_by_switching_off_and_not_by_switching_on(number: int) -> None:
    edges = [1000, 1500, 5000, 6000]
    unit, _ = _unit((edges, edges), counters_cleared_on_disarm=True)
    probe, bits = unit.probes[number], 0x13 << 8 * number
    unit.set_function(bits, 0)
    unit.take_edges(2000)
    assert probe.latches[True].count == 1
    unit.set_function(bits ^ 0x02 << 8 * number, 3000)  # single event now: it stays enabled
    assert probe.latches[True].count == 1
    unit.set_function(0, 3000)
    assert probe.latches[True].count == 0
    assert probe.latches[True].units == 1000
    unit.set_function(bits, 4000)
    unit.take_edges(9000)
    assert probe.latches[True].count == 1


@pytest.mark.parametrize("is_cleared", [True, False])
@pytest.mark.parametrize("number", [0, 1])
def test_another_source_of_a_probe_that_stays_on_leaves_its_counter(
    number: int, is_cleared: bool
) -> None:
    """By 60D0 to the other input; switching off clears the counter, where a drive does so."""
    unit, image = _unit(([1000, 1500], [5000, 6000]), counters_cleared_on_disarm=is_cleared)
    probe, own, other = unit.probes[number], number + 1, 2 - number
    edge_ns = {1: 1000, 2: 5000}
    image.source_1 = image.source_2 = own
    unit.set_function(0x19 << 8 * number, 0)
    unit.take_edges(10_000)
    assert (probe.latches[True].count, probe.latches[True].units) == (1, edge_ns[own])
    image.source_1 = image.source_2 = other
    unit.set_function(0x19 << 8 * number | 0x02 << 8 * number, 20_000)
    assert probe.latches[True].count == 1
    assert unit.status >> 8 * number & 0x07 == 0x01  # on, and armed anew
    unit.set_function(0, 20_000)
    assert probe.latches[True].count == (0 if is_cleared else 1)


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("speed_m_s", [0.5, -0.5])
@pytest.mark.parametrize("edges", ["both", "positive"])
def test_the_zero_pulse_has_a_falling_edge_where_the_drive_takes_one(
    edges: Any, speed_m_s: float, number: int
) -> None:
    """One increment of 1 um of a turn of 10 mm; probe 2 is at rest, or the other way round."""
    profile = DriveProfile(encoder_increments=10_000, index_edges=edges)

    def motion(time_ns: int) -> float:
        return 0.0251 + speed_m_s * time_ns * 1e-9

    encoders = Encoders(LatchPosition(profile, lambda time_ns: round(motion(time_ns) * 1e6)))
    image = ProcessImage()
    index = {5: IndexPulse(profile, motion)}
    unit = TouchProbe((None, None), profile, encoders, image, index)
    unit.set_function(0x35 << 8 * number, 0)  # enabled, zero pulse, both edges
    unit.take_edges(15_000_000)  # 7.5 mm on: one mark
    stored = unit.status >> 8 * number
    assert stored == (0x07 if edges == "both" else 0x03)
    mark_um = 30_000 if speed_m_s > 0 else 20_000
    probe = unit.probes[number]
    assert probe.latches[True].units == pytest.approx(mark_um, abs=1)
    falling = probe.latches[False].units
    assert falling == (pytest.approx(mark_um, abs=1) if edges == "both" else 0)
    assert unit.probes[1 - number].latches[True].count == 0
