"""What limits the offset of 3D distance control, what it watches, and what it refuses."""

import itertools
import math
from collections.abc import Callable
from typing import Any

import pytest
from tests.channel.distance3d.programs import inclined

from axisrig.kernel.channel.distance.offsets import Offsets
from axisrig.kernel.distance import DistanceCommand, DistanceState
from axisrig.kernel.distance.limiter import AxesAllow
from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import HeadCA, KinematicData, build

Make = Callable[..., Any]
SECONDS = 1e-3  # a cycle


def axis_limits(tool: Any, **known: tuple[float, float]) -> list[AxesAllow]:
    return [AxesAllow(*known.get(name, (1e9, 1e12))) for name in tool.names]


def steps(loop: Any) -> list[float]:
    offsets = [0.0, *loop.offsets_mm]
    return [b - a for a, b in itertools.pairwise(offsets)]


# ---- limits


@pytest.mark.parametrize("mode", ["MCS", "ECS"])
def test_v_max_and_a_max_limit_the_offset_itself(
    make_tool_loop: Make, tool: Any, mode: str
) -> None:
    """10 mm/s and 1000 mm/s2: 0.001 mm more in each cycle up to 0.01 mm, at every tilt."""
    loop = make_tool_loop(
        inclined(20, 60),
        tool.plane(height_mm=lambda _k: 3.0),
        v_max_mm_s=10.0,
        a_max_mm_s2=1000.0,
    )
    loop.plan(mode).on(set_pos=0.0)
    found = steps(loop.run(20))
    expected = [min(0.001 * (k + 1), 0.01) for k in range(20)]
    assert found == pytest.approx(expected, abs=1e-12)
    assert loop.control3d.axes_share == 1.0


def test_what_an_axis_may_do_lowers_both_without_an_alarm(make_tool_loop: Make, tool: Any) -> None:
    """ECS at 75 deg: Y moves tan 75 = 3.732 mm for one of offset. Y may do 20 mm/s, 2000 mm/s2."""
    rate = math.tan(math.radians(75))
    loop = make_tool_loop(
        inclined(0, 75),
        tool.plane(height_mm=lambda _k: 3.0),
        limits=axis_limits(tool, Y=(20.0, 2000.0)),
        v_max_mm_s=10.0,
        a_max_mm_s2=1000.0,
    )
    loop.plan("ECS").on(set_pos=0.0)
    found = steps(loop.run(30))
    v_mm_s, a_mm_s2 = 20.0 / rate, 2000.0 / rate
    expected = [min(a_mm_s2 * (k + 1) * SECONDS**2, v_mm_s * SECONDS) for k in range(30)]
    assert found == pytest.approx(expected, rel=1e-6)
    assert loop.control3d.axes_share == pytest.approx(20.0 / rate / 10.0, rel=1e-6)
    ways = [b[1] - a[1] for a, b in itertools.pairwise(loop.sent)]
    assert max(map(abs, ways)) <= 20.0 * SECONDS * (1 + 1e-6)


def test_mcs_moves_no_other_axis_and_is_not_limited_by_one(make_tool_loop: Make, tool: Any) -> None:
    loop = make_tool_loop(
        inclined(0, 75),
        tool.plane(height_mm=lambda _k: 3.0),
        limits=axis_limits(tool, Y=(1.0, 10.0)),
        v_max_mm_s=10.0,
    )
    loop.plan("MCS").on(set_pos=0.0)
    assert steps(loop.run(3))[-1] == pytest.approx(0.01)


@pytest.mark.parametrize("mode", ["MCS", "ECS"])
@pytest.mark.provokes(310017, 7, owner="the channel", limit_mm=1.0)
def test_max_deviation_is_one_of_the_offset(make_tool_loop: Make, tool: Any, mode: str) -> None:
    """1 mm along the normal; along a tool at 60 deg that is 2 mm."""
    loop = make_tool_loop(
        inclined(0, 60), tool.plane(height_mm=lambda _k: 3.0), kp=0.5, max_deviation_mm=1.0
    )
    loop.plan(mode).on(set_pos=0.0)
    with pytest.raises(Alarm) as caught:
        loop.run(5)
    assert caught.value.id == 310017
    assert (loop.control.offset_mm, loop.control.state) == (1.0, DistanceState.ERROR)
    moved = math.dist(loop.tcp_mm[-1], (10.0, 20.0, 0.0))
    assert moved == pytest.approx(1.0 if mode == "MCS" else 2.0, abs=1e-9)


