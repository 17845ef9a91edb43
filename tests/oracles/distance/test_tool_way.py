"""Where an offset leads an inclined tool, and what that does to a loop: chains, closed forms."""

import math
from collections.abc import Mapping

import numpy as np
import pytest

from axisrig.bench.oracles.distance.lists import OF_CHANNEL, Control, as_written, axis_limits
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop, growth
from axisrig.bench.oracles.distance.model import Law, Rig, simulate
from axisrig.bench.oracles.distance.smoothing import none, of_control
from axisrig.bench.oracles.distance.stability import closed_limit, kp_limit, mean_limit
from axisrig.bench.oracles.distance.tool import (
    ACS,
    ECS,
    MCS,
    ToolWay,
    inclined_gain,
    steepest_gain,
    tcp_slopes,
)
from axisrig.bench.oracles.kinematics.chain import Chain
from axisrig.kernel.time.clock import MS

HEAD: Mapping[str, object] = {
    "kin_step[0].trafo[0].id": 9,
    "kin_step[1].trafo[0].id": 98,
    "kin_step[1].trafo[0].param[0]": 1_000_000,
    "kin_step[1].trafo[0].param[1]": 500_000,
    "kin_step[1].trafo[0].param[2]": 700_000,
    "kin_step[1].trafo[0].param[3]": 850_000,
}
ROBOT: Mapping[str, object] = {"trafo[0].id": 45} | {
    f"trafo[0].param[{k}]": v
    for k, v in {0: 500_000, 6: 4_500_000, 7: 6_000_000, 8: 6_400_000, 9: 1_000_000}.items()
}
SLOPES = [(60.0, 10.0, 1.286), (75.0, 10.0, 1.633), (60.0, 30.0, 1.732), (75.0, -10.0, 0.337)]


def head(ids: tuple[int, ...] = (9, 98)) -> Chain:
    return Chain(ids, HEAD, {}, 80.0)


def test_along_the_tool_and_along_the_normal() -> None:
    """Deviation 1.5 mm, A -35, C 20: 1.5/cos 35 along the tool, 1.5 tan 35 sideways."""
    pose, offset = np.array([[10.0, 20.0, 300.0, 20.0, -35.0]]), np.array([1.5])
    moved = ToolWay(ECS, 0, head(), 5).superposed(pose, offset)[0] - pose[0]
    assert np.linalg.norm(moved) == pytest.approx(1.8312, abs=5e-5)
    assert math.hypot(*moved[:2]) == pytest.approx(1.0503, abs=5e-5)
    assert moved == pytest.approx([-0.3592, 0.9870, 1.5, 0.0, 0.0], abs=5e-5)
    moved = ToolWay(MCS, 0, head(), 5).superposed(pose, offset)[0] - pose[0]
    assert moved == pytest.approx([0.0, 0.0, 1.5, 0.0, 0.0], abs=1e-11)
    moved = ToolWay(ACS, 2).superposed(pose, offset)[0] - pose[0]
    assert moved == pytest.approx([0.0, 0.0, 1.5, 0.0, 0.0], abs=1e-12)


@pytest.mark.long
@pytest.mark.parametrize("mode", [ECS, MCS])
def test_the_axes_of_a_robot_keep_the_orientation_of_the_tool(mode: str) -> None:
    chain, random = Chain((45,), ROBOT, {}, 80.0), np.random.default_rng(2)
    poses = np.array([0.0, 0.0, 0.0, 0.0, 80.0, 0.0]) + random.uniform(-15, 15, (20, 6))
    way = ToolWay(mode, 0, chain, 6, normal=(0.0, -0.5, math.sqrt(0.75)))
    moved = way.superposed(poses, np.full(20, 2.0))
    before, after = chain.frame(poses), chain.frame(moved)
    assert np.allclose(after[:, :3, :3], before[:, :3, :3], rtol=0, atol=1e-12)
    shift = after[:, :3, 3] - before[:, :3, 3]
    assert shift @ np.array(way.normal) == pytest.approx(np.full(20, 2.0), abs=1e-10)
    direction = chain.direction(poses) if mode == ECS else np.array([way.normal] * 20)
    assert np.cross(shift, direction) == pytest.approx(np.zeros((20, 3)), abs=1e-10)


