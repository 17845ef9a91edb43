"""When a path is in position whose axes are led by something else, or float, for some time."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel import random_programs

from axisrig.kernel.channel import ChannelSettings, CycleTiming
from axisrig.kernel.channel.distance.offsets import Offsets
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settling import SETTLED_CYCLES
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS


class Walk:
    """X, Y and Z at 0, each with a lag of its own."""

    def __init__(self, words: Any, settling_ns: int = 0) -> None:
        axes = [words.axis(name, settling_ns=settling_ns).settings() for name in "XYZ"]
        self.links: dict[str, Any] = {name: random_programs.IdealLink(name, 0.0) for name in "XYZ"}
        self.clock: Any = SimpleNamespace(now_ns=0)
        self.path = Path(
            self.clock,
            CycleTiming(MS),
            axes,
            list(self.links.values()),
            Offsets({}),
            ChannelSettings(),
        )
        self.path.take_over((0.0, 0.0, 0.0))

    def lag(self, **lags_mm: float) -> None:
        for axis, lag_mm in lags_mm.items():
            self.links[axis].lag_mm = lag_mm

    def cycles(self, count: int, but_for: str = "") -> list[bool]:
        """Whether the path is in position, in so many cycles."""
        found = []
        for _ in range(count):
            self.clock.now_ns += MS
            assert self.path.advance() is None
            found.append(self.path.is_in_position(tuple(but_for)))
        return found


SOON = [False] * SETTLED_CYCLES + [True] * 2
"""In position from the first cycle after SETTLED_CYCLES on."""


def test_a_path_is_in_position_after_ten_cycles_and_an_axis_that_comes_back_has_its_own(
    words: Any,
) -> None:
    walk = Walk(words)
    assert walk.cycles(SETTLED_CYCLES + 2) == SOON
    walk.path.lead("Y", 0.0)
    assert walk.cycles(3) == [True] * 3  # the others stand all the time
    walk.path.release("Y")
    assert walk.cycles(SETTLED_CYCLES + 2) == SOON
    walk.path.release("Y")  # it is no other's any more
    assert walk.cycles(2) == [True] * 2


def test_an_axis_that_is_led_is_not_asked_and_one_that_is_given_back_is(words: Any) -> None:
    walk = Walk(words)
    walk.lag(Y=5.0)
    assert not any(walk.cycles(30))
    walk.path.lead("Y", 0.0)
    assert walk.cycles(SETTLED_CYCLES + 2) == SOON
    walk.path.release("Y")
    assert not any(walk.cycles(30))
    walk.lag(Y=0.0)
    assert walk.cycles(SETTLED_CYCLES + 2) == SOON


def test_an_axis_that_floats_is_not_asked_and_each_change_of_them_begins_the_time_anew(
    words: Any,
) -> None:
    walk = Walk(words)
    walk.lag(Y=5.0)
    walk.path.let_float({"Y"})
    assert walk.cycles(SETTLED_CYCLES + 2) == SOON
    walk.path.let_float({"Y"})  # the same
    assert walk.cycles(2) == [True] * 2
    walk.path.let_float({"X", "Y"})
    assert walk.cycles(SETTLED_CYCLES + 2) == SOON
    walk.path.let_float({"X"})
    assert not any(walk.cycles(30))
    walk.path.let_float(set())
    walk.lag(Y=0.0)
    assert walk.cycles(SETTLED_CYCLES + 2) == SOON


@pytest.mark.parametrize("others", ["Y", "XY", "XYZ"])
def test_axes_that_are_named_are_not_asked(words: Any, others: str) -> None:
    walk = Walk(words)
    walk.lag(Y=-5.0)
    assert walk.cycles(SETTLED_CYCLES + 2, others) == SOON
    assert not any(walk.cycles(3, others.replace("Y", "")))


@pytest.mark.parametrize("led", ["", "X", "XY", "ZX", "ZYX"])
def test_of_several_axes_that_do_not_settle_the_first_of_the_channel_is_named(
    words: Any, led: str
) -> None:
    """Whichever were led in between, and came back in whatever order."""
    walk = Walk(words, settling_ns=20 * MS)
    for axis in led:
        walk.path.lead(axis, 0.0)
    for axis in led:
        walk.path.release(axis)
    walk.lag(X=3.0, Y=4.0, Z=5.0)
    with pytest.raises(Alarm) as caught:
        walk.cycles(30)
    assert (caught.value.id, caught.value.values["axis"]) == (70082, "X")
    assert caught.value.values["lag_mm"] == "3.0000"


def test_a_path_that_moves_begins_the_time_anew(words: Any) -> None:
    walk = Walk(words)
    assert walk.cycles(SETTLED_CYCLES + 2) == SOON
    walk.path.move({"X": 0.001}, 600.0)
    assert walk.path.is_moving
    while walk.path.is_moving:
        assert walk.cycles(1) == [False]
    # The last cycle of the motion is the first one at rest
    assert walk.cycles(SETTLED_CYCLES + 1) == SOON[1:]
    assert (walk.path.is_settled, walk.path.has_stopped) == (True, True)
