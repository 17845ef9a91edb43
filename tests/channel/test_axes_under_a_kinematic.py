"""Which axes move for a target of the tool, and where the tool actually is."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.test_path_alone import TRAFO, Walk

from axisrig.kernel.channel.path.stop_way import straight_way
from axisrig.kernel.channel.path.transformation import Transformation
from axisrig.kernel.kinematics import HeadCA
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

pytestmark = pytest.mark.interpreted


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
