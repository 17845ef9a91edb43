"""Where the offset of 3D distance control leads the tool: ACS, MCS, ECS (FCT-M3 12.4.3)."""

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.channel.distance3d.programs import inclined

from axisrig.kernel.channel.distance.axis import AxisDistance
from axisrig.kernel.channel.distance.sensor import SensorSettings
from axisrig.kernel.channel.distance.settings import AxisDistanceSettings
from axisrig.kernel.distance import DistanceCommand, Source
from axisrig.kernel.kinematics import KinematicData, build
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
ROUNDING_MM = 1e-9


def test_along_the_tool_and_along_the_normal(make_tool_loop: Make, tool: Any) -> None:
    """Deviation 1.5 mm, A -35, C 20: along the tool 1.5 / cos 35 = 1.8312 mm, 1.5 tan 35 = 1.0503
    mm sideways, u = (sin C sin A, -cos C sin A, cos A): X -0.3592, Y 0.9870.
    """
    moved = {}
    for mode in ("ECS", "MCS"):
        loop = make_tool_loop(inclined(20, -35), tool.plane(height_mm=lambda _k: 1.5))
        loop.plan(mode).on(set_pos=0.0)
        moved[mode] = loop.run(4).tcp_mm[-1] - np.array((10.0, 20.0, 0.0))
    assert moved["MCS"] == pytest.approx((0.0, 0.0, 1.5), abs=ROUNDING_MM)
    assert np.linalg.norm(moved["ECS"]) == pytest.approx(1.8312, abs=5e-5)
    assert math.hypot(*moved["ECS"][:2]) == pytest.approx(1.0503, abs=5e-5)
    assert moved["ECS"] == pytest.approx((-0.3592, 0.9870, 1.5), abs=5e-5)


def test_a_head_of_minus_45_deg_leans_to_plus_y(make_tool_loop: Make, tool: Any) -> None:
    """Example 2 of FCT-M3 12.2: `A=-45`, ECS."""
    loop = make_tool_loop(inclined(0, -45), tool.plane(height_mm=lambda _k: 2.0))
    loop.plan("ECS", "Z").on(set_pos=1.0)
    moved = loop.run(4).tcp_mm[-1] - np.array((10.0, 20.0, 0.0))
    assert moved == pytest.approx((0.0, 1.0, 1.0), abs=ROUNDING_MM)


@pytest.mark.parametrize("mode", ["MCS", "ECS"])
@pytest.mark.parametrize("a", [0.0, 30.0, -60.0, 75.0])
def test_the_gain_of_the_loop_is_kp_at_every_tilt(
    make_tool_loop: Make, tool: Any, mode: str, a: float
) -> None:
    """e(k+1) = (1 - kp) e(k): one to one along the tool it would be 1 - kp cos a."""
    for law in ({"set_pos": 0.0}, {"set_dist": tool.tool_mm}):
        loop = make_tool_loop(inclined(30, a), tool.plane(height_mm=lambda _k: 2.0), kp=0.4)
        loop.plan(mode).on(**law)
        expected = [2.0 * (1 - 0.6**k) for k in range(1, 9)]
        assert loop.run(8).offsets_mm == pytest.approx(expected, abs=ROUNDING_MM)


@pytest.mark.parametrize("mode", ["MCS", "ECS"])
def test_the_surface_is_where_it_is_whatever_the_tool_does(
    make_tool_loop: Make, tool: Any, mode: str
) -> None:
    """n times clamping point less h, of the same SYNC: tilting and the offset do not show."""

    def program(cycle: int) -> Any:
        return ((cycle * 0.1, 0.0, 3.0), cycle * 2.0, -cycle * 1.5)

    loop = make_tool_loop(program, tool.plane(height_mm=lambda k: 0.7))
    loop.plan(mode).on(set_pos=0.5)
    for _ in range(30):
        loop.run(1)
        assert loop.control.surface_mm == pytest.approx(0.7, abs=ROUNDING_MM)
    assert loop.offsets_mm[-1] == pytest.approx(0.2, abs=ROUNDING_MM)


@pytest.mark.parametrize("mode", ["MCS", "ECS"])
@pytest.mark.parametrize("filter_type", ["MOVING_AVERAGE", "KALMAN_EXPO"])
def test_the_shorter_distance_of_an_inclined_tool_is_no_error(
    make_tool_loop: Make, tool: Any, mode: str, filter_type: str
) -> None:
    """The TCP stays on the surface while the tool tilts to 60 deg: h = L cos a, offset 0."""
    loop = make_tool_loop(
        lambda k: ((0.0, 0.0, 0.0), 10.0, 0.3 * k), filter_type=filter_type, n_cycles=20
    )
    loop.plan(mode).on(set_dist=tool.tool_mm)
    loop.run(200)
    assert loop.control.distance_mm == pytest.approx(80 * math.cos(math.radians(59.4)), abs=1e-6)
    assert max(map(abs, loop.offsets_mm)) < ROUNDING_MM


