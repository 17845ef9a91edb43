"""Mode, direction and kinematic of 3D distance control: what each needs, and what may change."""

from collections.abc import Callable
from typing import Any

import pytest
from tests.channel.distance3d.programs import inclined

from axisrig.kernel.channel.distance.diagnosis import diagnosis
from axisrig.kernel.distance import DistanceCommand
from axisrig.kernel.errors import Alarm
from axisrig.kernel.kinematics import HeadCA

Make = Callable[..., Any]
SECONDS = 1e-3  # a cycle


def test_without_words_it_is_the_normal_with_a_kinematic(make_tool_loop: Make) -> None:
    loop = make_tool_loop()
    loop.plan().on(set_pos=0.0)
    assert loop.control3d.guide.mode == "MCS"


@pytest.mark.provokes(900461, 2, axes="X Y Z C A")
def test_acs_needs_an_axis(make_tool_loop: Make) -> None:
    with pytest.raises(Alarm, match="900461"):
        make_tool_loop(kinematic=None).plan().on(set_pos=0.0)
    with pytest.raises(Alarm, match="900461"):
        make_tool_loop().plan("ACS").on(set_pos=0.0)


@pytest.mark.provokes(900460, 2)
@pytest.mark.parametrize("mode", ["MCS", "ECS"])
def test_the_tool_needs_a_kinematic(make_tool_loop: Make, mode: str) -> None:
    with pytest.raises(Alarm) as caught:
        make_tool_loop(kinematic=None).plan(mode).on(set_pos=0.0)
    assert (caught.value.id, caught.value.values) == (900460, {"mode": mode})


@pytest.mark.provokes(310025, 7, owner="the channel", current="MCS")
def test_another_mode_while_it_is_on_is_310025(make_tool_loop: Make) -> None:
    loop = make_tool_loop()
    loop.plan("MCS").on(set_pos=0.0)
    with pytest.raises(Alarm) as caught:
        loop.plan("ECS")
    assert (caught.value.id, caught.value.values["programmed"]) == (310025, "ECS")
    assert loop.control3d.wanted_mode == "MCS"  # what is refused does not count for the next ON
    loop.plan("MCS", "Z")
    loop.say(DistanceCommand.OFF).run(3).plan("ECS").on(set_pos=0.0)


def test_another_axis_while_it_is_on_is_310025(make_tool_loop: Make) -> None:
    loop = make_tool_loop()
    loop.plan("ACS", "Z").on(set_pos=0.0)
    with pytest.raises(Alarm) as caught:
        loop.plan(None, "Y")
    assert caught.value.values["current"] == "ACS Z"
    assert caught.value.values["programmed"] == "ACS Y"
    assert loop.control3d.wanted_axis == "Z"


@pytest.mark.provokes(900462, 7, mode="MCS")
def test_a_frozen_offset_cannot_go_on_along_another_normal(make_tool_loop: Make, tool: Any) -> None:
    loop = make_tool_loop(plane=tool.plane(height_mm=lambda _k: 1.0))
    loop.plan("MCS").on(set_pos=0.0)
    loop.run(3).say(DistanceCommand.FREEZE)
    sent = loop.sent[-1]
    loop.plan(normal=(0.0, 0.6, 0.8))
    assert loop.run(3).sent[-1] == sent
    with pytest.raises(Alarm, match="900462"):
        loop.on()
    loop.plan(normal=(0.0, 0.0, 1.0)).on()


def test_a_frozen_offset_stays_where_it_is_when_the_kinematic_goes(
    make_tool_loop: Make, tool: Any
) -> None:
    """#TRAFO OFF in FREEZE: the axes do not move; to go on it needs the kinematic again."""
    loop = make_tool_loop(inclined(20, 40), tool.plane(height_mm=lambda _k: 1.0))
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(3).say(DistanceCommand.FREEZE).run(1)
    sent, loop.kinematic = loop.sent[-1], None
    assert loop.run(3).sent[-1] == sent
    with pytest.raises(Alarm, match="900460"):
        loop.on()


