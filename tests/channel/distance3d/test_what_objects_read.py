"""What 3D distance control shows of a cycle: its objects, the axes' share, what is superposed.

Ideal axes over a plane that is 2 mm above SET_POS: without limits the first step is all of it.
"""

import math
from collections.abc import Callable
from typing import Any

import pytest
from tests.channel.distance3d.programs import inclined
from tests.channel.distance3d.test_limits import axis_limits

from axisrig.kernel.channel.distance.offsets import Offsets
from axisrig.kernel.distance import DistanceCommand, DistanceState, channel_objects
from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import HeadCA

Make = Callable[..., Any]
OF_CHANNEL = {n.partition("::")[2]: o for n, o in channel_objects().items() if not o.of_axis}
OF_AXIS = {n: o for n, o in channel_objects().items() if o.of_axis}
UNIT_MM = 1e-8
"""The objects of the channel count in 0.01 nm (3D objects 1030357643)."""


def shown(loop: Any) -> dict[str, float]:
    """The objects of the channel, in mm."""
    return {name: item.read(loop.control3d) * UNIT_MM for name, item in OF_CHANNEL.items()}


def over(make: Make, tool: Any, height_mm: float = 2.0, **changes: Any) -> Any:
    return make(plane=tool.plane(height_mm=lambda _k: height_mm), **changes)


# Objects


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("is_optimized", [True, False])
def test_objects_show_the_offset_its_change_and_what_has_led_to_it(
    make_tool_loop: Make, tool: Any, is_optimized: bool, sign: float
) -> None:
    """10 um in each cycle; without P-CHAN-00818 the drives get them a cycle later."""
    loop = over(make_tool_loop, tool, 2.0 * sign, is_optimized=is_optimized, v_max_mm_s=10.0)
    loop.plan("MCS").on(set_pos=0.0)
    late = 0 if is_optimized else 1
    for cycle in range(1, 5):
        found = shown(loop.run(1))
        sent = max(cycle - late, 0)
        assert found == pytest.approx(
            {
                "set_pos": 0.0, "set_distance": 0.0,
                "target_deviation": sign * (2.0 - 0.01 * (cycle - 1)),
                "delta_deviation_pre_limiter": sign * (2.0 - 0.01 * (cycle - 1)),
                "m_actual_offset": sign * 0.01 * cycle, "sloped_delta_deviation": sign * 0.01,
                "actual_offset": sign * 0.01 * sent,
                "delta_offset": sign * 0.01 * (sent > 0),
                # what the axes had done before this cycle
                "sensor_value": tool.tool_mm - sign * 2.0 + sign * 0.01 * max(sent - 1, 0),
                "feedback_value": sign * 2.0, "filtered_feedback": sign * 2.0,
            }, abs=UNIT_MM,
        )  # fmt: skip
    loop.say(DistanceCommand.FREEZE).run(2)
    found = shown(loop)
    assert (found["delta_offset"], found["sloped_delta_deviation"]) == (0.0, 0.0)
    assert found["actual_offset"] == pytest.approx(sign * 0.04, abs=1e-9)
    loop.say(DistanceCommand.OFF)
    changes = [shown(loop.run(1))["delta_offset"] for _ in range(6)]
    out = [-sign * 0.01] * 4
    assert changes == pytest.approx(out + [0.0] * 2 if is_optimized else [0.0, *out, 0.0])


def test_an_object_of_a_set_value_shows_that_of_its_own_law(
    make_tool_loop: Make, tool: Any
) -> None:
    """SET_DIST is the tool length: 80 mm over the plane are no error at 2 mm of offset."""
    loop = over(make_tool_loop, tool)
    loop.plan("MCS").on(set_dist=79.5)
    found = shown(loop.run(1))
    assert (found["set_pos"], found["set_distance"]) == (0.0, 79.5)
    assert found["feedback_value"] == pytest.approx(78.0, abs=1e-7)
    assert found["target_deviation"] == pytest.approx(1.5, abs=1e-7)
    loop.control.set_surface(0.25)
    assert shown(loop)["set_pos"] == 0.25


