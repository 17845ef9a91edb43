"""Where a path alone ends, how fast it goes back, and what is put into its buffer at once."""

import math
from itertools import pairwise
from typing import Any

import pytest
from tests.channel.test_path_alone import A_MM_S2, HEAD_MM, T_S, TRAFO, Walk

from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.dynamics import Motion

BUFFER = 4


def sent(walk: Walk, cycles: int) -> list[tuple[float, ...]]:
    """What leaves the buffer in the next cycles."""
    found = []
    for _ in range(cycles):
        assert walk.path.advance() is None
        found.append(tuple(link.set_mm for link in walk.links))
    return found


@pytest.mark.parametrize("buffer_cycles", [0, BUFFER])
def test_an_axis_that_is_put_is_sent_there_at_once(words: Any, buffer_cycles: int) -> None:
    """Nothing of its place before is left in the buffer; the other axes stay."""
    walk = Walk(words, "XYZ", buffer_cycles=buffer_cycles)
    sent(walk, 2)
    walk.path.put("X", 5.0)
    assert sent(walk, BUFFER + 2) == [(5.0, 0.0, HEAD_MM)] * (BUFFER + 2)


@pytest.mark.parametrize("buffer_cycles", [0, BUFFER])
def test_an_offset_that_is_taken_over_is_in_everything_that_is_on_its_way(
    words: Any, buffer_cycles: int
) -> None:
    """Also in what has left the interpolation and not the buffer: X creeps to its end there."""
    walk = Walk(words, "XYZ", buffer_cycles=buffer_cycles)
    plain = Walk(words, "XYZ", buffer_cycles=buffer_cycles)
    for each in (walk, plain):
        each.move(X=0.5).cycles()
    walk.path.take_offset("X", 1.5)
    found, without = sent(walk, BUFFER + 2), sent(plain, BUFFER + 2)
    assert [x for x, _, _ in found] == pytest.approx([x + 1.5 for x, _, _ in without])
    assert [rest for _, *rest in found] == [[0.0, HEAD_MM]] * (BUFFER + 2)
    assert (len({x for x, _, _ in without}) > 1) is (buffer_cycles > 0)


@pytest.mark.parametrize(
    ("target", "over", "end"),
    [
        ({"X": 10.0}, {"X": 2.0}, (12.0, 0.0)),
        ({"X": -10.0}, {"X": 2.0}, (-12.0, 0.0)),
        ({"X": 10.0}, {"X": 0.0}, (10.0, 0.0)),
        ({"X": 30.0, "Y": 40.0}, {"X": 3.0, "Y": 2.0}, (31.5, 42.0)),  # Y decides: 1/20 more
        ({"X": 30.0, "Y": 40.0}, {"X": 3.0, "Y": 8.0}, (33.0, 44.0)),  # X decides: 1/10 more
    ],
)
def test_a_run_may_go_past_its_target_by_what_the_axis_allows_that_allows_least(
    words: Any, target: dict[str, float], over: dict[str, float], end: tuple[float, float]
) -> None:
    """P-AXIS-00467, along the line; without a signal it ends there."""
    walk = Walk(words, "XYZ")
    dynamics = walk.path.dynamics(target, Motion.MEASURING, overtravel_mm=over)
    assert dynamics is not None
    walk.path.begin(target, 50.0, dynamics, overtravel_mm=over)
    walk.cycles()
    assert walk.places[-1] == pytest.approx((*end, HEAD_MM))
    plain = Walk(words, "XYZ")
    plain.path.begin(target, 50.0, dynamics)
    plain.cycles()
    expected = (target.get("X", 0.0), target.get("Y", 0.0), HEAD_MM)
    assert plain.places[-1] == pytest.approx(expected)