def test_running_out_keeps_to_the_limits_of_the_axes_and_ends_at_0(
    make_tool_loop: Make, tool: Any
) -> None:
    loop = make_tool_loop(
        inclined(0, 75),
        tool.plane(height_mm=lambda _k: 0.5),
        limits=axis_limits(tool, Y=(20.0, 2000.0)),
    )
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(200)
    assert loop.control.offset_mm == pytest.approx(0.5, abs=1e-3)
    loop.say(DistanceCommand.FREEZE)
    begin = len(loop.offsets_mm)
    loop.say(DistanceCommand.OFF).run(400)
    assert loop.control.state is DistanceState.INACTIVE
    assert loop.control3d.is_idle
    assert loop.sent[-1] == loop.base(0)
    changes = [b - a for a, b in itertools.pairwise([0.0, *steps(loop)[begin:]])]
    most_mm = 2000.0 / math.tan(math.radians(75)) * SECONDS**2
    assert max(map(abs, changes)) <= most_mm * 1.000001
    assert max(map(abs, steps(loop))) <= 20.0 / math.tan(math.radians(75)) * SECONDS * 1.000001


# ---- steep tools


@pytest.mark.provokes(900463, 7, owner="the channel", limit_deg=85.0)
def test_above_85_deg_along_the_tool_is_refused(make_tool_loop: Make) -> None:
    loop = make_tool_loop(inclined(0, -86))
    with pytest.raises(Alarm) as caught:
        loop.plan("ECS").on(set_pos=0.0)
    assert caught.value.id == 900463
    assert caught.value.values["angle_deg"] == pytest.approx(86, abs=1e-4)
    assert loop.control.state is DistanceState.INACTIVE
    make_tool_loop(inclined(0, -84.9)).plan("ECS").on(set_pos=0.0)
    make_tool_loop(inclined(0, -90)).plan("MCS").on(set_pos=0.0)


@pytest.mark.provokes(900463, 7)
@pytest.mark.parametrize("is_frozen", [False, True])
def test_a_tool_that_is_tilted_on_holds_the_offset_and_bounds_the_way(
    make_tool_loop: Make, tool: Any, is_frozen: bool
) -> None:
    loop = make_tool_loop(
        lambda k: ((0.0, 0.0, 0.0), 0.0, 80.0 + 0.25 * k), tool.plane(height_mm=lambda _k: 0.2)
    )
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(5)
    if is_frozen:
        loop.say(DistanceCommand.FREEZE)
    with pytest.raises(Alarm) as caught:
        loop.run(40)
    assert caught.value.id == 900463
    assert loop.control.state is DistanceState.ERROR
    loop.run(60)
    offset_mm = loop.control.offset_mm
    ways = [math.dist(at, (0, 0, 0)) for at in loop.tcp_mm]
    assert max(ways) <= offset_mm / math.cos(math.radians(85)) * (1 + 1e-9)


# ---- a kinematic that cannot follow


class _Bounded(HeadCA):
    """A head whose Z reaches up to 181 mm."""

    def inverse(self, tool: Any, near: Any) -> Any:
        found = super().inverse(tool, near)
        if found[2] > 181.0:
            raise Alarm(900443, name="9", pose=f"Z {found[2]:.4f}", reason="Z reaches to 181 mm")
        return found


@pytest.mark.provokes(900443, 2)
def test_out_of_reach_through_the_offset_alone_holds_what_was_sent(
    make_tool_loop: Make, tool: Any
) -> None:
    loop = make_tool_loop(
        plane=tool.plane(height_mm=lambda k: 0.1 * k), kinematic=_Bounded((100.0,), 80.0)
    )
    loop.plan("MCS").on(set_pos=0.0)
    with pytest.raises(Alarm) as caught:
        loop.run(30)
    assert (caught.value.id, loop.control.state) == (900443, DistanceState.ERROR)
    assert max(at[2] for at in loop.sent) <= 181.0
    offset_mm = loop.control.offset_mm
    with pytest.raises(Alarm, match="900443"):
        loop.run(1)
    assert loop.control.offset_mm == offset_mm


@pytest.mark.provokes(900443, 2)
@pytest.mark.parametrize("is_optimized", [True, False])
def test_where_the_kinematic_refuses_the_offset_does_not_drop_in_any_cycle(
    make_tool_loop: Make, tool: Any, is_optimized: bool
) -> None:
    """The surface rises by 0.1 mm a cycle, X moves by 0.05 mm: Z rises or rests, X goes on."""
    loop = make_tool_loop(
        lambda k: ((0.05 * k, 0.0, 0.0), 0.0, 0.0),
        tool.plane(height_mm=lambda k: 0.1 * k),
        kinematic=_Bounded((100.0,), 80.0),
        is_optimized=is_optimized,
    )
    loop.plan("MCS").on(set_pos=0.0)
    for _ in range(4):  # each cycle after it says so anew
        with pytest.raises(Alarm, match="900443"):
            loop.run(30)
    z = [at[2] for at in loop.sent]
    assert max(z) > 180.7
    assert all(b - a >= 0.0 for a, b in itertools.pairwise(z))
    assert [at[0] for at in loop.sent] == pytest.approx([0.05 * k for k in range(len(z))])


