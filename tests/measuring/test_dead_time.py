"""P-AXIS-00487 leads a measured value back, but never to where the axis was not in the block."""

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.dead_time import DeadTime, run_up
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope

A_MM_S2, V_MM_S, T_S = 1000.0, 20.0, 0.001
BEHIND_MM = V_MM_S**2 / (2 * A_MM_S2)


def dead_time(cycles, **more):
    """Of an axis that begins at 50 mm, window 0, no lag; v^2/2a behind."""
    given = {"window_mm": 0.0, "behind_mm": lambda _: BEHIND_MM, "lag_mm": lambda: 0.0, **more}
    return DeadTime("Z", cycles, 50.0, **given)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_touch_at_the_begin_of_the_block_is_led_back_by_its_run_up(way):
    """Touched where it began, latched n cycles later, n v T less v^2/2a on its way."""
    cycles, speed_mm = 100.0, way * V_MM_S * T_S
    latched_mm = 50.0 + cycles * speed_mm - way * (BEHIND_MM - 1e-9)
    back_mm = dead_time(cycles).led_back_mm(latched_mm, speed_mm)
    assert back_mm == pytest.approx(50.0 - way * BEHIND_MM)


@pytest.mark.provokes(900520, 1, axis="Z", value_mm="49.799", before_mm="0.201", begin_mm="50")
def test_900520_further_back_than_v_squared_by_2_a():
    with pytest.raises(Alarm) as caught:
        dead_time(100.0).led_back_mm(51.799, V_MM_S * T_S)
    assert caught.value.id == 900520
    assert caught.value.values["before_mm"] == "0.201"


@pytest.mark.parametrize("more", [{"window_mm": 0.01}, {"lag_mm": lambda: -0.01}])
def test_lag_and_window_of_the_axis_are_room(more):
    found = dead_time(100.0, **more)
    found.note_signal()
    assert found.led_back_mm(51.799, V_MM_S * T_S) == pytest.approx(49.799)
    with pytest.raises(Alarm):
        found.led_back_mm(51.785, V_MM_S * T_S)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_what_a_lagging_axis_has_not_moved_yet_counts(way):
    """0.2 mm behind its begin with a lag of 0.25: 0.6 mm back is 0.8 before it, 0.4 is 0.6."""
    found = dead_time(1.0, lag_mm=lambda: 0.25, behind_mm=lambda _: 0.4)
    found.note_signal()
    at_mm = 50.0 - way * 0.2
    assert found.led_back_mm(at_mm, way * 0.4) == pytest.approx(50.0 - way * 0.6)
    with pytest.raises(Alarm) as caught:
        found.led_back_mm(at_mm, way * 0.6)
    assert caught.value.values["before_mm"] == "0.8"


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_an_axis_that_swings_back_is_led_from_its_turn(way):
    """30 mm from its begin and on the way back to it: v^2/2a, and no more."""
    at_mm = 50.0 + way * 30.0
    for share, is_led in ((0.0, True), (0.99, True), (1.01, False)):
        speed_mm = -way * share * BEHIND_MM
        if is_led:
            found_mm = dead_time(1.0).led_back_mm(at_mm, speed_mm)
            assert found_mm == pytest.approx(at_mm + way * share * BEHIND_MM)
        else:
            with pytest.raises(Alarm):
                dead_time(1.0).led_back_mm(at_mm, speed_mm)


def test_run_up_of_one_step_and_of_two():
    """v/a and v^2/2a; with a second step above 5 mm/s both parts."""
    one = Slope(A_MM_S2, A_MM_S2, 1e9)
    assert run_up(one, one, V_MM_S) == pytest.approx((0.02, 0.2), rel=1e-5)
    two = Slope(500.0, A_MM_S2, 5.0)
    assert run_up(two, one, V_MM_S) == pytest.approx(
        (5 / 500 + 15 / 1000, 25 / 1000 + 375 / 2000), rel=1e-5
    )
    assert run_up(one, one, 0.0) == (0.0, 0.0)


def test_run_up_with_ramps_takes_the_ramps_longer():
    """Equal ramps of t_r at both ends: v/a + t_r, and half of it times v."""
    slope = JerkSlope(A_MM_S2, 0.01, 0.01, Shape.TRAPEZ)
    time_s, way_mm = run_up(slope, slope, V_MM_S)
    assert time_s == pytest.approx(V_MM_S / A_MM_S2 + 0.01, rel=1e-3)
    assert way_mm == pytest.approx(0.5 * V_MM_S * time_s, rel=1e-3)


@pytest.mark.parametrize(("up_mm_s2", "down_mm_s2"), [(200.0, 5000.0), (5000.0, 200.0)])
def test_a_run_up_ends_with_the_acceleration_however_short_the_way_down_is(up_mm_s2, down_mm_s2):
    up, down = (Slope(a_mm_s2, a_mm_s2, 1e9) for a_mm_s2 in (up_mm_s2, down_mm_s2))
    expected = V_MM_S / up_mm_s2, V_MM_S**2 / (2 * up_mm_s2)
    assert run_up(up, down, V_MM_S) == pytest.approx(expected, rel=1e-5)
