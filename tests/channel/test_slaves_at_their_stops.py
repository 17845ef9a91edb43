"""When a path is in position whose axes have slaves: inside the window, or at rest at a stop."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.path.settings import AxisSettings
from axisrig.kernel.channel.path.settling import REST_CYCLES
from axisrig.kernel.channel.path.slaves import PathWithSlaves
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS

WINDOW_MM = 0.01


class Slaves:
    """A path with two slaves, 1000 increments a millimetre, whose set positions are 0."""

    def __init__(self) -> None:
        self.now_ns, self.in_position, self.asked = 0, True, [()]
        self.links: Any = [SimpleNamespace(actual_increments=0, lag_mm=0.0) for _ in "UV"]
        path: Any = SimpleNamespace(
            travelled_mm=12.5, has_stopped=True, is_in_position=self._is_in_position
        )
        axes = [AxisSettings(name, True, WINDOW_MM, 0, {}) for name in "UV"]
        self.path = PathWithSlaves(path, zip(axes, self.links, strict=True), self, MS)  # type: ignore[arg-type]

    def _is_in_position(self, besides: Any) -> bool:
        self.asked.append(tuple(besides))
        return self.in_position

    def cycle(self, *increments: int) -> bool:
        self.now_ns += MS
        for link, place in zip(self.links, increments, strict=True):
            link.actual_increments, link.lag_mm = place, -place / 1000
        return self.path.is_in_position()


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("second", [False, True])
def test_a_slave_that_is_off_its_place_has_to_rest_on_either_side(side: int, second: bool) -> None:
    """In its window, 10 increments, it counts at once; beyond it moves first, then rests.

    It is at its place in the last cycle of its motion, so that one cycle less is missing then.
    """
    at = Slaves()

    def cycle(place: int) -> bool:
        return at.cycle(*((0, side * place) if second else (side * place, 0)))

    assert cycle(0)
    assert cycle(10)
    for place in range(100, 20, -10):  # it comes nearer, so that it is no rest
        assert not cycle(place)
    rests = [cycle(30) for _ in range(REST_CYCLES + 2)]
    assert rests == [False] * (REST_CYCLES - 1) + [True] * 3
    assert cycle(10)


def test_the_rest_of_a_slave_counts_from_where_the_path_is_in_position() -> None:
    """And anew after each time in which it is not; the path is asked for its slaves too."""
    at = Slaves()
    at.in_position = False
    assert not any(at.cycle(30, 0) for _ in range(REST_CYCLES + 5))
    at.in_position = True
    assert not any(at.cycle(30, 0) for _ in range(REST_CYCLES - 1))
    at.in_position = False
    assert not at.cycle(30, 0)
    at.in_position = True
    assert not any(at.cycle(30, 0) for _ in range(REST_CYCLES - 1))
    assert [at.cycle(30, 0) for _ in range(3)] == [False, True, True]
    assert set(at.asked[1:]) == {("U", "V")}
    assert (at.path.travelled_mm, at.path.has_stopped) == (12.5, True)


def test_a_slave_that_sways_off_its_place_is_an_alarm_after_its_time() -> None:
    """5 s without a settling time."""
    at = Slaves()
    for cycle in range(5001):
        assert not at.cycle(0, -30 - 10 * (cycle % 2))
    with pytest.raises(Alarm) as caught:
        at.cycle(0, -40)
    assert (caught.value.id, caught.value.values["axis"]) == (900200, "V")
    assert caught.value.values["ms"] == 5001


def test_a_slave_off_its_place_waits_for_the_rest_of_the_other_one_too() -> None:
    """The second one sways by 5 increments inside its window: over 2, so that it does not rest."""
    at = Slaves()
    for cycle in range(2 * REST_CYCLES):
        assert not at.cycle(30, 5 * (-1) ** cycle)
    rests = [at.cycle(30, -5) for _ in range(REST_CYCLES)]
    assert rests == [False] * (REST_CYCLES - 1) + [True]