def test_what_an_end_has_left_goes_on_with_the_same_kinematic_made_anew(
    make_tool_loop: Make, tool: Any
) -> None:
    """#TRAFO of the next program makes another object of the same kinematic."""
    loop = make_tool_loop(inclined(20, 40), tool.plane(height_mm=lambda _k: 1.0))
    loop.plan("ECS").on(set_pos=0.0)
    loop.run(3).control3d.end_program()
    before = loop.run(1).sent[-1]
    loop.kinematic = HeadCA((100.0,), 80.0)
    loop.plan("ECS").on(set_pos=0.0)
    assert loop.run(2).sent[-1] == pytest.approx(before, abs=1e-9)
    loop.say(DistanceCommand.FREEZE).kinematic = HeadCA((100.0,), 81.0)
    loop.on()  # another length moves the TCP, not the way of the tool
    assert loop.run(1).sent[-1] == pytest.approx(before, abs=1e-9)


@pytest.mark.provokes(900464, 1, set_dist_mm="1", length_mm="80")
@pytest.mark.provokes(900464, 1, set_dist_mm="1", length_mm="0")
def test_a_set_distance_that_is_not_the_tool_length_is_a_warning(make_tool_loop: Make) -> None:
    for length_mm, set_dist_mm in ((80.0, 1.0), (0.0, 1.0)):
        loop = make_tool_loop(kinematic=HeadCA((100.0,), length_mm))
        warning = loop.plan("ECS").on(set_dist=set_dist_mm)
        assert (warning.id, warning.values["length_mm"]) == (900464, f"{length_mm:g}")
    assert make_tool_loop().plan("ECS").on(set_dist=80.0) is None
    assert make_tool_loop().plan("ACS", "Z").on(set_dist=1.0) is None


@pytest.mark.provokes(900465, 2, value_s=0.0004, cycle_s=0.001)
def test_filter_time_is_a_number_of_cycles(make_tool_loop: Make) -> None:
    control = make_tool_loop().control3d
    assert control.parameters({"kp": 0.3, "filter_time_s": 0.02}) == {"kp": 0.3, "n_cycles": 20}
    for time_s, cycles in ((0.0296, 30), (0.0294, 29), (0.0006, 1)):  # to the nearest one
        assert control.parameters({"filter_time_s": time_s}) == {"n_cycles": cycles}
    with pytest.raises(Alarm, match="900465"):
        control.parameters({"filter_time_s": 0.0004})


@pytest.mark.parametrize(
    ("tool_mm", "set_dist", "shown"),
    [
        (80.0, 80.0, None),
        (80.0, 80.0000005, None),  # rounding of a decimal
        (80.0, 80.0005, ("80.0005", "80")),
        (80.0, 79.999, ("79.999", "80")),
        (0.0, 0.0, ("0", "0")),  # no tool has a length of 0
        (-1.0, -1.0, ("-1", "-1")),
    ],
)
def test_a_set_distance_is_the_tool_length_to_a_nanometre(
    make_tool_loop: Make, tool_mm: float, set_dist: float, shown: tuple[str, str] | None
) -> None:
    loop = make_tool_loop(kinematic=HeadCA((100.0,), tool_mm))
    warning = loop.plan("MCS").on(set_dist=set_dist)
    if shown is None:
        assert warning is None
        return
    assert warning.id == 900464
    assert (warning.values["set_dist_mm"], warning.values["length_mm"]) == shown


@pytest.mark.parametrize(
    ("mode", "shows_on", "shows_off"),
    [(None, "MCS(3)", "OFF(0)"), ("MCS", "MCS(3)", "MCS(3)"), ("ECS", "ECS(2)", "ECS(2)")],
)
def test_the_mode_of_the_next_on_is_shown_once_something_says_it(
    make_tool_loop: Make, mode: str | None, shows_on: str, shows_off: str
) -> None:
    """Without MODE it is MCS with a kinematic; while it is off nothing has said it."""
    loop = make_tool_loop()
    loop.plan(mode)
    assert dict(diagnosis(loop.control3d, is_awaited=False))["new_mode"] == shows_off
    loop.on(set_pos=0.0)
    loop.run(2)
    shown = dict(diagnosis(loop.control3d, is_awaited=False))
    assert (shown["active_mode"], shown["new_mode"]) == (shows_on, shows_on)