def test_nor_is_that_of_a_virtually_extended_tool(make_tool_loop: Make, tool: Any) -> None:
    """[30; 60] of kinematic 98: the clamping point is at L1 cos 30 above the surface."""
    written = {(1, 98, k): 1e4 * v for k, v in enumerate((0.0, 30.0, 60.0, 91.0))}
    kinematic = build(
        [9, 98], KinematicData(), written | {(0, 9, 0): 1e4 * tool.head_mm}, tool.tool_mm
    )

    def program(_cycle: int) -> Any:
        longer = tool.tool_mm * math.cos(math.radians(30)) / math.cos(math.radians(45))
        at = (longer - tool.tool_mm) * tool.turned(20, 45)
        return ((float(at[0]), float(at[1]), float(at[2])), 20.0, 45.0)

    loop = make_tool_loop(program, kinematic=kinematic)
    assert loop.plan("ECS").on(set_dist=tool.tool_mm) is None
    loop.run(5)
    distance_mm = tool.tool_mm * math.cos(math.radians(30))
    assert loop.control.distance_mm == pytest.approx(distance_mm, abs=ROUNDING_MM)
    assert max(map(abs, loop.offsets_mm)) < ROUNDING_MM


@pytest.mark.parametrize("mode", ["MCS", "ECS"])
def test_the_normal_is_that_of_the_coordinate_system(
    make_tool_loop: Make, tool: Any, mode: str
) -> None:
    """A workpiece inclined by 30 deg about X (FCT-M3 12.4.3.3), tool at 20 deg to its normal."""
    slope = math.radians(30)
    normal = np.array((0.0, -math.sin(slope), math.cos(slope)))
    origin = np.array((1.0, 2.0, 3.0))
    plane = tool.plane(normal, lambda _k: float(normal @ origin) + 5.5)
    tcp = origin + 5.0 * normal
    loop = make_tool_loop(lambda _k: (tcp, 0.0, 50.0), plane)
    loop.plan(mode, normal=tuple(normal), origin=tuple(origin)).on(set_pos=5.0)
    moved = loop.run(4).tcp_mm[-1] - tcp
    assert loop.offsets_mm[-1] == pytest.approx(0.5, abs=ROUNDING_MM)
    u = tool.turned(0, 50)
    expected = 0.5 * normal if mode == "MCS" else 0.5 / math.cos(math.radians(20)) * u
    assert moved == pytest.approx(expected, abs=ROUNDING_MM)


def test_a_frozen_offset_stays_to_the_bit_and_its_vector_turns(
    make_tool_loop: Make, tool: Any
) -> None:
    loop = make_tool_loop(
        lambda k: ((0.0, 0.0, 0.0), 5.0 * max(k - 5, 0), min(30.0 + k, 70.0)),
        tool.plane(height_mm=lambda k: 1.25 + 0.01 * k),
    )
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(5).say(DistanceCommand.FREEZE).run(60)
    assert len(set(loop.offsets_mm[5:])) == 1
    offset_mm = loop.offsets_mm[-1]
    for cycle in (10, 30, 64):
        _, c, a = loop.program(cycle)
        way = offset_mm / math.cos(math.radians(a)) * tool.turned(c, a)
        assert loop.tcp_mm[cycle] == pytest.approx(way, abs=ROUNDING_MM)


# ---- ACS


class _Link:
    """Z alone as the control of an axis sees it."""

    def __init__(self, position_mm: float) -> None:
        self.name, self.actual_mm, self.set_mm = "Z", position_mm, position_mm
        self.second_increments, self.has_second, self.second_telegram = None, False, None
        self.settings = SimpleNamespace(sensor_age_limit_ms=None, increments_per_mm=1e6)


LAWS = [
    {"kp": 0.3},
    {"kp": 0.2, "tn_s": 0.05, "tv_s": 0.002, "filter_type": "KALMAN_MA", "n_cycles": 8},
    {"kp": 0.7, "both_encoders": True, "filter_type": "LOWPASS"},
    {"kp": 1.0, "v_max_mm_s": 20.0, "a_max_mm_s2": 500.0, "filter_type": "EXPO_MEAN"},
]


