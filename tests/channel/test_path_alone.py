"""The path of a channel by itself over ideal drives: ramps of curves, holds of axes, overrides."""

import math
from collections.abc import Mapping
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel import random_programs

from axisrig.kernel.channel import ChannelSettings, CycleTiming
from axisrig.kernel.channel.distance.offsets import Offsets
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.stop_way import straight_way
from axisrig.kernel.time.clock import MS

A_MM_S2, T_S = 600.0, 1e-3
HEAD_MM = 80.0


class Walk:
    """A path, and where its axes were in each cycle."""

    def __init__(
        self, words: Any, names: str = "XYZCA", *, buffer_cycles: int = 0, **more: Any
    ) -> None:
        axes = [words.axis(name, a_mm_s2=A_MM_S2, **more).settings() for name in names]
        self.names = names
        start = tuple(HEAD_MM if name == "Z" else 0.0 for name in names)
        links: list[Any] = [
            random_programs.IdealLink(n, mm) for n, mm in zip(names, start, strict=True)
        ]
        clock: Any = SimpleNamespace(now_ns=0)
        self.clock = clock
        settings = ChannelSettings(override_max_permille=2000)
        self.links = links
        timing = CycleTiming(MS, buffer_cycles=buffer_cycles)
        self.path = Path(clock, timing, axes, links, Offsets({}), settings)
        self.path.take_over(start)
        self.places = [start]

    def cycles(self, count: int = 10**6) -> "Walk":
        """Go so many cycles, or until the path stands."""
        for _ in range(count):
            if not self.path.is_moving:
                break
            self.clock.now_ns += MS
            assert self.path.advance() is None
            self.places.append(self.path.interpolator.positions_mm)
        return self

    def program(self, text: str) -> "Walk":
        for command in random_programs.commands_of(text, tuple(self.names), self.path):
            random_programs.begin(self.path, command)
            self.cycles()
        return self

    def move(self, feed_mm_min: float | None = 6000.0, **target_mm: float) -> "Walk":
        self.path.move(target_mm, feed_mm_min)
        return self

    def speeds_mm_s(self, axis: str) -> list[float]:
        index = self.names.index(axis)
        return [(b[index] - a[index]) / T_S for a, b in pairwise(self.places)]

    def has_moved(self, axis: str) -> float:
        index = self.names.index(axis)
        return self.places[-1][index] - self.places[0][index]


TRAFO = "V.G.WZ_AKT.L = 80\n#TRAFO [9]\nG1 F6000 X0 Y0 Z0 C0 A0\n"


def test_a_slow_turn_of_the_tool_has_nearly_all_of_the_acceleration_of_the_axes(
    words: Any,
) -> None:
    """F600 turns A by 10 degrees a second about the TCP; Y and Z go round it with radius R.

    Their centripetal part is R (pi/18)^2, 2.4 of 600 mm/s2 for 80 mm: the feed comes within v R/a.
    """
    walk = Walk(words).program(TRAFO)
    radius_mm = math.dist(walk.places[-1][1:3], (0.0, 0.0))
    walk.places = walk.places[-1:]
    walk.path.move({"A": -60.0}, 600.0)
    walk.cycles(60)
    a_deg_s = [abs(v) for v in walk.speeds_mm_s("A")]
    assert max(a_deg_s) == pytest.approx(10.0, rel=1e-6)
    reached = next(n for n, v in enumerate(a_deg_s) if v > 10.0 * (1.0 - 1e-6))
    rise_s = math.radians(10.0) * radius_mm / A_MM_S2
    assert reached == pytest.approx(rise_s / T_S, rel=0.02, abs=1.0)


@pytest.mark.parametrize("permille", [500, 1000, 2000])
def test_a_slow_arc_has_nearly_all_of_the_acceleration_of_the_axes(
    words: Any, permille: int
) -> None:
    """10 degrees of radius 20 mm at 10 mm/s: centripetal 5 (at 200 % 20) of 600 mm/s2."""
    walk = Walk(words, "XYZ")
    walk.path.override(permille, {})
    x, y = 20.0 - 20.0 * math.cos(math.radians(10.0)), 20.0 * math.sin(math.radians(10.0))
    walk.program(f"G17 G2 F600 X{x:.9f} Y{y:.9f} I20 J0")
    speeds = [math.hypot(x, y) for x, y in zip(*map(walk.speeds_mm_s, "XY"), strict=True)]
    wanted = permille / 100.0
    assert max(speeds) == pytest.approx(wanted, rel=1e-4)
    reached = next(n for n, v in enumerate(speeds) if v > wanted * (1.0 - 1e-4))
    assert reached == pytest.approx(wanted / A_MM_S2 / T_S, rel=0.02, abs=1.5)


# Holds of axes by themselves


def test_a_hold_of_an_axis_holds_paths_that_move_it_and_goes_with_it(words: Any) -> None:
    """On, off, on another one: what was held before does not hold what comes later."""
    walk = Walk(words, "XYZ")
    path = walk.path
    path.feedhold(is_on=False, axes=("X",))
    walk.move(X=5.0).cycles(200)
    assert walk.has_moved("X") == 0.0
    assert path.is_held
    path.feedhold(is_on=False)
    walk.cycles()
    assert walk.has_moved("X") == 5.0
    assert [on for _, on in path.holds] == [True, False]
    path.feedhold(is_on=False)
    walk.move(X=7.0)
    assert not path.is_held
    assert walk.cycles(1).places[-1][0] != 5.0
    walk.cycles()
    assert [on for _, on in path.holds] == [True, False]
    path.feedhold(is_on=False, axes=("Y",))
    walk.move(X=9.0).cycles()
    assert walk.has_moved("X") == 9.0
    walk.move(Y=1.0, X=10.0).cycles(100)
    assert path.is_held
    path.feedhold(is_on=False, axes=("Z",))
    walk.cycles()
    assert (walk.has_moved("X"), walk.has_moved("Y")) == (10.0, 1.0)


