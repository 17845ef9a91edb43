"""Axes that are led back after a stop: their limits and accelerations; and axes left alone."""

from dataclasses import replace
from typing import Any

import pytest
from tests.channel.channel_by_hand import Bench
from tests.channel.test_cycles_by_hand import END, State, stopping, to
from tests.channel.test_path_alone import HEAD_MM, Walk

from axisrig.kernel.channel.path.soft_limits import SoftLimits
from axisrig.kernel.errors import Alarm
from axisrig.kernel.motion.dynamics import Motion
from axisrig.kernel.motion.profile import Slope

LIMITS = SoftLimits(-10.0, 10.0, 0.0)


def limited(words: Any, x_mm: float = 0.0) -> Walk:
    walk = Walk(words, "XYZ")
    walk.path.use(replace(walk.path.settings("X"), limits=LIMITS))
    start = (x_mm, 0.0, HEAD_MM)
    walk.path.take_over(start)
    walk.places = [start]
    return walk


@pytest.mark.parametrize(("target_mm", "alarm"), [(10.5, 120002), (-10.5, 120003)])
def test_axes_are_led_back_within_their_switches(words: Any, target_mm: float, alarm: int) -> None:
    walk = limited(words)
    with pytest.raises(Alarm) as refused:
        walk.path.lead_back({"X": target_mm, "Y": 1.0}, 5.0)
    assert (refused.value.id, refused.value.values["axis"]) == (alarm, "X")
    assert not walk.path.is_moving
    walk.path.lead_back({"X": 10.0 if target_mm > 0 else -10.0, "Y": 1.0}, 5.0)
    assert walk.path.is_moving


@pytest.mark.parametrize("x_mm", [12.0, -12.0])
def test_an_axis_beyond_its_switch_keeps_no_other_from_moving(words: Any, x_mm: float) -> None:
    """It was moved there by hand: what stays where it is has no target."""
    walk = limited(words, x_mm)
    walk.move(Y=3.0).cycles()
    assert walk.places[-1] == (x_mm, 3.0, HEAD_MM)
    walk.path.lead_back({"Y": 1.0}, 5.0)
    walk.cycles()
    assert walk.places[-1] == (x_mm, 1.0, HEAD_MM)
    with pytest.raises(Alarm):
        walk.move(X=x_mm + 0.5, Y=0.0)
    walk.move(X=0.0).cycles()
    assert walk.places[-1][0] == 0.0


@pytest.mark.parametrize("motion", list(Motion))
def test_axes_are_led_back_with_the_accelerations_of_measuring(words: Any, motion: Motion) -> None:
    """10 mm at 100 mm/s and 1000 mm/s², or with a tenth of it where measuring has that."""
    walk = Walk(words, "XYZ")
    settings = walk.path.settings("X")
    own = settings.dynamics[motion]
    slow = Slope(100.0, 100.0, 500.0)
    changed = {**settings.dynamics, motion: replace(own, acceleration=slow, deceleration=slow)}
    walk.path.use(replace(settings, dynamics=changed))
    walk.path.lead_back({"X": 10.0}, 500.0)
    walk.cycles()
    a_mm_s2 = 100.0 if motion is Motion.MEASURING else own.acceleration.most_mm_s2
    # Up and down over 10 mm: v = sqrt(a s), less what one cycle of 1 ms changes
    assert max(walk.speeds_mm_s("X")) == pytest.approx((a_mm_s2 * 10.0) ** 0.5, abs=a_mm_s2 * 1e-3)


def test_every_reset_is_noted(words: Any) -> None:
    bench = Bench(words, outlives=True)
    bench.is_idle = False
    bench.start(to(words, X=5.0), END).until(State.READY)
    wanted = []
    for _ in range(3):
        bench.channel.plc.wants_reset = True
        bench.cycle().until(State.READY)
        wanted.append(bench.clock.now_ns)
        assert bench.channel.resets_ns == wanted


def test_axes_that_left_the_path_at_an_alarm_are_its_own_again_in_error(words: Any) -> None:
    """Nothing leads them any more, so that an offset that is taken over stays where it is."""
    bench = Bench(words, outlives=True)
    bench.is_idle = False
    stopping(bench.start(to(words, X=500.0), END))
    bench.channel.reactions.stop_alone(("X",))
    assert len(bench.channel.path.leaders) == 1
    bench.until(State.ERROR)
    assert bench.channel.path.leaders == []
    assert bench.channel.reactions.has_stopped
