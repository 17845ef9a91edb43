"""REF before anything says where the surface is: readings count while no axis moves."""

from collections.abc import Callable
from typing import Any

import pytest

Make = Callable[..., Any]
COUNT = 4


@pytest.fixture
def listening(make_tool_loop: Make) -> Any:
    """A loop without a kinematic and a mode, whose filter remembers some values."""
    loop = make_tool_loop()
    loop.kinematic = None
    loop.control.program(filter_type="MOVING_AVERAGE", n_cycles=COUNT)
    loop.run(10 * COUNT)
    assert loop.control3d.guide is None
    assert loop.control3d.may_reference()
    return loop


@pytest.mark.parametrize("coordinate", range(5))
def test_an_axis_that_moves_makes_what_was_read_before_worthless(
    listening: Any, coordinate: int
) -> None:
    """Without a guide it may be any of them."""
    before = listening.program
    listening.program = lambda cycle: _moved(before(cycle), coordinate)
    listening.run(2)
    assert not listening.control3d.may_reference()
    listening.run(COUNT + 1)
    assert listening.control3d.may_reference()


def _moved(place: Any, coordinate: int) -> Any:
    """The same place with one coordinate of the tool further on: X, Y, Z, C or A."""
    tcp, *turns = place
    found = [*tcp, *turns]
    found[coordinate] += 1.0
    return (tuple(found[:3]), *found[3:])


def test_axes_at_rest_let_readings_count(listening: Any) -> None:
    for _ in range(5):
        listening.run(1)
        assert listening.control3d.may_reference()