def test_the_distance_of_an_inclined_and_extended_tool() -> None:
    """L1 80: [50; 70] at 70 deg 150.351 mm long; its distance is held at L1 cos 50."""
    pose = np.array([[0.0, 0.0, 300.0, 0.0, 35.0], [0.0, 0.0, 300.0, 90.0, 70.0]])
    share = ToolWay(ECS, 0, head(), 5).share(pose)
    assert share == pytest.approx([math.cos(math.radians(35)), math.cos(math.radians(50))])
    assert head().length_mm(head().frame(pose))[1] == pytest.approx(150.351, abs=5e-4)


@pytest.mark.parametrize(("tilt", "slope", "gain"), SLOPES)
def test_how_an_inclined_surface_changes_the_gain(tilt: float, slope: float, gain: float) -> None:
    """Cos p + sin p tan b in ECS and cos p in MCS, beside the ways of the chains themselves."""
    assert inclined_gain(ECS, tilt, slope) == pytest.approx(gain, abs=6e-4)
    pose = np.array([[0.0, 0.0, 300.0, 0.0, -tilt]])  # leans to +Y
    p = math.radians(slope)
    surface = (0.0, math.sin(p), math.cos(p))
    for mode in (ECS, MCS):
        way = ToolWay(mode, 0, head((9,)), 5)
        own = way.gain(pose, surface, along_tool=False)
        assert own == pytest.approx(inclined_gain(mode, tilt, slope), abs=1e-7)


@pytest.mark.long
@pytest.mark.parametrize(("tilt", "slope", "gain"), SLOPES)
def test_a_sensor_along_the_tool_sees_an_inclined_surface_in_another_way(
    tilt: float, slope: float, gain: float
) -> None:
    """Normalised: 1 in ECS, 1/(1 + tan p tan b) in MCS and ACS; else 1/cos b times that."""
    pose = np.array([[0.0, 0.0, 300.0, 0.0, -tilt]])  # leans to +Y
    b, p = math.radians(tilt), math.radians(slope)
    surface = (0.0, math.sin(p), math.cos(p))
    of_normal = 1.0 / (1.0 + math.tan(p) * math.tan(b))
    assert of_normal * gain == pytest.approx(math.cos(p), abs=2e-3)
    for mode, expected in ((ECS, 1.0), (MCS, of_normal), (ACS, of_normal)):
        for is_normalised, times in ((True, 1.0), (False, 1.0 / math.cos(b))):
            found = inclined_gain(mode, tilt, slope, along_tool=True, is_normalised=is_normalised)
            assert found == pytest.approx(expected * times, rel=1e-12)
            if mode == ACS:
                continue
            own = ToolWay(mode, 0, head((9,)), 5).gain(
                pose, surface, along_tool=True, is_normalised=is_normalised
            )
            assert own == pytest.approx(found, rel=1e-7)


def test_a_surface_across_the_tool_is_the_worst() -> None:
    for tilt in (30.0, 60.0, 85.0):
        gains = [inclined_gain(ECS, tilt, slope) for slope in np.linspace(-89, 89, 1781)]
        assert max(gains) == pytest.approx(steepest_gain(tilt), rel=1e-4)
        assert inclined_gain(ECS, tilt, tilt) == pytest.approx(steepest_gain(tilt))


@pytest.mark.parametrize("dead", [0, 1, 2])
@pytest.mark.parametrize("gain", [1.286, 1.732, 0.337])
def test_the_limit_of_the_constant_distance_is_divided_by_the_gain(dead: int, gain: float) -> None:
    level = Loop(CONST_DIST, dead, of_control(Control(filter_type="MOVING_AVERAGE", count=4), MS))
    inclined = Loop(CONST_DIST, dead, level.smoothing, gain=gain)
    assert kp_limit(inclined) == pytest.approx(kp_limit(level) / gain, rel=1e-6)
    assert closed_limit(inclined, 4) == pytest.approx(mean_limit(4, dead) / gain)


