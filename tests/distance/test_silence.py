"""A sensor that has been silent for too long: the offset is held from that cycle on."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.distance import DistanceCommand, DistanceState, Reading, Silence
from axisrig.kernel.errors import Alarm

Make = Callable[..., Any]
SILENCE = Silence("SECOND_ENCODER", 4.0, 3.0)


def following(make_loop: Make, **settings: Any) -> Any:
    """A control 1 mm away from its distance, that follows with half of the error per cycle."""
    loop = make_loop(lambda _k: 1.0, kp=0.5, dead_cycles=1, **settings)
    loop.control.set_distance(0.0)
    return loop.say(DistanceCommand.ON_CONST_DIST).run(3)


def silent(*, is_held: bool = False) -> Reading:
    return Reading(1.0, 0.0, 0.0, is_held, SILENCE)


@pytest.mark.provokes(900314, 7, owner="axis Z", source="SECOND_ENCODER", age_ms="4", limit_ms="3")
def test_the_offset_stands_in_the_cycle_in_which_the_limit_is_passed(make_loop: Make) -> None:
    control = following(make_loop).control
    before_mm, moved_mm = control.offset_mm, control.step_mm
    with pytest.raises(Alarm, match="ID 900314 class 7: Sensor of axis Z is silent"):
        control.step(silent())
    assert moved_mm != 0.0
    assert (control.offset_mm, control.step_mm, control.delta_mm) == (before_mm, 0.0, 0.0)
    assert control.state is DistanceState.ERROR


def test_silence_comes_before_what_an_old_value_would_say(make_loop: Make) -> None:
    control = following(make_loop, max_pos_mm=2.0).control
    with pytest.raises(Alarm, match="ID 900314"):
        control.step(Reading(99.0, 0.0, 0.0, silence=SILENCE))


def test_a_held_or_frozen_control_moves_nothing_by_an_old_value(make_loop: Make) -> None:
    control = following(make_loop).control
    before_mm = control.offset_mm
    assert control.step(silent(is_held=True)) == before_mm
    control.command(DistanceCommand.FREEZE, control.source)
    assert control.step(silent()) == before_mm
    control.command(DistanceCommand.ON_CONST_DIST, control.source)
    with pytest.raises(Alarm, match="ID 900314"):
        control.step(silent())
