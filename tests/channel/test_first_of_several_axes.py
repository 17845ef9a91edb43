"""Of several axes: which one is named, which take part, and where the tool actually is."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.single_axes.test_independent_by_hand import SETTLED
from tests.channel.single_axes.test_independent_by_hand import Bench as Beside
from tests.channel.test_path_alone import TRAFO, Walk
from tests.channel.test_power_and_watch import TIMING, Drive

from axisrig.kernel.channel.path.monitor import POWER_UP_CYCLES_MAX, PowerUp
from axisrig.kernel.channel.path.stop_way import straight_way
from axisrig.kernel.channel.path.transformation import Transformation
from axisrig.kernel.drives.power import Power
from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import HeadCA
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

pytestmark = pytest.mark.interpreted


@pytest.mark.parametrize(
    ("late", "named"), [("XZ", "X"), ("YZ", "Y"), ("Z", "Z"), ("XYZ", "X"), ("Y", "Y")]
)
def test_of_drives_that_do_not_come_the_first_of_the_channel_is_named(
    late: str, named: str
) -> None:
    """With its own state; the others are in operation, or are late too."""
    drives: Any = [
        Drive(
            name,
            power=Power.OFF if name in late else Power.OPERATING,
            state_name=f"state of {name}",
        )
        for name in "XYZ"
    ]
    power_up = PowerUp(drives, TIMING)
    for _ in range(POWER_UP_CYCLES_MAX):
        assert not power_up.step()
    with pytest.raises(Alarm) as caught:
        power_up.step()
    assert caught.value.id == 900008
    assert caught.value.values == {
        "axis": named, "state": f"state of {named}", "ms": 2 * (POWER_UP_CYCLES_MAX + 1),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("target", "moved"),
    [
        ({"Z": -5.0}, ("Z",)),  # the tool is upright: nothing else moves
        ({"X": 3.0, "Z": -5.0}, ("X", "Z")),
        ({"Y": 2.0}, ("Y",)),
        ({"A": 20.0}, ("Y", "Z", "A")),  # about the tool centre point
        ({"C": 20.0, "X": 1.0}, ("X", "C")),
    ],
)
def test_under_a_kinematic_the_axes_that_the_tool_wants_move_and_no_others(
    words: Any, target: dict[str, float], moved: tuple[str, ...]
) -> None:
    walk = Walk(words).program(TRAFO)
    links: list[Any] = [SimpleNamespace(name=name, set_mm=0.0) for name in "XYZCA"]
    way = straight_way(walk.path, links, target)
    assert tuple(way.moved) == moved
    assert way.sent is not None


def test_without_a_kinematic_the_axes_of_the_block_move(words: Any) -> None:
    walk = Walk(words)
    way = straight_way(walk.path, [], {"X": 3.0, "Y": 4.0})
    assert (tuple(way.moved), way.length_mm, way.sent) == (("X", "Y"), 5.0, None)


def test_the_tool_is_where_its_axes_actually_are() -> None:
    """Their set positions are upright; A lags by 30 degrees. Without a kinematic nothing is known.

    Each choice is noted with its cycle, and the end of one that is on alone.
    """
    clock: Any = SimpleNamespace(now_ns=4)
    links: Any = [
        SimpleNamespace(name=name, set_mm=0.0, actual_mm=30.0 if name == "A" else 0.0)
        for name in "XYZCA"
    ]
    found = Transformation(clock, [*links, SimpleNamespace(name="W", set_mm=7.0, actual_mm=8.0)])
    assert found.state() == (None, None)
    found.end()
    assert found.choices == []
    chosen = canon.KinematicChoice(Block(1, 10, "N10"), HeadCA((), 80.0), ids=(9,))
    found.choose(chosen)
    assert found.state() == (pytest.approx(30.0), 80.0)
    links[4].actual_mm = -45.0
    assert found.state() == (pytest.approx(45.0), 80.0)
    assert found.coordinates((1.0, 2.0, 83.0, 0.0, 0.0, 9.0)) == (1.0, 2.0, 3.0, 0.0, 0.0, 9.0)
    clock.now_ns = 6
    found.end()
    assert found.choices == [(4, chosen), (6, None)]
    assert found.coordinates((1.0, 2.0)) == (1.0, 2.0)


@pytest.mark.parametrize(
    ("place", "shown"), [(None, "line 2, block N20"), ("line 9, block N90", "line 9, block N90")]
)
def test_an_alarm_of_a_run_beside_the_path_keeps_the_place_that_it_has(
    place: str | None, shown: str
) -> None:
    bench = Beside()
    bench.go(measuring_type=1)
    bench.cycle(SETTLED)
    bench.measured.alarm = Alarm(900003, place=place, axis="X", others="Y")
    with pytest.raises(Alarm) as caught:
        bench.axes.step()
    assert (caught.value.id, caught.value.place) == (900003, shown)