@pytest.mark.parametrize("mode", [CONST_DIST, SET_POS, BOTH])
def test_a_walked_loop_over_an_inclined_surface_grows_by_its_largest_pole(mode: str) -> None:
    """Sensor and tool move by different amounts: the gap by `gain` for 1 mm of the position."""
    gain, kp = 1.6, 0.3
    loop = Loop(mode, 1, none(), gain=gain)
    law, position, sent = Law(mode, Control(kp=kp), MS), [0.0, 0.0], [0.0, 0.0]
    offsets = []
    for _ in range(200):
        actual, last = position[0], sent[-1]
        wanted = -1.0 if mode == SET_POS else 1.0
        offset = law.walk(-gain * actual, actual, last, wanted)
        position, sent = [position[1], offset], [*sent, offset]
        offsets.append(offset)
    steps = np.abs(np.diff(offsets))
    late = steps[60:][steps[60:] > 1e-12]
    if len(late) > 20:
        measured = (np.max(late[-10:]) / np.max(late[:10])) ** (1.0 / (len(late) - 10))
        assert measured == pytest.approx(growth(loop, kp), abs=0.02)
    else:
        assert growth(loop, kp) < 0.7


def test_the_list_of_the_channel_is_read_with_its_own_names() -> None:
    """P-CHAN-00800 to 00827 beside the names of an axis, which do not act there."""
    listed = as_written(
        {
            "dist_ctrl[0].kp": 0.2,
            "dist_ctrl[0].max_pos": 1_500_000,
            "dist_ctrl[0].tolerance": 1000,
            "dist_ctrl[0].ref_offset": 5000,
            "dist_ctrl[0].n_cycles": 7,
            "kenngr.dist_ctrl[0].kp": 0.9,
            "getriebe[0].dynamik.a_max": 4000,
        },
        OF_CHANNEL,
    )
    assert (listed.control.kp, listed.control.count, listed.ref_offset_mm) == (0.2, 7, 0.5)
    assert listed.limits.high_mm == pytest.approx(149.9)
    assert listed.limits.a_mm_s2 == 1.0, (
        "the channel has no acceleration of an axis to fall back on"
    )


RAMPS = ("a_grenz_stufe_1", "a_grenz_stufe_2")
SPEEDS = ("vb_eilgang", "dynamik.vb_max")


@pytest.mark.parametrize(
    ("ramps", "speeds", "limits"),
    [
        # mm/s2, um/s; the lesser of each counts (P-AXIS-00005, 00006, 00209, 00212)
        ((1000.0, 2000.0), (400_000, 500_000), (400.0, 1000.0)),
        ((2000.0, 1000.0), (500_000, 400_000), (400.0, 1000.0)),
        ((None, 1500.0), (None, 300_000), (300.0, 1500.0)),
        ((1500.0, None), (300_000, None), (300.0, 1500.0)),
        ((None, None), (None, None), (math.inf, math.inf)),
    ],
)
def test_what_an_axis_may_do_is_read_from_its_list(
    ramps: tuple[float | None, ...],
    speeds: tuple[float | None, ...],
    limits: tuple[float, float],
) -> None:
    """P-AXIS-00008 counts in place of the ramps, also where it is larger."""
    written = {f"getriebe[0].lslope_profil.{n}": v for n, v in zip(RAMPS, ramps, strict=True)}
    written |= {f"getriebe[0].{n}": v for n, v in zip(SPEEDS, speeds, strict=True)}
    known = {name: value for name, value in written.items() if value is not None}
    assert axis_limits(known) == pytest.approx(limits)
    whole = {**known, "getriebe[0].dynamik.a_max": 5000}
    assert axis_limits(whole) == pytest.approx((limits[0], 5000.0))


def test_a_controller_that_changes_while_on_goes_on_from_what_it_gave() -> None:
    law = Law(CONST_DIST, Control(kp=0.5), MS)
    law.walk(-10.0, 0.0, 0.0, 12.0)
    other = Control(kp=0.1, filter_type="MOVING_AVERAGE", count=4)
    law.change(other, of_control(other, MS))
    law.walk(-14.0, 0.0, 0.0, 12.0)
    assert law.filtered_mm == pytest.approx((3 * 10.0 + 14.0) / 4)
    assert law.step_mm == pytest.approx(0.1 * (12.0 - 11.0))