@pytest.mark.parametrize("is_optimized", [True, False])
def test_objects_of_an_axis_show_its_positions_without_and_with_the_offset(
    make_tool_loop: Make, tool: Any, is_optimized: bool
) -> None:
    """Tool at 40 deg, along it: 1 mm of offset is 1 mm in Z and tan 40 in Y; X has nothing."""
    program = inclined(0.0, 40.0)
    loop = make_tool_loop(
        program, tool.plane(height_mm=lambda _k: 2.0), is_optimized=is_optimized, v_max_mm_s=10.0
    )
    base = dict(zip(tool.names, tool.axes_of(*program(0)), strict=True))
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(5)
    offset_mm = 0.05 if is_optimized else 0.04
    ways = {"X": 0.0, "Y": -offset_mm * math.tan(math.radians(40.0)), "Z": offset_mm}
    for link in loop.links:
        link.actual_mm += 0.5
    for axis, way_mm in ways.items():
        positions = loop.control3d.positions_of(axis)
        found = {name: item.read(positions) / item.factor for name, item in OF_AXIS.items()}
        assert list(found.values()) == pytest.approx(
            [base[axis], base[axis] + way_mm, base[axis] + way_mm, base[axis] + way_mm + 0.5],
            abs=1e-4,  # 0.1 um, the unit of three of them
        )


# What is superposed


@pytest.mark.parametrize("end", [DistanceCommand.OFF, None])
def test_nothing_is_superposed_any_more_when_the_offset_is_gone(
    make_tool_loop: Make, tool: Any, end: DistanceCommand | None
) -> None:
    """Whether it has run out or the positions have taken it over."""
    loop = over(make_tool_loop, tool)
    offsets = Offsets({}, loop.control3d, tool.names)
    loop.plan("MCS").on(set_pos=0.0)
    loop.run(3)
    assert offsets.superposed_mm("Z") == pytest.approx(2.0)
    if end is None:
        loop.say(DistanceCommand.OFF, no_move=True)
        kept = dict(loop.control3d.hand_over())
        assert kept == {"Z": pytest.approx(2.0)}
        assert loop.control3d.hand_over() == {}
    else:
        loop.say(end).run(3)
    assert [offsets.superposed_mm(name) for name in tool.names] == [0.0] * 5
    assert loop.control3d.is_idle
    positions = loop.control3d.positions_of("Z")
    assert positions.superposed_mm == positions.base_mm


def test_an_axis_that_gets_nothing_more_has_no_part_of_what_it_had(
    make_tool_loop: Make, tool: Any
) -> None:
    """The tool turns upright with a frozen offset: Y had tan 40 of it and has none then."""
    loop = make_tool_loop(
        lambda k: ((0.0, 0.0, 0.0), 0.0, 40.0 if k < 3 else 0.0),
        tool.plane(height_mm=lambda _k: 1.0),
    )
    offsets = Offsets({}, loop.control3d, tool.names)
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(3).say(DistanceCommand.FREEZE)
    assert offsets.superposed_mm("Y") == pytest.approx(-math.tan(math.radians(40.0)))
    loop.run(1)
    assert [offsets.superposed_mm(n) for n in "XYZ"] == [0.0, 0.0, pytest.approx(1.0)]


# What axes leave it


@pytest.mark.parametrize(
    ("y_may", "share"),
    [
        ((1e9, 1e12), 1.0), ((40.0, 1e12), 40.0 / 100.0), ((1e9, 300.0), 300.0 / 1000.0),
        ((40.0, 300.0), 300.0 / 1000.0), ((20.0, 300.0), 20.0 / 100.0), ((500.0, 1e12), 1.0),
    ],
)  # fmt: skip
@pytest.mark.parametrize("a_deg", [45.0, -45.0])
def test_the_share_is_that_of_speed_or_acceleration_whichever_is_smaller(
    make_tool_loop: Make, tool: Any, y_may: tuple[float, float], share: float, a_deg: float
) -> None:
    """At 45 deg along the tool Y goes as far as the offset; it has 100 mm/s and 1000 mm/s2."""
    loop = make_tool_loop(
        inclined(0.0, a_deg), limits=axis_limits(tool, Y=y_may), v_max_mm_s=100.0,
        a_max_mm_s2=1000.0,
    )  # fmt: skip
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(1)
    assert loop.control3d.axes_share == pytest.approx(share, rel=1e-6)
    assert loop.control3d.moved == ("Y", "Z")
    loop.plan("ECS").say(DistanceCommand.OFF).run(1)
    loop.plan("ACS", "Y").on(set_pos=0.0)
    loop.run(1)
    assert loop.control3d.axes_share == 1.0


# Another guide for an offset that is there


@pytest.mark.parametrize("offset_mm", [1.0, -1.0])
@pytest.mark.parametrize("y", [0.6, -0.6])
def test_a_frozen_offset_goes_on_along_no_other_normal_whatever_its_sign(
    make_tool_loop: Make, tool: Any, offset_mm: float, y: float
) -> None:
    """Y and Z would both move one way or both the other way."""
    loop = over(make_tool_loop, tool, offset_mm)
    loop.plan("MCS").on(set_pos=0.0)
    loop.run(3).say(DistanceCommand.FREEZE)
    loop.plan(normal=(0.0, y, 0.8))
    with pytest.raises(Alarm) as caught:
        loop.on()
    assert caught.value.id == 900462
    assert caught.value.values["offset_mm"] == offset_mm
    assert loop.control.state is DistanceState.FREEZE


