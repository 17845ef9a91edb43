"""Where the offset of 3D distance control acts: what a choice refuses, warns of and shows."""

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.distance3d.programs import inclined
from tests.kinematics.machines import MACHINES

from axisrig.kernel.channel.distance.diagnosis import diagnosis
from axisrig.kernel.channel.distance.guide import AxisGuide, StayingGuide, ToolGuide
from axisrig.kernel.distance import DistanceCommand, DistanceState
from axisrig.kernel.distance.limiter import UNLIMITED, AxesAllow
from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import HeadCA, KinematicData, build
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
INCLINED = (0.0, 0.6, 0.8)
OTHER_GUIDE, TOO_STEEP, OTHER_LENGTH = 900462, 900463, 900464


@pytest.mark.parametrize("is_optimized", [True, False])
def test_an_offset_that_another_guide_would_lead_elsewhere_is_named_as_it_is(
    make_tool_loop: Make, tool: Any, is_optimized: bool
) -> None:
    """In mm, to 1e-6: MCS with a #CS that another one has replaced."""
    loop = make_tool_loop(
        inclined(20, 35), tool.plane(height_mm=lambda _k: 1.23456789), is_optimized=is_optimized
    )
    loop.plan("MCS").on(set_pos=0.0)
    loop.run(4).say(DistanceCommand.FREEZE).run(1)
    loop.plan(normal=INCLINED)
    with pytest.raises(Alarm) as refused:
        loop.on(set_pos=0.0)
    assert refused.value.id == OTHER_GUIDE
    assert refused.value.values["offset_mm"] == 1.234568
    assert refused.value.values["mode"] == "MCS"


def test_an_offset_counts_until_the_axes_are_without_it(make_tool_loop: Make, tool: Any) -> None:
    """Without P-CHAN-00818 its last part is sent in the cycle after the control is off."""
    loop = make_tool_loop(
        inclined(20, 35), tool.plane(height_mm=lambda _k: 1.0), is_optimized=False
    )
    loop.plan("MCS").on(set_pos=0.0)
    loop.run(3).say(DistanceCommand.OFF)
    while loop.control.state is not DistanceState.INACTIVE:
        loop.run(1)
    assert loop.control.offset_mm == 0.0
    assert loop.control3d.output_mm != 0.0
    loop.plan(normal=INCLINED)
    with pytest.raises(Alarm) as refused:
        loop.on(set_pos=0.0)
    assert refused.value.id == OTHER_GUIDE
    loop.run(1)
    loop.on(set_pos=0.0)
    assert loop.control3d.guide.normal == INCLINED


@pytest.mark.parametrize(("actual_deg", "is_refused"), [(84.9, False), (85.1, True), (-85.1, True)])
def test_the_actual_tilt_decides_whether_a_tool_leans_too_much(
    make_tool_loop: Make, actual_deg: float, is_refused: bool
) -> None:
    """The program has it upright already, or leaning still."""
    for programmed_deg in (0.0, 89.0):
        loop = make_tool_loop(inclined(0, programmed_deg))
        loop.run(2)
        loop.links[4].actual_mm = actual_deg
        loop.plan("ECS")
        if not is_refused:
            loop.on(set_pos=0.0)
            continue
        with pytest.raises(Alarm) as refused:
            loop.on(set_pos=0.0)
        assert refused.value.id == TOO_STEEP
        assert refused.value.values["angle_deg"] == abs(actual_deg)


def test_what_it_moves_is_known_as_soon_as_it_is_on(make_tool_loop: Make) -> None:
    """In the cycle of the command, and not with the next look."""
    loop = make_tool_loop(inclined(0, 35), limits=[AxesAllow(100.0 + k, 1e4) for k in range(5)])
    loop.plan("MCS").run(2)
    assert loop.control3d.moved == ("Z",)
    loop.plan("ECS").on(set_pos=0.0)
    assert loop.control3d.moved == ("Y", "Z")
    assert loop.control3d.allowed.v_mm_s == pytest.approx(
        min(101.0 / math.tan(math.radians(35)), 102.0)
    )
    other = make_tool_loop(inclined(0, 35))
    other.plan("MCS").run(2)
    other.plan("ACS", "X").on(set_pos=0.0)
    assert other.control3d.moved == ("X",)