@pytest.mark.parametrize("changes", LAWS)
@pytest.mark.parametrize("is_constant", [False, True])
@pytest.mark.parametrize("is_optimized", [False, True])
def test_one_axis_moves_as_its_own_control_would_move_it_bit_for_bit(
    make_tool_loop: Make, tool: Any, changes: Any, is_constant: bool, is_optimized: bool
) -> None:
    """The variable of the axis counts against the motor, that of the channel is the distance."""

    def height_mm(cycle: int) -> float:
        return 0.3 * math.sin(cycle / 9) + (0.4 if cycle > 50 else 0.0)

    def program_mm(cycle: int) -> float:
        return 80.3 + 0.002 * cycle

    set_mm = 80.0 if is_constant else 0.1
    law = {"set_dist": set_mm} if is_constant else {"set_pos": set_mm}
    loop = make_tool_loop(
        lambda k: ((0.0, 0.0, program_mm(k) - 80.0), 0.0, 0.0),
        tool.plane(height_mm=height_mm),
        kinematic=None,
        is_optimized=is_optimized,
        **changes,
    )
    loop.plan("ACS", "Z").on(**law)

    link, values = _Link(loop.links[2].actual_mm), {"S": 0.0}
    settings = AxisDistanceSettings(
        tool.wide(**changes, sensor_sign=1), SensorSettings(), is_optimized
    )
    axis = AxisDistance(link, settings, values, {}, MS)  # type: ignore[arg-type]
    axis.choose("VARIABLE", "S")
    axis.control.set_distance(set_mm)
    axis.control.set_surface(set_mm)
    command = DistanceCommand.ON_CONST_DIST if is_constant else DistanceCommand.ON
    axis.control.command(command, Source.NC)

    for cycle in range(120):
        loop.run(1)
        values["S"] = -loop.values["SENSOR"]
        axis.take()
        axis.step()
        link.set_mm = link.actual_mm = loop.base(cycle)[2] + axis.put_out()
        assert axis.control.offset_mm == loop.offsets_mm[-1]
        assert link.set_mm == loop.sent[-1][2]
        if cycle == 90:
            loop.say(DistanceCommand.OFF)
            axis.control.command(DistanceCommand.OFF, Source.NC)
    assert max(map(abs, loop.offsets_mm)) > 0.2


def test_acs_knows_of_no_inclined_tool(make_tool_loop: Make, tool: Any) -> None:
    """With a kinematic on, too: Z alone moves by the offset, whatever the tool does."""
    loop = make_tool_loop(inclined(0, 40), tool.plane(height_mm=lambda _k: 1.0))
    before = loop.base(0)
    surface_mm = before[2] - loop.plane.distance_mm(before, 0)
    loop.plan("ACS", "Z").on(set_pos=surface_mm - 0.25)
    loop.run(3)
    assert loop.sent[-1] == pytest.approx((*before[:2], before[2] + 0.25, *before[3:]), abs=1e-9)
    assert loop.control3d.moved == ("Z",)


# ---- which axes


@pytest.mark.parametrize(
    ("mode", "c", "a", "moved"),
    [
        ("MCS", 20, 35, ("Z",)),
        ("ECS", 20, 35, ("X", "Y", "Z")),
        ("ECS", 0, 35, ("Y", "Z")),
        ("ECS", 90, 35, ("X", "Z")),
        ("ECS", 45, 0, ("Z",)),
    ],
)
def test_the_axes_that_it_moves_follow_from_the_pose(
    make_tool_loop: Make, mode: str, c: float, a: float, moved: tuple[str, ...]
) -> None:
    loop = make_tool_loop(inclined(c, a))
    loop.plan(mode).on(set_pos=0.0)
    loop.run(1)
    assert loop.control3d.moved == moved


def test_an_axis_that_does_not_move_keeps_its_bits(make_tool_loop: Make, tool: Any) -> None:
    loop = make_tool_loop(inclined(20, 35), tool.plane(height_mm=lambda _k: 0.1 / 3))
    loop.plan("MCS").on(set_pos=0.0)
    loop.run(5)
    base = loop.base(0)
    for at in (0, 1, 3, 4):
        assert loop.sent[-1][at] == base[at]


def test_without_an_offset_every_position_keeps_its_bits(make_tool_loop: Make) -> None:
    loop = make_tool_loop(lambda k: ((k / 3, 0.1, 0.0), k / 7, k / 11))
    loop.plan("ECS").on(set_pos=0.0, dry_run=True)
    loop.run(20)
    assert loop.sent == [loop.base(k) for k in range(20)]