def test_a_frozen_offset_may_go_on_by_what_moves_the_axes_alike(
    make_tool_loop: Make, tool: Any
) -> None:
    """Another origin along the normal is another SET_POS, and moves no axis elsewhere."""
    loop = over(make_tool_loop, tool)
    loop.plan("MCS").on(set_pos=0.0)
    loop.run(3).say(DistanceCommand.FREEZE)
    assert loop.offsets_mm[-1] == pytest.approx(2.0)
    loop.plan(origin=(0.0, 0.0, -1.0)).on()
    assert loop.run(2).offsets_mm[-1] == pytest.approx(3.0)


# A tool that leans too much, more than once


def test_each_time_that_the_tool_leans_too_much_is_an_alarm_of_its_own(
    make_tool_loop: Make, tool: Any
) -> None:
    """86 deg for 10 cycles, twice; the control is switched on again between them."""
    loop = make_tool_loop(
        lambda k: ((0.0, 0.0, 0.0), 0.0, 86.0 if k % 20 >= 10 else 30.0),
        tool.plane(height_mm=lambda _k: 0.2),
    )
    for turn in range(2):
        loop.plan("ECS").on(set_pos=0.0)
        with pytest.raises(Alarm) as caught:
            loop.run(20)
        # The axes are sent there in the 11th cycle, and the 12th one finds them there
        assert (caught.value.id, loop.cycle) == (900463, 20 * turn + 12)
        assert caught.value.values["angle_deg"] == pytest.approx(86.0, abs=1e-9)
        loop.run(5)  # it is not reported again while it leans
        loop.say(DistanceCommand.OFF).run(20 * turn + 21 - loop.cycle)
    assert loop.control3d.logged_events == 2


# What a program has chosen


def test_what_is_refused_leaves_mode_and_axis_as_they_were(make_tool_loop: Make) -> None:
    loop = make_tool_loop()
    loop.plan("ACS", "Z").on(set_pos=0.0)
    for mode, direction in (("MCS", None), (None, "Y"), ("ECS", "Y"), ("ACS", "X")):
        with pytest.raises(Alarm, match="310025"):
            loop.plan(mode, direction)
        found = loop.control3d
        assert (found.wanted_mode, found.wanted_axis) == ("ACS", "Z")
    loop.plan("ACS", None)
    loop.plan(None, "Z")
    loop.control3d.forget()
    assert (found.wanted_axis, found.wanted_mode) == (None, "MCS")


@pytest.mark.parametrize(("length_mm", "way_mm"), [(80.0, 0.0), (81.5, 1.5), (78.0, -2.0)])
def test_a_tool_is_virtually_longer_by_what_its_head_has_more(
    make_tool_loop: Make, length_mm: float, way_mm: float
) -> None:
    class Extended(HeadCA):
        def length_mm(self, _tool: Any) -> float:
            return length_mm

        def nominal_length_mm(self, _tool: Any) -> float:
            return 80.0

    loop = make_tool_loop(kinematic=Extended((100.0,), 80.0))
    assert loop.control3d.lengthening_mm() == pytest.approx(way_mm)
    loop.kinematic = None
    assert loop.control3d.lengthening_mm() == 0.0


def test_a_control_that_is_off_knows_the_axis_that_was_named_last(
    make_tool_loop: Make, tool: Any
) -> None:
    """Z until its offset has run out, Y from the command on: `moved` and where the surface is."""
    loop = over(make_tool_loop, tool, 0.5)
    loop.links[1].set_mm = loop.links[1].actual_mm = 7.0
    loop.plan("ACS", "Z").on(set_pos=0.0)
    loop.run(2).say(DistanceCommand.OFF).run(3)
    assert loop.control3d.moved == ("Z",)
    for axis, height_mm in (("Y", 0.0), ("X", 0.0), ("Z", 180.0)):
        loop.plan("ACS", axis).run(1)
        assert (loop.control3d.moved, loop.control3d.guide.axes) == ((axis,), (axis,))
        surface_mm = loop.control.surface_mm
        assert surface_mm == pytest.approx(height_mm + loop.control.sensor_mm)
    loop.plan("MCS").run(1)
    assert loop.control3d.moved == ("Z",)