def test_axes_that_the_kinematic_has_belong_to_it_in_every_pose(make_tool_loop: Make) -> None:
    """Upright MCS moves Z alone: an error of A ends the control all the same, not one of U."""
    loop = make_tool_loop()
    loop.plan("MCS").on(set_pos=0.0)
    loop.run(2)
    assert loop.control3d.moved == ("Z",)
    for axes, belongs in ((["A"], True), (["X", "U"], True), (["U"], False), ([], False)):
        assert loop.control3d.may_move(axes) is belongs


def test_without_a_kinematic_nothing_limits_the_offset_any_more(make_tool_loop: Make) -> None:
    loop = make_tool_loop(inclined(20, 35), limits=[AxesAllow(2.0, 30.0)] * 5)
    loop.plan("ECS").run(2)
    assert loop.control3d.allowed != UNLIMITED
    assert loop.control3d.axes_share < 1.0
    loop.kinematic = None
    loop.run(1)
    assert loop.control3d.guide is None
    assert (loop.control3d.allowed, loop.control3d.moved) == (UNLIMITED, ())
    assert loop.control3d.axes_share == 1.0


@pytest.mark.parametrize("share", ["v", "a"])
def test_the_share_of_the_axes_is_that_of_speed_or_acceleration(
    make_tool_loop: Make, share: str
) -> None:
    """Upright, one mm of Z for one mm: v_max 50 mm/s and a_max 400 mm/s2 of the list."""
    limits = [AxesAllow(20.0, 1e6) if share == "v" else AxesAllow(1e3, 100.0)] * 5
    loop = make_tool_loop(limits=limits, v_max_mm_s=50.0, a_max_mm_s2=400.0)
    loop.plan("MCS").run(2)
    assert loop.control3d.axes_share == pytest.approx(0.4 if share == "v" else 0.25)


class Refusing(HeadCA):
    """A head that refuses every pose on the way back to its axes."""

    def inverse(self, *_: Any) -> Any:
        raise Alarm(292016, name="HEAD", pose="X 0", reason="a test")


def test_a_pose_without_a_way_for_the_offset_may_move_every_axis(
    make_tool_loop: Make, tool: Any
) -> None:
    """So all of them count as moved while the kinematic refuses the pose."""
    loop = make_tool_loop(kinematic=Refusing((tool.head_mm,), tool.tool_mm))
    loop.plan("MCS")
    loop.control3d.look()
    assert loop.control3d.moved == ("X", "Y", "Z", "C", "A")


# ---- warnings of the length


def test_a_set_distance_other_than_the_tool_warns_only_where_it_acts_on_a_tool(
    make_tool_loop: Make,
) -> None:
    """80 mm are the tool. SET_POS, ACS and a control that is frozen or off have nothing of it."""
    loop = make_tool_loop()
    assert loop.control3d.set_distance(70.0) is None  # off
    loop.plan("MCS")
    assert loop.on(set_pos=0.0) is None  # follows a surface
    assert loop.control3d.set_distance(60.0) is None
    loop.run(1).say(DistanceCommand.FREEZE)
    assert loop.control3d.set_distance(61.0) is None
    warning = loop.on(set_dist=61.0)
    assert warning.id == OTHER_LENGTH
    assert loop.control3d.set_distance(61.0) is None  # no change
    warning = loop.control3d.set_distance(62.5)
    assert (warning.id, warning.values["set_dist_mm"], warning.values["length_mm"]) == (
        OTHER_LENGTH, "62.5", "80",
    )  # fmt: skip
    assert loop.control3d.set_distance(80.0) is None
    axis = make_tool_loop()
    axis.plan("ACS", "Z")
    assert axis.on(set_dist=33.0) is None
    assert axis.control3d.set_distance(34.0) is None


