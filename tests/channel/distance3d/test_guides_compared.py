"""When two guides are the same, which axes they have, and what lies beside the kinematic."""

import math

import pytest
from tests.kinematics.machines import MACHINES

from axisrig.kernel.channel.distance.guide import AxisGuide, StayingGuide, ToolGuide

NAMES = ("X", "Y", "Z", "C", "A", "U", "V")
KERNEL = MACHINES["9"].kernel()
UP, ORIGIN = (0.0, 0.0, 1.0), (1.0, 2.0, 3.0)
POSITIONS = (10.0, 20.0, 300.0, 20.0, -35.0, 7.0, -8.0)


def guide(**changes):
    given = {
        "mode": "MCS", "kinematic": KERNEL, "names": NAMES, "normal": UP, "origin_mm": ORIGIN,
    } | changes  # fmt: skip
    return ToolGuide(**given)


def left(of: ToolGuide, offset_mm: float = 2.0) -> StayingGuide:
    return StayingGuide(of, offset_mm, NAMES, {"Y": 0.5, "Z": 2.0, "U": -1.0})


def test_a_guide_made_again_is_the_same_and_each_other_part_makes_another() -> None:
    assert guide().is_same(guide(normal=(0.0, 0.0, 1.0), origin_mm=(1.0, 2.0, 3.0)))
    for change in (
        {"mode": "ECS"}, {"kinematic": MACHINES["9"].kernel()}, {"normal": (0.0, 0.6, 0.8)},
        {"origin_mm": (1.0, 2.0, 4.0)}, {"origin_mm": (0.0, 2.0, 3.0)},
    ):  # fmt: skip
        assert not guide().is_same(guide(**change))
        assert not guide(**change).is_same(guide())


def test_an_axis_is_the_same_guide_as_itself_only() -> None:
    assert AxisGuide("Z", 2).is_same(AxisGuide("Z", 2))
    assert not AxisGuide("Z", 2).is_same(AxisGuide("Y", 1))
    assert not AxisGuide("Z", 2).is_same(guide())
    assert not guide().is_same(AxisGuide("Z", 2))


def test_an_axis_alone_is_no_tool_that_moves_the_same_axis() -> None:
    """A kinematic of one axis moves Z too, and its offset acts through it."""
    one = guide(names=("Z",))
    assert one.axes == ("Z",)
    assert not AxisGuide("Z", 0).is_same(one)


@pytest.mark.parametrize("mode", ["MCS", "ECS"])
def test_what_stays_is_the_same_as_itself_only(mode: str) -> None:
    at = guide(mode=mode)
    stays = left(at)
    assert stays.is_same(stays)
    for other in (left(at), at, AxisGuide("Z", 2)):
        assert not stays.is_same(other)


def test_the_axes_of_a_tool_are_those_of_its_kinematic() -> None:
    assert guide().axes == ("X", "Y", "Z", "C", "A")
    assert len(guide().rates(POSITIONS)) == 5
    assert guide(names=NAMES[:5]).axes == NAMES[:5]


@pytest.mark.parametrize("mode", ["MCS", "ECS"])
@pytest.mark.parametrize("offset_mm", [1.5, -2.0, 0.0])
def test_what_does_not_move_keeps_its_bits(mode: str, offset_mm: float) -> None:
    """Rotary axes in every mode, in MCS all but Z, and always what is beside the kinematic.

    Way there and back through the kinematic rounds at some of the places.
    """
    kept = range(3, 7) if mode == "ECS" and offset_mm else (0, 1, 3, 4, 5, 6)
    for turn in range(20):
        x, y, *rest = POSITIONS
        positions = (x + 0.1 * turn, y + 0.7 * turn, *rest)
        moved = guide(mode=mode).superposed(positions, offset_mm)
        assert len(moved) == len(positions)
        assert all(moved[at] == positions[at] for at in kept)
        if mode == "MCS":
            assert moved[2] == pytest.approx(positions[2] + offset_mm, abs=1e-9)


def test_what_stays_moves_each_axis_by_its_share_also_beside_the_kinematic() -> None:
    stays = left(guide())
    for offset_mm, share in ((2.0, 1.0), (1.0, 0.5), (0.0, 0.0), (-2.0, -1.0)):
        assert stays.superposed(POSITIONS, offset_mm) == pytest.approx(
            (10.0, 20.0 + 0.5 * share, 300.0 + 2.0 * share, 20.0, -35.0, 7.0 - share, -8.0)
        )
    assert left(guide(), 0.0).superposed(POSITIONS, 1.0) == POSITIONS


def test_what_stays_has_mode_axes_and_surface_of_the_guide_before() -> None:
    at = guide(mode="ECS", normal=(0.0, 0.6, 0.8))
    stays = left(at)
    assert (stays.mode, stays.axes) == ("ECS", at.axes)
    assert stays.height_mm(POSITIONS) == at.height_mm(POSITIONS)
    assert stays.cosine(POSITIONS) == 1.0
    assert at.cosine(POSITIONS) != 1.0


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_height_counts_from_the_origin_along_the_normal(axis: int) -> None:
    normal = (0.48, 0.6, 0.64)
    moved = tuple(at + 5.0 * (k == axis) for k, at in enumerate(ORIGIN))
    heights = [guide(normal=normal, origin_mm=at).height_mm(POSITIONS) for at in (ORIGIN, moved)]
    assert heights[0] - heights[1] == pytest.approx(5.0 * normal[axis])


@pytest.mark.parametrize("a_deg", [0.0, 30.0, -60.0])
def test_in_mcs_the_normal_is_the_way_and_the_tilt_shortens_the_distance(a_deg: float) -> None:
    """The normal is Z, so that the cosine of the tilt is the third part of the direction."""
    at = (*POSITIONS[:4], a_deg, *POSITIONS[5:])
    tool = KERNEL.direction(KERNEL.forward(at[:5]))
    assert guide().cosine(at) == 1.0
    assert guide(mode="ECS").cosine(at) == pytest.approx(tool[2])
    assert guide().shortening(at) == pytest.approx(tool[2])
    assert guide(mode="ECS").shortening(at) == pytest.approx(tool[2])
    assert AxisGuide("Z", 2).shortening(at) == AxisGuide("Z", 2).cosine(at) == 1.0
    assert math.hypot(*tool) == pytest.approx(1.0)
