"""Functions of 60B8 that a drive lacks, and what a probe forgets with the power."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.drive.axis.index_pulse import IndexPulse
from axisrig.bench.drive.axis.latch_position import LatchPosition
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.touch_probe import Encoders, TouchProbe
from axisrig.bench.drive.cia402.functions.units import Units
from axisrig.kernel.time.clock import MS

ENABLE, POSITIVE, NEGATIVE, CONTINUOUS = 0x01, 0x10, 0x20, 0x02
INDEX, OBJECT, SECOND = 0x04, 0x08, 0x40


def unit(
    edges: tuple[tuple[int, ...], tuple[int, ...]] = ((), ()),
    *,
    has_second: bool = False,
    **habits: Any,
) -> tuple[TouchProbe, ProcessImage]:
    """A unit whose encoders show the time, the second one with the other sign."""
    profile, image = DriveProfile(**{"input_delay_ns": 0, **habits}), ProcessImage()
    encoders = Encoders(
        LatchPosition(profile, lambda time_ns: time_ns),
        LatchPosition(profile, lambda time_ns: -time_ns) if has_second else None,
    )
    signals: Any = [
        SimpleNamespace(edges=[(t, n % 2 == 0) for n, t in enumerate(each)], level=False)
        for each in edges
    ]
    return TouchProbe((signals[0], signals[1]), profile, encoders, image, {}, 1), image


def enabled(bits: tuple[int, int], **given: Any) -> tuple[bool, bool]:
    """Whether each probe is on after a function word with these bytes."""
    made, _ = unit(**given)
    word = bits[0] | bits[1] << 8
    assert made.supports(word) is all(made.probes[n].supports(bits[n]) for n in (0, 1))
    made.set_function(word, 0)
    first, second = (probe.is_enabled for probe in made.probes)
    return first, second


USUAL = ENABLE | POSITIVE


@pytest.mark.parametrize(
    ("bits", "given", "on"),
    [
        # Bit 6 needs a second encoder where it chooses one, and says nothing elsewhere
        ((USUAL | SECOND, USUAL), {"latch_encoder": "function_bit"}, (False, True)),
        ((USUAL, USUAL | SECOND), {"latch_encoder": "function_bit"}, (True, False)),
        ((USUAL | SECOND, USUAL | SECOND),
         {"latch_encoder": "function_bit", "has_second": True}, (True, True)),
        ((USUAL | SECOND, USUAL | SECOND), {}, (True, True)),
        # What 60D0 names needs 60D0 of the same probe
        ((USUAL | OBJECT, USUAL | OBJECT), {"lacks": "60D0.2"}, (True, False)),
        ((USUAL | OBJECT, USUAL | OBJECT), {"lacks": "60D0.1"}, (False, True)),
        ((USUAL | OBJECT, USUAL | OBJECT), {"lacks": "60D0"}, (False, False)),
        ((USUAL | OBJECT, USUAL | OBJECT), {}, (True, True)),
        # Both bits of the source are none
        ((USUAL | INDEX | OBJECT, USUAL | INDEX), {}, (False, True)),
        ((USUAL | INDEX | OBJECT, USUAL), {"source_bits": "ignored"}, (True, True)),
        # One edge at a time, or both
        ((USUAL | NEGATIVE, USUAL), {"probe_edges": "one"}, (False, True)),
        ((ENABLE | NEGATIVE, USUAL | NEGATIVE), {"probe_edges": "one"}, (True, False)),
        ((USUAL | NEGATIVE, USUAL | NEGATIVE), {}, (True, True)),
        # A drive with one probe
        ((USUAL, USUAL), {"lacks": "60BC"}, (True, False)),
        ((USUAL, 0), {"lacks": "60BC"}, (True, False)),
    ],
)  # fmt: skip
def test_what_a_drive_cannot_do_leaves_its_probe_off_and_the_other_one_on(
    bits: tuple[int, int], given: dict[str, Any], on: tuple[bool, bool]
) -> None:
    assert enabled(bits, **given) == on


@pytest.mark.parametrize("number", [0, 1])
def test_the_dead_time_of_a_probe_ends_with_the_power(number: int) -> None:
    """5 ms after a latch at 1 ms; power at 2 ms, and an edge at 3 ms is the first one."""
    edges = (1 * MS, 1 * MS + 500_000, 3 * MS)
    made, image = unit((edges, edges), dead_time_ns=5 * MS)
    word = (ENABLE | CONTINUOUS | POSITIVE) << 8 * number
    made.set_function(word, 0)
    made.take_edges(2 * MS)
    name = f"latch_{number + 1}_positive"
    assert getattr(image, name) == 1 * MS
    made.reset()
    assert getattr(image, name) == 0
    made.set_function(word, 2 * MS)
    made.take_edges(4 * MS)
    assert getattr(image, name) == 3 * MS


@pytest.mark.parametrize("feed", [1000, 1 << 20, 1 << 24])
@pytest.mark.parametrize("turns", [3000, -3000, 200, -200, 1, 0])
def test_the_second_encoder_wraps_at_32_bits(feed: int, turns: int) -> None:
    """60E4 is INTEGER32: 3000 turns of 2^20 are 0xBB80 0000 of it."""
    image = ProcessImage()
    image.set_defaults(DriveProfile())
    image.second_increments, image.second_revolutions, image.feed = 1 << 20, 1, feed
    units = Units(DriveProfile(), image)
    wanted = (turns * feed + 0x8000_0000) % (1 << 32) - 0x8000_0000
    increments = (turns * (1 << 20) + 0x8000_0000) % (1 << 32) - 0x8000_0000
    if increments == turns * (1 << 20):  # else the encoder itself has wrapped before
        assert units.second_units(turns * 0.01) == wanted
    assert units.increments(turns * 0.01) == increments


@pytest.mark.parametrize("feed", [10_000, 2_000_000])
def test_home_is_gone_with_a_coarser_and_with_a_finer_unit(feed: int) -> None:
    """And stays where the unit is the same by other numbers."""
    image = ProcessImage()
    image.set_defaults(DriveProfile())
    units = Units(DriveProfile(), image)
    units.set_home(0.5, 1234)
    image.feed, image.feed_shaft = image.feed * 2, image.feed_shaft * 2
    units.update()
    assert (units.is_homed, units.position_units(0.5)) == (True, 1234)
    image.feed, image.feed_shaft = feed, 1
    units.update()
    assert (units.is_homed, units.origin_units, units.home_units) == (False, 0, 0)
    assert units.position_units(0.5) == 50 * feed


# Homing and the probes


@pytest.mark.parametrize(
    ("habit", "stay_on", "are_kept"),
    [
        ("independent", (True, True), True),
        ("probe_1_off", (False, True), True),
        ("off", (False, False), True),
        ("clears", (False, False), False),
    ],
)
def test_homing_takes_of_each_probe_what_the_habit_says(
    habit: str, stay_on: tuple[bool, bool], are_kept: bool
) -> None:
    """Off, and with the last habit position, stamp and counter of each edge too."""
    edges = ((1000, 2000, 11_000, 12_000), (1500, 2500, 11_500, 12_500))
    made, image = unit(edges, homing=habit)
    word = 0x3131
    made.set_function(word, 0)
    made.take_edges(5000)
    names = [
        f"{what}_{number}_{edge}" for what in ("latch", "stamp", "count") for number in (1, 2)
        for edge in ("positive", "negative")
    ]  # fmt: skip
    before = {name: getattr(image, name) for name in names}
    assert all(before.values())
    made.homing(True, 6000)
    assert tuple(probe.is_enabled for probe in made.probes) == stay_on
    after = {name: getattr(image, name) for name in names}
    assert after == (before if are_kept else dict.fromkeys(names, 0))
    made.homing(False, 7000)
    assert tuple(probe.is_enabled for probe in made.probes) == stay_on  # until a new word
    made.set_function(0, 8000)
    made.set_function(word, 9000)
    assert tuple(probe.is_enabled for probe in made.probes) == (True, True)
    made.take_edges(20_000)
    assert (image.latch_1_positive, image.latch_2_positive) == (11_000, 11_500)


def test_all_who_watch_the_latches_are_called_at_each_change() -> None:
    made, _ = unit(((1000,), ()))
    called = [0, 0, 0]

    def watch(number: int) -> Any:
        def note() -> None:
            called[number] += 1

        return note

    made.watches += [watch(number) for number in range(3)]
    made.set_function(USUAL, 0)
    armed = called[0]
    assert armed > 0
    made.take_edges(2000)
    assert called[0] > armed
    assert called == [called[0]] * 3


@pytest.mark.parametrize("looks", [1, 2, 5])
def test_a_zero_pulse_is_latched_once_however_often_the_drive_looks(looks: int) -> None:
    """A revolution of 10 mm in 10 ms; every event is taken."""
    profile, image = DriveProfile(input_delay_ns=0), ProcessImage()
    pulse = IndexPulse(profile, lambda time_ns: time_ns * 1e-9 + 1e-3)
    encoders = Encoders(LatchPosition(profile, lambda time_ns: time_ns))
    made = TouchProbe((None, None), profile, encoders, image, {5: pulse}, 1)
    made.set_function(ENABLE | CONTINUOUS | POSITIVE | INDEX, 0)
    counts = []
    for number in range(1, 31):
        for _ in range(looks):
            made.take_edges(number * MS)
        counts.append(image.count_1_positive)
    # The mark at 10 mm is there after 9 ms, then each 10 ms
    assert [counts.index(wanted) + 1 for wanted in (1, 2, 3)] == [9, 19, 29]
    assert counts[-1] == 3