def test_the_length_of_a_warning_is_that_of_the_tool_without_its_extension(
    make_tool_loop: Make, tool: Any
) -> None:
    """[30; 60] of kinematic 98 makes it longer from 30 degrees on: 80 cos 30/cos 45 at 45."""
    written = {(1, 98, k): 1e4 * v for k, v in enumerate((0.0, 30.0, 60.0, 91.0))}
    written[0, 9, 0] = 1e4 * tool.head_mm
    kinematic = build([9, 98], KinematicData(), written, tool.tool_mm)
    loop = make_tool_loop(inclined(20, 45), kinematic=kinematic)
    warning = loop.plan("ECS").on(set_dist=79.0)
    shown = warning.values["set_dist_mm"], warning.values["length_mm"]
    assert shown == ("79", f"{tool.tool_mm:g}")
    longer_mm = tool.tool_mm * math.cos(math.radians(30)) / math.cos(math.radians(45))
    assert kinematic.length_mm(kinematic.forward(loop.base(0))) == pytest.approx(longer_mm)


# ---- the guide itself


def test_each_part_of_a_guide_makes_it_another_one() -> None:
    kernel, other = MACHINES["9"].kernel(), MACHINES["9"].kernel()
    names, up, zero = ("X", "Y", "Z", "C", "A"), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)
    first = ToolGuide("MCS", kernel, names, up, zero)
    assert first.is_same(ToolGuide("MCS", kernel, names, up, zero))
    for different in (
        ToolGuide("ECS", kernel, names, up, zero),
        ToolGuide("MCS", other, names, up, zero),
        ToolGuide("MCS", kernel, names, (0.0, 0.6, 0.8), zero),
        ToolGuide("MCS", kernel, names, up, (1.0, 0.0, 0.0)),
        ToolGuide("MCS", kernel, names, up, (0.0, 1.0, 0.0)),
        ToolGuide("MCS", kernel, names, up, (0.0, 0.0, 1.0)),
        AxisGuide("Z", 2),
    ):
        assert not first.is_same(different)
        assert not different.is_same(first)
    assert AxisGuide("Z", 2).is_same(AxisGuide("Z", 2))
    assert not AxisGuide("Z", 2).is_same(AxisGuide("Y", 1))
    stays, again = (StayingGuide(first, 1.0, names, {"Z": 1.0}) for _ in range(2))
    assert stays.is_same(stays)
    assert not stays.is_same(again)


def test_the_height_counts_from_each_coordinate_of_the_origin() -> None:
    """n times (clamping point - origin), upright tool of 80 mm: it is 80 below the pivot + 100."""
    names, n = ("X", "Y", "Z", "C", "A"), (0.48, 0.6, 0.64)
    kernel = HeadCA((100.0,), 80.0)
    at = (11.0, 22.0, 333.0, 0.0, 0.0)
    guide = ToolGuide("MCS", kernel, names, n, (1.0, 2.0, 3.0))
    assert guide.height_mm(at) == pytest.approx(0.48 * 10.0 + 0.6 * 20.0 + 0.64 * 230.0)


