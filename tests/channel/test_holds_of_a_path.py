"""When a path is held, what is noted of it, and what its axes may do beside it."""

from itertools import pairwise
from typing import Any

import pytest
from tests.channel.test_path_alone import A_MM_S2, T_S, Walk

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

BLOCK = Block(1, 10, "N10")


def test_each_begin_and_each_end_of_a_hold_is_noted_once(words: Any) -> None:
    walk = Walk(words, "XYZ").move(600.0, X=50.0)
    path, expected = walk.path, []
    for is_on in (True, False, True, False, True, False):
        walk.cycles(20)
        for _ in range(3):
            path.feedhold(is_on=is_on)
        expected.append((walk.clock.now_ns, is_on))
        assert path.holds == expected
    assert not walk.cycles().path.is_held
    assert walk.has_moved("X") == 50.0


def test_a_hold_of_a_path_at_rest_keeps_the_next_one_at_its_start(words: Any) -> None:
    walk = Walk(words, "XYZ")
    path = walk.path
    path.feedhold(is_on=True)
    assert not path.is_held  # nothing is kept from its end
    walk.move(X=1.0).cycles(30)
    assert (path.is_held, walk.has_moved("X")) == (True, 0.0)
    path.feedhold(is_on=False)
    assert not path.is_held
    walk.cycles()
    assert (path.is_held, walk.has_moved("X")) == (False, 1.0)
    assert [is_on for _, is_on in path.holds] == [True, False]


def test_an_axis_that_is_held_behind_its_path_holds_nothing_yet(words: Any) -> None:
    """The last path moved X and is over: a hold of X is none of the next one, which moves Y."""
    walk = Walk(words, "XYZ").move(X=1.0).cycles()
    path = walk.path
    path.feedhold(is_on=False, axes=("X",))
    assert (path.holds, path.interpolator.is_held) == ([], False)
    walk.move(Y=2.0).cycles()
    assert (walk.has_moved("Y"), path.holds) == (2.0, [])
    walk.move(X=2.0).cycles(30)
    assert (walk.has_moved("X"), path.is_held) == (1.0, True)
    assert [is_on for _, is_on in path.holds] == [True]
    path.feedhold(is_on=False)
    walk.cycles()
    assert (walk.has_moved("X"), path.is_held) == (2.0, False)
    assert [is_on for _, is_on in path.holds] == [True, False]


@pytest.mark.parametrize("is_on", [True, False])
def test_beside_a_held_axis_the_hold_of_the_channel_counts_for_paths_of_others(
    words: Any, is_on: bool
) -> None:
    """It came while the path stood, with that of Y; X is moved."""
    walk = Walk(words, "XYZ")
    walk.path.feedhold(is_on=is_on, axes=("Y",))
    walk.move(X=1.0).cycles(300)
    assert walk.has_moved("X") == (0.0 if is_on else 1.0)
    walk.path.feedhold(is_on=False, axes=("Y",))
    walk.cycles()
    assert walk.has_moved("X") == 1.0


@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
def test_each_axis_may_have_the_acceleration_that_a_program_gives_it(words: Any, axis: str) -> None:
    """Twice that of its list, for feed blocks; without the weight it is that of the list again."""
    walk = Walk(words, "XYZ")
    index = "XYZ".index(axis)
    for share in (2.0, 1.0):
        walk.path.programmed.weigh(canon.DynamicWeights(BLOCK, "acceleration", {axis: share}))
        before = walk.places[-1][index]
        walk.places = walk.places[-1:]
        walk.move(3000.0, **{axis: before + 20.0}).cycles()  # no cycle is refused
        speeds = walk.speeds_mm_s(axis)
        most = max(abs(b - a) / T_S for a, b in pairwise(speeds))
        assert most == pytest.approx(share * A_MM_S2, rel=1e-6)


@pytest.mark.parametrize("axis", ["X", "Y"])
def test_an_axis_that_stops_at_once_stops_where_it_was_sent_last(words: Any, axis: str) -> None:
    """At its full speed: that it stands from one cycle to the next is no step of its own."""
    walk = Walk(words, "XYZ").move(None, **{axis: 500.0}).cycles(200)
    path, index = walk.path, "XYZ".index(axis)
    last_mm = walk.places[-1][index]
    assert last_mm - walk.places[-2][index] > 0.0
    ramp = path.own_ramp(axis, at_once=True)
    assert ramp.is_standing
    path.leaders.append(lambda: path.put_off_path(axis, ramp.advance()))
    for _ in range(3):
        assert path.advance() is None
        assert path.interpolator.positions_mm[index] == pytest.approx(last_mm, abs=1e-12)