def test_a_place_out_of_reach_is_forgotten_when_the_axes_are_elsewhere(
    make_tool_loop: Make, tool: Any
) -> None:
    """The program goes 5 mm down: it says so once more of the cycle before, and never again."""
    places = {"surface": 2.0, "program": 0.0}
    loop = make_tool_loop(
        lambda _k: ((0.0, 0.0, places["program"]), 0.0, 0.0),
        tool.plane(height_mm=lambda _k: places["surface"]),
        kinematic=_Bounded((100.0,), 80.0),
    )
    for height_mm in (0.5, -1.0):
        places |= {"surface": 2.0, "program": 0.0}
        loop.plan("MCS").on(set_pos=0.0)
        for _ in range(3):
            with pytest.raises(Alarm, match="900443"):
                loop.run(60)
        assert loop.control.state is DistanceState.ERROR
        places["program"] = -5.0
        with pytest.raises(Alarm, match="900443"):
            loop.run(2)
        loop.run(20)
        loop.say(DistanceCommand.OFF).run(20)
        assert (loop.control.state, loop.control.offset_mm) == (DistanceState.INACTIVE, 0.0)
        places |= {"surface": height_mm, "program": 0.0}
        loop.on(set_pos=0.0)
        loop.run(100)
        assert loop.control.state is DistanceState.ACTIVE
        assert loop.sent[-1][2] == pytest.approx(180.0 + height_mm, abs=1e-3)
        loop.say(DistanceCommand.OFF).run(20)


def test_an_axis_that_the_offset_does_not_move_now_does_not_measure_either(
    make_tool_loop: Make, tool: Any
) -> None:
    """310000 is of every axis of the kinematic: upright along the tool the offset moves Z alone."""
    loop = make_tool_loop(plane=tool.plane(height_mm=lambda _k: 1.0))
    offsets = Offsets({}, loop.control3d, tool.names)
    for axis in tool.names:
        offsets.check_measuring(axis)  # off: everything may
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(20)
    assert loop.control3d.moved == ("Z",)
    for axis in tool.names:
        with pytest.raises(Alarm) as caught:
            offsets.check_measuring(axis)
        assert caught.value.values["axis"] == axis
    loop.say(DistanceCommand.FREEZE)
    for axis in tool.names:
        offsets.check_measuring(axis)


def test_beside_a_dry_run_every_axis_may_measure(make_tool_loop: Make, tool: Any) -> None:
    """It moves none of them; switched on for good it keeps them from it."""
    loop = make_tool_loop(plane=tool.plane(height_mm=lambda _k: 1.0))
    offsets = Offsets({}, loop.control3d, tool.names)
    loop.plan("ECS").on(set_pos=0.0, dry_run=True)
    loop.run(5)
    for axis in tool.names:
        offsets.check_measuring(axis)
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(5)
    for axis in tool.names:
        with pytest.raises(Alarm, match="900521"):
            offsets.check_measuring(axis)


def test_a_pose_that_it_cannot_have_matters_to_nobody_while_it_is_off(
    make_tool_loop: Make,
) -> None:
    kinematic = _Bounded((100.0,), 80.0)
    loop = make_tool_loop(lambda _k: ((0.0, 0.0, 1.0), 0.0, 0.0), kinematic=kinematic)
    loop.plan("MCS").run(5)
    assert loop.sent[-1] == loop.base(0)


# ---- sensor


def test_its_limits_are_those_of_the_distance_as_the_plc_gives_it(
    make_tool_loop: Make, tool: Any
) -> None:
    """max_pos 90, min_pos 70: the tool 80 mm above; 310019 too far away, 310020 too near."""
    for height_mm, alarm_id in ((-11.0, 310019), (11.0, 310020)):
        loop = make_tool_loop(
            plane=tool.plane(height_mm=lambda k, to=height_mm: to if k > 3 else 0.0),
            min_pos_mm=70.0,
            max_pos_mm=90.0,
        )
        loop.plan("MCS").on(set_pos=0.0)
        loop.run(4)
        with pytest.raises(Alarm) as caught:
            loop.run(1)
        assert caught.value.id == alarm_id
        assert caught.value.values["value_mm"] == pytest.approx(80.0 - height_mm)