@pytest.mark.parametrize("offset_mm", [1.5, -1.5, 0.75, 0.0])
def test_an_offset_that_stays_moves_each_axis_by_its_share(offset_mm: float) -> None:
    names = ("X", "Y", "Z", "C", "A", "U")
    left = ToolGuide("ECS", HeadCA((100.0,), 80.0), names, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
    stays = StayingGuide(left, 1.5, names, {"Y": 0.9, "Z": -1.2})
    at = (1.0, 2.0, 3.0, 40.0, 89.0, 6.0)
    share = offset_mm / 1.5
    moved = (1.0, 2.0 + 0.9 * share, 3.0 - 1.2 * share, 40.0, 89.0, 6.0)
    assert stays.superposed(at, offset_mm) == pytest.approx(moved)
    assert stays.cosine(at) == 1.0
    nothing = StayingGuide(left, 0.0, names, {})
    assert nothing.superposed(at, offset_mm) == at


# ---- each cycle


@pytest.mark.parametrize("is_optimized", [True, False])
def test_an_offset_whose_kinematic_goes_while_it_changes_goes_on_by_its_share(
    make_tool_loop: Make, tool: Any, is_optimized: bool
) -> None:
    """It is frozen by then: what was sent last stays on the axes, in their share of the offset."""
    loop = make_tool_loop(
        inclined(20, 35), tool.plane(height_mm=lambda k: 0.5 * k), is_optimized=is_optimized, kp=0.5
    )
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(6)
    before_mm, deltas = loop.control3d.output_mm, dict(loop.control3d.deltas_mm)
    loop.kinematic = None
    loop.say(DistanceCommand.FREEZE).run(1)
    share = loop.control3d.output_mm / before_mm
    assert set(deltas) == {"X", "Y", "Z"}
    assert loop.control3d.deltas_mm == pytest.approx({n: share * d for n, d in deltas.items()})
    assert (share == 1.0) is is_optimized


def test_the_pose_of_now_says_where_an_axis_is_and_what_moves(make_tool_loop: Make) -> None:
    """The tool tilts after ON: Y comes to what moves, and the base goes on with the program."""
    loop = make_tool_loop(lambda k: ((0.1 * k, 0.0, 0.0), 0.0, 0.0 if k < 5 else 30.0))
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(4)
    assert loop.control3d.moved == ("Z",)
    loop.run(4)
    assert loop.control3d.moved == ("Y", "Z")
    base = loop.base(loop.cycle - 1)
    for at, axis in enumerate("XYZCA"):
        found = loop.control3d.positions_of(axis)
        assert found.base_mm == base[at]
        assert found.superposed_mm == pytest.approx(loop.sent[-1][at], abs=1e-9)


@pytest.mark.parametrize("mode", ["MCS", "ECS"])
def test_a_reference_waits_for_the_motion_of_any_axis_under_a_tool(
    make_tool_loop: Make, mode: str
) -> None:
    loop = make_tool_loop(
        lambda k: ((0.01 * k, 0.0, 0.0), 0.0, 0.0), filter_type="MOVING_AVERAGE", n_cycles=5
    )
    loop.plan(mode).run(20)
    assert not loop.control3d.may_reference()


@pytest.mark.parametrize(("age", "is_silent"), [(0, False), (3, False), (4, True)])
def test_a_value_of_the_plc_that_is_too_old_ends_3d_control(
    make_tool_loop: Make, age: int, is_silent: bool
) -> None:
    """It comes with a period of one cycle, and may be three periods old."""
    refreshed = SimpleNamespace(period_ns=MS, age_cycles=0)
    loop = make_tool_loop(refreshed={"SENSOR": refreshed})
    loop.plan("MCS").on(set_pos=0.0)
    loop.run(2)
    refreshed.age_cycles = age
    if not is_silent:
        loop.run(1)
        return
    with pytest.raises(Alarm) as silent:
        loop.run(1)
    assert silent.value.id == 900314
    assert silent.value.values["source"] == "VARIABLE V.E.SENSOR"
    assert loop.control.state is DistanceState.ERROR


def test_the_diagnosis_has_an_active_axis_only_while_the_control_is_on(
    make_tool_loop: Make,
) -> None:
    """Numbers of axes count from 0, and 0 is shown where there is none."""
    loop = make_tool_loop()
    loop.plan("ACS", "Z").run(2)
    names = ("active_mode", "active_ax_idx", "new_mode", "new_ax_idx")

    def shown() -> tuple[str, ...]:
        found = dict(diagnosis(loop.control3d, is_awaited=False))
        return tuple(found[name] for name in names)

    assert shown() == ("OFF(0)", "0", "ACS(1)", "2")
    loop.on(set_pos=80.0)
    loop.run(1)
    assert shown() == ("ACS(1)", "2", "ACS(1)", "2")
    loop.say(DistanceCommand.OFF, no_move=True)
    loop.control3d.hand_over()
    loop.run(1)
    assert shown() == ("OFF(0)", "0", "ACS(1)", "2")
