"""When axes stand in their exact-stop windows, and when they come to rest there."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest

from axisrig.kernel.channel.path.settings import AxisSettings, CycleTiming
from axisrig.kernel.channel.path.settling import (
    REST_CYCLES,
    REST_INCREMENTS,
    REST_LIMIT_NS,
    SETTLED_CYCLES,
    Rest,
    Settling,
    Standstill,
)
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.plc.interface import PlcParticipant

MS, OFFSET_NS, WINDOW_MM = 1_000_000, 600_000, 0.01
TIMING = CycleTiming(MS, OFFSET_NS)


@dataclass
class FakeLink:
    """1000 increments make a millimetre; the set position is 0."""

    name: str = "Z"
    actual_increments: int = 0
    has_actual: bool = True

    @property
    def lag_mm(self) -> float:
        return -self.actual_increments / 1000


class Bench:
    """Cycle k is at k ms and OFFSET_NS behind its SYNC."""

    def __init__(self, *links: FakeLink, settling_ns: int = 0) -> None:
        self.now_ns, self.links = 0, links or (FakeLink(),)
        self.axes = [
            (AxisSettings(link.name, True, WINDOW_MM, settling_ns, {}), link) for link in self.links
        ]
        self.settling = Settling(self, MS)  # type: ignore[arg-type]
        self.standstill = Standstill(self, TIMING, self.axes)  # type: ignore[arg-type]

    def next(self, *places: int | None) -> None:
        """Let the next SYNC bring these places; None for a telegram that stays out."""
        self.now_ns += MS
        for link, place in zip(self.links, places, strict=True):
            link.has_actual = place is not None
            link.actual_increments = link.actual_increments if place is None else place

    def stands(self, place: int) -> bool:
        self.next(place)
        return self.settling.judge(self.axes)  # type: ignore[arg-type]

    def rest_cycle(self, *places: tuple[int | None, ...], ended: int = 0) -> int | None:
        """The cycle of the SYNC in which all rest; the set path ends before cycle `ended`."""
        for cycle, row in enumerate(places):
            self.next(*row)
            rest_ns = self.standstill.look(cycle >= ended)
            if rest_ns is not None:
                assert (rest_ns + OFFSET_NS) % MS == 0
                return (rest_ns + OFFSET_NS) // MS - 1
        return None


def test_the_settling_time_counts_from_where_somebody_waits_on() -> None:
    """Homing, an axis beside the path or a dwell takes 5 s; then there are 20 ms to settle."""
    bench = Bench(settling_ns=20 * MS)
    for _ in range(SETTLED_CYCLES + 1):
        bench.stands(0)
    bench.now_ns += 5000 * MS
    for _ in range(21):
        assert not bench.stands(100)
    with pytest.raises(Alarm) as caught:
        bench.stands(100)
    assert (caught.value.id, caught.value.values["ms"]) == (70082, 21)


def test_waiting_in_every_cycle_is_one_wait() -> None:
    """A window that is left again and again does not begin the time anew."""
    bench = Bench(settling_ns=20 * MS)
    for cycle in range(21):
        assert not bench.stands(100 * (cycle % 2))
    with pytest.raises(Alarm) as caught:
        bench.stands(100)
    assert (caught.value.id, caught.value.values["ms"]) == (70082, 21)


def test_an_axis_that_leaves_its_window_once_stands_10_cycles_after_it_has_come_back() -> None:
    """Inside for 5 cycles, outside for 1, inside again: the first 5 do not count."""
    bench = Bench()
    found = [bench.stands(place) for place in [5] * 5 + [11] + [5] * 20]
    second_entry = 6
    assert found.index(True) == second_entry + SETTLED_CYCLES == 16
    assert all(found[16:])


def test_the_settling_time_goes_on_while_the_axis_goes_in_and_out() -> None:
    bench = Bench(settling_ns=5 * MS)
    for place in [11, 5, 11, 5, 11, 5]:
        bench.stands(place)
    with pytest.raises(Alarm, match="70082"):
        bench.stands(11)


def rows(*places: int | None) -> list[tuple[int | None, ...]]:
    return [(place,) for place in places]


@pytest.mark.parametrize(
    ("places", "ended", "rests"),
    [
        ((9, 6, 4, 3, 3), 0, 3),  # 4 to 3: one increment
        ((30, 20, 13, 12, 11, 10, 9), 0, 5),  # creeping, but outside until 10
        ((5, 5, 5, 5, 5), 3, 3),  # the set path ends
        ((5, 5, 4, None, 3, 3), 4, 4),  # one telegram is missing: 4 to 3 in two cycles
        ((8, 6, None, 4, 4), 0, 4),  # 6 to 4 are two increments
        ((8, 6, 4, None, None), 0, None),
    ],
)
def test_an_axis_comes_to_rest_in_the_first_sync_with_one_increment_at_most(
    places: tuple[int | None, ...], ended: int, rests: int | None
) -> None:
    bench = Bench(FakeLink(actual_increments=40))
    assert bench.rest_cycle(*rows(*places), ended=ended) == rests


def test_the_last_of_several_axes_decides_and_a_new_path_begins_anew() -> None:
    bench = Bench(FakeLink("X"), FakeLink("Z", 8))
    assert bench.rest_cycle((0, 6), (5, 4), (9, 3), (9, 3)) == 2
    bench.next(9, 3)
    assert bench.standstill.look(False) is None


def test_an_axis_that_sways_inside_its_window_rests_after_5_s() -> None:
    bench = Bench()
    cycles = REST_LIMIT_NS // MS + 10
    sways = [((-1) ** n * 5,) for n in range(cycles)]
    assert bench.rest_cycle(*sways) == REST_LIMIT_NS // MS + 1


@pytest.mark.long
def test_an_axis_that_comes_back_to_the_path_has_all_of_its_settling_time(
    channel_bench: Callable[..., Any], words: Any
) -> None:
    """Z moves beside the path for 0.85 s while somebody waits for it, then settles from 1.25 mm:
    ln(1250) / 40 1/s = 0.18 s of 0.3.
    """
    bench = channel_bench(words.axis("Y"), words.axis("Z", settling_ns=300 * MS))
    path = bench.channel.path
    asked: list[bool] = []
    bench.channel.plc.join(PlcParticipant(lambda: asked.append(path.is_in_position())))
    beside = canon.IndependentMove(Block(1, 10, "N10"), "Z", 40.0, feed_mm_min=3000.0)
    bench.run([beside, words.end()])
    assert bench.alarm_ids == []
    assert sum(asked) > 700  # Y stands all the time


# ---- rest wherever it is


def rests_after(bench: Bench, rows: list[tuple[int, ...]]) -> int | None:
    """Cycles from the begin of a watch until all axes rest, None where they do not."""
    rest = Rest(bench, MS, bench.axes)  # type: ignore[arg-type]
    for cycle, row in enumerate(rows, 1):
        bench.next(*row)
        if rest.judge():
            return cycle
    return None


def two(*second: int) -> list[tuple[int, ...]]:
    """The first axis stands at 7; the second does this."""
    return [(7, place) for place in second]


@pytest.mark.parametrize("sign", [1, -1])
def test_axes_rest_after_50_cycles_within_two_increments_of_one_place(sign: int) -> None:
    """Flicker counts from where the time began: creeping by one increment a cycle is no rest."""
    cases: list[tuple[list[int], int | None]] = [
        ([0] * 60, REST_CYCLES),
        ([0] * 30 + [REST_INCREMENTS] * 60, REST_CYCLES),
        ([0] * 30 + [REST_INCREMENTS + 1] * 60, 31 + REST_CYCLES),
        ([0] * 49 + [9] + [0] * 60, 51 + REST_CYCLES),
        ([k // 16 for k in range(200)], None),
        ([900] * 60, 1 + REST_CYCLES),  # far from its set position
    ]
    for places, expected in cases:
        bench = Bench(FakeLink("X", 7), FakeLink("Z"))
        assert rests_after(bench, two(*(sign * place for place in places))) == expected, places


@pytest.mark.parametrize(("settling_ns", "limit_ns"), [(100 * MS, 100 * MS), (0, REST_LIMIT_NS)])
def test_an_axis_that_sways_for_its_settling_time_rests_inside_its_window(
    settling_ns: int, limit_ns: int
) -> None:
    """5 s without a settling time; outside the window it is an alarm of that axis."""
    cycles = limit_ns // MS
    for sway, ends in ((9, cycles + REST_CYCLES), (11, None)):
        bench = Bench(FakeLink("X", 7), FakeLink("Z"), settling_ns=settling_ns)
        swaying = two(*(sway * (-1) ** k for k in range(cycles + REST_CYCLES)))
        if ends is not None:
            assert rests_after(bench, swaying) == ends
            continue
        with pytest.raises(Alarm) as caught:
            rests_after(bench, swaying)
        assert (caught.value.id, caught.value.values) == (900200, {"axis": "Z", "ms": cycles + 1})