def test_the_limits_of_the_axes_hold_the_law() -> None:
    law = Law(CONST_DIST, Control(kp=1.0), MS, axes=(20.0, math.inf))
    course = simulate(law, Rig(), np.zeros(5), 10.0, 12.0)
    assert np.max(course.step_mm) == pytest.approx(0.02)


def test_how_far_the_tool_moves_for_an_increment() -> None:
    """180 mm lever, 1e-4 deg: half an increment of A is 0.157 um."""
    pose = np.array([[0.0, 0.0, 300.0, 0.0, 0.0]])
    slopes = tcp_slopes(head(), pose)[0]
    assert np.linalg.norm(slopes[:, 4]) * 0.5e-4 * 1e3 == pytest.approx(0.157, abs=5e-4)


@pytest.mark.parametrize("mode", [ECS, MCS])
@pytest.mark.parametrize(
    ("normal", "height_mm"), [((0.0, 0.0, 1.0), 170.0), ((0.6, 0.0, 0.8), 133.0)]
)
def test_a_height_counts_from_the_origin_of_the_coordinate_system(
    mode: str, normal: tuple[float, float, float], height_mm: float
) -> None:
    """The clamping point (5, 60, 200), HD1 = 100 mm below the axes, over (10, 20, 30)."""
    way = ToolWay(mode, 0, head(), 5, normal, (10.0, 20.0, 30.0))
    pose = np.array([[5.0, 60.0, 300.0, 25.0, 0.0]])
    assert way.height_mm(pose) == pytest.approx([height_mm])
    plain = ToolWay(mode, 0, head(), 5, normal)
    more = float(np.dot((10.0, 20.0, 30.0), normal))
    assert plain.height_mm(pose) == pytest.approx([height_mm + more])
    assert ToolWay(ACS, 1).height_mm(pose) == pytest.approx([60.0])


@pytest.mark.parametrize(
    ("tilt_deg", "way"),
    [(0.0, 1.0), (60.0, 2.0), (84.9, 11.249), (85.0, 11.4737), (88.0, 11.4737), (90.0, 11.4737),
     (120.0, 11.4737)],
)  # fmt: skip
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_along_the_tool_the_way_grows_up_to_85_degrees(
    tilt_deg: float, way: float, side: float
) -> None:
    """1/cos b, at most 1/cos 85 = 11.474 (docs/ambiguities.md); across the normal it is 1."""
    poses = np.array([[0.0, 0.0, 300.0, 30.0, side * tilt_deg]])
    along = ToolWay(ECS, 0, head(), 5).way(poses)[0]
    assert np.linalg.norm(along) == pytest.approx(way, rel=1e-4)
    assert ToolWay(MCS, 0, head(), 5).way(poses)[0] == pytest.approx([0.0, 0.0, 1.0])


LEAN = (0.0, 0.6, 0.8)


@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), LEAN, (0.6, 0.0, 0.8)])
@pytest.mark.parametrize(("c_deg", "a_deg"), [(0.0, 0.0), (20.0, -35.0), (-100.0, 30.0)])
def test_a_distance_and_the_rates_of_axes_are_by_the_normal_of_the_surface(
    c_deg: float, a_deg: float, normal: tuple[float, float, float]
) -> None:
    """u n of the tool; X, Y and Z go by u/(u n) along the tool, by n along the normal, signed."""
    c, a = math.radians(c_deg), math.radians(a_deg)
    u = np.array([math.sin(c) * math.sin(a), -math.cos(c) * math.sin(a), math.cos(a)])
    cosine = float(u @ np.array(normal))
    pose = np.array([[10.0, 20.0, 300.0, c_deg, a_deg]])
    for mode, way in ((ECS, u / cosine), (MCS, np.array(normal))):
        found = ToolWay(mode, 0, head((9,)), 5, normal=normal)
        assert found.share(pose)[0] == pytest.approx(cosine)
        assert found.rates(pose)[0] == pytest.approx([*way, 0.0, 0.0], abs=1e-6)
    assert ToolWay(ACS, 3, normal=normal).share(pose)[0] == 1.0
    assert ToolWay(ACS, 3).rates(pose)[0] == pytest.approx([0.0, 0.0, 0.0, 1.0, 0.0])