def test_a_hold_of_all_stays_while_that_of_an_axis_comes_and_goes(words: Any) -> None:
    walk = Walk(words, "XYZ")
    path = walk.path
    walk.move(600.0, X=20.0).cycles(50)
    for is_on, axes, stands in (
        (True, (), True),
        (True, ("Y",), True),
        (False, ("Y",), False),
        (False, ("X", "Y"), True),
        (True, ("X",), True),
        (False, ("X",), True),
        (False, (), False),
    ):
        path.feedhold(is_on=is_on, axes=axes)
        walk.cycles(60)
        moved = walk.places[-1] != walk.places[-2]
        assert moved is not stands, (is_on, axes)


# Overrides


@pytest.mark.parametrize(
    ("courses", "expected_mm_s"),
    [
        ([(1000, {"X": 400}), (1000, {})], 50.0),  # 0.1 %: back at 100 % is taken
        ([(1000, {"X": 400}), (1000, {"Y": 100})], 50.0),  # Y does not move
        ([(1000, {}), (500, {"X": 400})], 10.0),
        ([(500, {}), (1000, {})], 50.0),
        ([(1000, {}), (3000, {})], 100.0),  # P-CHAN-00056 is 200 %
        ([(2000, {}), (2000, {"X": 500})], 50.0),
        ([(1000, {"X": 900, "Y": 100}), (1000, {"X": 900})], 45.0),
    ],
)
def test_the_last_override_is_the_one_that_counts(
    words: Any, courses: list[tuple[int, Mapping[str, int]]], expected_mm_s: float
) -> None:
    walk = Walk(words, "XYZ").move(3000.0, X=200.0)
    for permille, axes in courses:
        walk.path.override(permille, axes)
        walk.cycles(300)
    assert walk.speeds_mm_s("X")[-1] == pytest.approx(expected_mm_s, rel=1e-9)
    walk.cycles()
    walk.places = walk.places[-1:]
    walk.move(3000.0, X=0.0).cycles(400)  # the next path begins with it
    assert walk.speeds_mm_s("X")[-1] == pytest.approx(-expected_mm_s, rel=1e-9)


# Who leads


def test_an_axis_that_something_else_leads_is_given_back_where_it_is(words: Any) -> None:
    walk = Walk(words, "XYZ")
    path = walk.path
    steps = iter([0.0003, 0.0009, 0.0015, 0.0018])  # 300 mm/s2
    path.leaders.append(lambda: path.lead("Y", next(steps)))
    walk.move(X=1.0).cycles(4)
    path.leaders.clear()
    walk.cycles()
    assert (path.position_acs_mm("X"), path.position_acs_mm("Y")) == (1.0, 0.0018)
    path.release("Y")
    walk.move(Y=1.5, X=2.0).cycles()
    assert (walk.has_moved("X"), walk.has_moved("Y")) == (2.0, 1.5)


@pytest.mark.parametrize("offset_mm", [5.0, -0.3])
def test_an_axis_that_has_taken_an_offset_over_stands_also_for_its_own_stop(
    words: Any, offset_mm: float
) -> None:
    """An alarm of the next cycle takes it off the path: its last set positions are no speed."""
    walk = Walk(words, "XYZ").move(X=1.0).cycles()
    for _ in range(3):  # it stands
        assert walk.path.advance() is None
    walk.path.take_offset("X", offset_mm)
    ramp = walk.path.own_ramp("X", at_once=False)
    assert ramp.is_standing
    assert ramp.advance() == pytest.approx(1.0 + offset_mm)


def test_what_is_superposed_on_an_axis_is_no_part_of_its_set_position(words: Any) -> None:
    """It is put to where it stands, 12 mm with 2 mm of distance control: 10 of the path."""
    walk = Walk(words, "XYZ")
    offsets: Any = SimpleNamespace(superposed_mm=lambda axis: 2.0 if axis == "X" else 0.0)
    walk.path._offsets = offsets
    walk.path.put("X", 12.0)
    walk.path.put("Y", 12.0)
    assert (walk.path.position_acs_mm("X"), walk.path.position_acs_mm("Y")) == (10.0, 12.0)


def test_what_a_run_to_a_stop_sees_from_the_tool_is_without_a_superposed_offset(words: Any) -> None:
    """Under a kinematic steps are those of the tool; 2 mm of distance control on Z are none."""
    walk = Walk(words).program(TRAFO)
    links: list[Any] = list(walk.path._links)
    way = straight_way(walk.path, links, {"Z": -5.0})
    assert way.sent is not None
    tool = way.sent()
    assert tool == pytest.approx(tuple(walk.path.position_mm().values()))
    offsets: Any = SimpleNamespace(superposed_mm=lambda axis: 2.0 if axis == "Z" else 0.0)
    walk.path._offsets = offsets
    links[2].set_mm += 2.0
    assert way.sent() == pytest.approx(tool)