@pytest.mark.provokes(310018, 7, owner="the channel")
def test_a_jump_of_the_distance_is_310018(make_tool_loop: Make, tool: Any) -> None:
    loop = make_tool_loop(plane=tool.plane(height_mm=lambda k: float(k > 3)), max_change_mm_s=500.0)
    loop.plan("ECS").on(set_pos=0.0)
    with pytest.raises(Alarm, match="310018"):
        loop.run(6)


def test_the_reference_of_an_absolute_sensor_is_a_distance(make_tool_loop: Make, tool: Any) -> None:
    """The PLC gives 83 mm where 80 are: P-CHAN-00805 is 3 mm."""
    loop = make_tool_loop(plane=tool.plane(height_mm=lambda _k: -3.0), ref_offset_mm=3.0)
    loop.plan("MCS").on(set_pos=0.0)
    loop.run(3)
    assert loop.control.distance_mm == pytest.approx(80.0)
    assert loop.offsets_mm[-1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("mode", ["MCS", "ECS"])
def test_a_distance_with_the_sign_of_an_axis_runs_away(
    make_tool_loop: Make, tool: Any, mode: str
) -> None:
    """h is positive; with -h the surface seems to be 2 h higher, and the offset goes there."""
    loop = make_tool_loop(inclined(0, 30), sign=-1, kp=0.5, max_deviation_mm=5.0)
    loop.plan(mode).on(set_pos=0.0)
    with pytest.raises(Alarm, match="310017"):
        loop.run(20)


@pytest.mark.provokes(310029, 7, owner="the channel", source="SECOND_ENCODER")
def test_310029_for_the_second_encoder(make_tool_loop: Make) -> None:
    loop = make_tool_loop()
    with pytest.raises(Alarm, match="310029"):
        loop.control3d.choose("SECOND_ENCODER", None)


@pytest.mark.provokes(310027, 7, owner="the channel")
def test_310027_for_a_variable_that_the_plc_does_not_have(make_tool_loop: Make) -> None:
    loop = make_tool_loop()
    with pytest.raises(Alarm, match="310027"):
        loop.control3d.choose("VARIABLE", "OTHER")
    del loop.values["SENSOR"]
    with pytest.raises(Alarm, match="310027"):
        loop.control3d.require_sensor()


# ---- its end


def test_off_no_move_gives_the_axes_what_was_superposed(make_tool_loop: Make, tool: Any) -> None:
    loop = make_tool_loop(inclined(20, 40), tool.plane(height_mm=lambda _k: 1.0))
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(3).say(DistanceCommand.OFF, no_move=True)
    kept = loop.control3d.hand_over()
    way = 1.0 / math.cos(math.radians(40)) * tool.turned(20, 40)
    assert [kept[name] for name in "XYZ"] == pytest.approx(list(way), abs=1e-9)
    assert loop.control3d.is_idle
    assert loop.run(1).sent[-1] == loop.base(0)


def test_the_end_of_a_program_keeps_the_offset_and_follows_no_more(
    make_tool_loop: Make, tool: Any
) -> None:
    loop = make_tool_loop(plane=tool.plane(height_mm=lambda k: 1.0 if k < 10 else 4.0))
    loop.plan("MCS").on(set_pos=0.0)
    loop.run(10).control3d.end_program()
    loop.run(10)
    assert loop.control.state is DistanceState.INACTIVE
    assert loop.offsets_mm[-1] == pytest.approx(1.0)
    assert loop.sent[-1][2] == pytest.approx(181.0)
    with pytest.raises(Alarm, match="310024"):
        loop.on()
    loop.on(set_pos=0.0)
    assert loop.run(3).offsets_mm[-1] == pytest.approx(4.0)


def test_of_kinematic_98_too_the_offset_moves_the_tool_alone(
    make_tool_loop: Make, tool: Any
) -> None:
    written = {(1, 98, k): 1e4 * v for k, v in enumerate((0.0, 30.0, 60.0, 91.0))}
    kinematic = build(
        [9, 98], KinematicData(), written | {(0, 9, 0): 1e4 * tool.head_mm}, tool.tool_mm
    )
    loop = make_tool_loop(
        inclined(20, 45), tool.plane(height_mm=lambda _k: 1.5), kinematic=kinematic
    )
    loop.plan("ECS").on(set_pos=0.0)
    moved = loop.run(4).tcp_mm[-1] - (10.0, 20.0, 0.0)
    assert moved == pytest.approx(1.5 / math.cos(math.radians(45)) * tool.turned(20, 45), abs=1e-9)
