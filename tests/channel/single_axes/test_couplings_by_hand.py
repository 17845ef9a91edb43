"""Slaves, gantries and their limits with a path by hand: who follows whom, where and how far."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.single_axes.test_coupled_dynamics import BLOCK, StandingPath

from axisrig.kernel.channel.axes.coupling import Couplings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.canon import AxisPair


class Path(StandingPath):
    """Axes with places, and offsets of distance control that the path notes."""

    def __init__(self, **places_mm: float) -> None:
        super().__init__()
        self.places_mm = places_mm
        self.offsets_mm: dict[str, float] = {}
        self.taken: list[tuple[str, float]] = []

    def position_acs_mm(self, axis: str) -> float:
        return self.places_mm[axis]

    def superposed_mm(self, axis: str) -> float:
        return self.offsets_mm.get(axis, 0.0)

    def take_offset(self, axis: str, offset_mm: float) -> None:
        self.taken.append((axis, offset_mm))

    def put_beside(self, axis: str, place_mm: float) -> None:
        self.places_mm[axis] = place_mm

    def cycle(self) -> None:
        for leader in list(self.leaders):
            leader()


class Bench:
    """X at 10, X2 at 12, X3 at 7."""

    def __init__(self) -> None:
        self.path = Path(X=10.0, X2=12.0, X3=7.0)
        self.actual_mm = {"X": 10.0, "X2": 12.0, "X3": 7.0}
        links: Any = {axis: SimpleNamespace(actual_mm=at) for axis, at in self.actual_mm.items()}
        self.links = links
        path: Any = self.path
        self.couplings = Couplings(path, links)

    def on(self, group: int, *pairs: AxisPair) -> None:
        self.couplings.switch_on(canon.AxisLinkOn(BLOCK, group, pairs))

    def off(self, group: int) -> None:
        self.couplings.switch_off(canon.AxisLinkOff(BLOCK, group))

    def places(self, x_mm: float) -> tuple[float, float]:
        """Where the slaves are after a cycle with the master at a place."""
        self.path.places_mm["X"] = x_mm
        self.path.cycle()
        return self.path.places_mm["X2"], self.path.places_mm["X3"]


@pytest.fixture
def bench() -> Bench:
    return Bench()


def pair(slave: str, limits_mm: tuple[float, float] | None = None) -> AxisPair:
    return AxisPair(slave, "X", limits_mm)


def test_a_slave_keeps_the_distance_that_it_had_when_it_was_coupled(bench: Bench) -> None:
    bench.on(1, pair("X2"))
    assert bench.places(15.0) == (17.0, 7.0)
    bench.on(2, pair("X3"))
    assert bench.places(20.0) == (22.0, 12.0)  # X3 was 8 mm behind X at 15
    bench.off(1)
    assert bench.places(30.0) == (22.0, 22.0)
    bench.off(7)  # no such group is on
    bench.on(1, pair("X2"))
    assert bench.places(31.0) == (23.0, 23.0)
    bench.couplings.end_program()
    assert bench.places(0.0) == (23.0, 23.0)
    assert bench.path.leaders == []


def test_the_slaves_of_some_axes_are_those_of_all_groups(bench: Bench) -> None:
    assert bench.couplings.slaves_of(("X",)) == {}
    bench.on(1, pair("X2"))
    bench.on(2, pair("X3"))
    assert bench.couplings.slaves_of({"X": 1.0}) == {"X2": "X", "X3": "X"}
    assert bench.couplings.slaves_of(("X2", "X3")) == {}
    bench.off(1)
    assert bench.couplings.slaves_of(("X",)) == {"X3": "X"}


def test_an_offset_of_the_master_is_taken_out_of_the_slave_and_given_back(bench: Bench) -> None:
    """It stays where it is when it begins to get the offset of its master, and when it ends."""
    bench.on(1, pair("X2"))
    assert bench.path.taken == []
    bench.path.offsets_mm["X"] = 0.5
    bench.on(2, pair("X3"))
    assert bench.path.taken == [("X3", -0.5)]
    bench.couplings.end_program()
    assert bench.path.taken[1:] == [("X2", 0.5), ("X3", 0.5)]
    bench.couplings.end_program()
    assert len(bench.path.taken) == 3


# The limits of a gantry


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("apart_mm", "alarm_id", "limit"),
    [(0.1, None, None), (0.11, 900192, "0.1"), (0.3, 900192, "0.1"), (0.31, 900193, "0.3")],
)
def test_what_has_come_apart_is_an_alarm_of_its_limit_in_both_directions(
    bench: Bench, sign: int, apart_mm: float, alarm_id: int | None, limit: str | None
) -> None:
    """X2 was 2 mm ahead when it was coupled: so much is no difference."""
    bench.on(1, pair("X2", (0.1, 0.3)))
    bench.links["X"].actual_mm = 15.0
    bench.links["X2"].actual_mm = 17.0 + sign * (apart_mm - 1e-9)
    if alarm_id is None:
        bench.couplings.watch()
        return
    with pytest.raises(Alarm) as caught:
        bench.couplings.watch()
    alarm = caught.value
    assert (alarm.id, alarm.values["axis"], alarm.values["master"]) == (alarm_id, "X2", "X")
    assert float(str(alarm.values["difference_mm"])) == pytest.approx(sign * apart_mm, abs=1e-4)
    assert alarm.values["limit_mm"] == limit


@pytest.mark.parametrize("sign", [1, -1])
def test_axes_may_come_apart_by_exactly_their_limits(bench: Bench, sign: int) -> None:
    """0.25 and 0.5 mm: at the first limit no alarm, at the second one that of the first."""
    bench.on(1, pair("X2", (0.25, 0.5)))
    bench.links["X2"].actual_mm = 12.0 + sign * 0.25
    bench.couplings.watch()
    bench.links["X2"].actual_mm = 12.0 + sign * 0.5
    with pytest.raises(Alarm) as caught:
        bench.couplings.watch()
    assert (caught.value.id, caught.value.values["limit_mm"]) == (900192, "0.25")
    bench.links["X2"].actual_mm = 12.0
    bench.couplings.watch()


def test_only_a_gantry_with_limits_is_watched(bench: Bench) -> None:
    """The second pair of the second group; a pair without limits may come apart."""
    assert not bench.couplings.watched
    bench.on(1, pair("X2"))
    assert not bench.couplings.watched
    bench.links["X2"].actual_mm = 90.0
    bench.on(2, pair("X3", (0.1, 0.3)))
    assert bench.couplings.watched
    bench.couplings.watch()
    bench.links["X3"].actual_mm = 8.0
    with pytest.raises(Alarm) as caught:
        bench.couplings.watch()
    assert caught.value.values["axis"] == "X3"
    bench.off(2)
    assert not bench.couplings.watched
    bench.couplings.watch()


@pytest.mark.parametrize("offset_mm", [2.0, -0.5])
@pytest.mark.parametrize("end", ["off", "program"])
def test_each_slave_of_what_is_parted_gets_its_own_offset_back(
    bench: Bench, offset_mm: float, end: str
) -> None:
    """One group of two; those of another group stay coupled where one group is switched off."""
    bench.on(1, pair("X2"))
    bench.on(2, pair("X3"))
    bench.path.offsets_mm["X"] = offset_mm
    if end == "off":
        bench.off(1)
        assert bench.path.taken == [("X2", offset_mm)]
        assert bench.couplings.slaves_of(("X",)) == {"X3": "X"}
        bench.off(1)  # there is none any more
        bench.off(2)
    else:
        bench.couplings.end_program()
        bench.couplings.end_program()
    assert bench.path.taken == [("X2", offset_mm), ("X3", offset_mm)]
    assert bench.couplings.slaves_of(("X",)) == {}
    assert bench.path.leaders == []