@pytest.mark.parametrize("before_mm_min", [6000.0, 60.0])
def test_axes_are_led_back_with_the_speed_that_is_wanted_for_it(
    words: Any, before_mm_min: float
) -> None:
    """5 mm/s, however fast the path before was; axes that are there already stay."""
    walk = Walk(words, "XYZ").move(before_mm_min, X=2.0, Y=1.0).cycles()
    walk.places = walk.places[-1:]
    walk.path.lead_back({"X": 1.0, "Y": 1.0}, 5.0)
    walk.cycles()
    assert walk.places[-1] == (1.0, 1.0, HEAD_MM)
    assert max(map(abs, walk.speeds_mm_s("X"))) == pytest.approx(5.0)
    walk.path.lead_back({"X": 1.0}, 5.0)
    assert not walk.path.is_moving


@pytest.mark.parametrize("permille", [1000, 2000])
def test_a_turn_of_the_tool_keeps_to_the_accelerations_of_its_axes_at_every_override(
    words: Any, permille: int
) -> None:
    """The ramps leave room for the speed that the override may come to, 200 % of 50 deg/s."""
    walk = Walk(words).program(TRAFO)
    walk.places = walk.places[-1:]
    walk.path.override(permille, {})
    feed_deg_min = 3000.0
    walk.path.move({"A": -80.0}, feed_deg_min)
    walk.cycles()
    for axis in "YZA":
        speeds = walk.speeds_mm_s(axis)
        changes = [abs(b - a) / T_S for a, b in pairwise(speeds)]
        assert max(changes) <= A_MM_S2 * (1.0 + 1e-3)
    fastest = max(map(abs, walk.speeds_mm_s("A")))
    radius_mm = math.dist(walk.places[0][1:3], (0.0, 0.0))
    # Centripetal R w² takes half of the acceleration at most
    most = math.degrees(math.sqrt(0.5 * A_MM_S2 / radius_mm))
    assert fastest == pytest.approx(min(feed_deg_min / 60.0 * permille / 1000.0, most), rel=1e-4)


@pytest.mark.parametrize("permille", [250, 500, 1000, 2000])
def test_an_override_is_of_the_feed_that_the_axes_can_have(words: Any, permille: int) -> None:
    """F above the largest speed counts as that: 50 % are half of it, 200 % no more than all."""
    walk = Walk(words, "XYZ", speed_max_mm_s=40.0)
    walk.path.override(permille, {})
    walk.move(60_000.0, X=100.0).cycles()
    expected = 40.0 * min(permille / 1000.0, 1.0)
    assert max(walk.speeds_mm_s("X")) == pytest.approx(expected, rel=1e-9)


def test_a_hold_of_all_that_has_gone_holds_no_path_while_an_axis_is_held(words: Any) -> None:
    """Y stays held by itself; what moves X alone begins."""
    walk = Walk(words, "XYZ")
    walk.path.feedhold(is_on=True, axes=("Y",))
    walk.path.feedhold(is_on=False, axes=("Y",))
    walk.move(X=5.0).cycles()
    assert walk.places[-1][0] == 5.0
    walk.move(Y=1.0).cycles(50)
    assert walk.path.is_held
    assert walk.places[-1][1] == 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_target_has_to_be_in_reach_with_the_offset_that_counts(words: Any, sign: float) -> None:
    """The drive reaches 10 mm to either side; 2 mm of distance control count, of X alone."""
    walk = Walk(words, "XYZ")
    offsets: Any = walk.path._offsets
    offsets.counted_mm = lambda axis: 2.0 * sign if axis == "X" else 0.0
    for link in walk.links:
        link.can_reach = lambda mm: abs(mm) <= 10.0 or mm == HEAD_MM
    walk.move(X=8.0 * sign).cycles()
    with pytest.raises(Alarm) as refused:
        walk.move(X=8.5 * sign)
    assert (refused.value.id, refused.value.values["axis"]) == (900012, "X")
    assert float(str(refused.value.values["target_mm"])) == 10.5 * sign
    walk.move(Y=9.5 * sign).cycles()
    walk.move(X=-9.5 * sign).cycles()  # the offset leads away from that end
    assert walk.places[-1][:2] == (-9.5 * sign, 9.5 * sign)
