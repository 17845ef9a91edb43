"""Where the path ends or is held, and the window without the lag; axes as in test_stop_run.py."""

from collections.abc import Callable

import pytest
from tests.measuring.fixed_stop.conftest import MS, Axis, Stage

from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings

Make = Callable[..., Stage]
LAG = FixedStopSettings(lag_limit_mm=1.0, min_time_ns=50 * MS)
WINDOW = FixedStopSettings(window_mm=0.1, min_time_ns=50 * MS)
BOTH = FixedStopSettings(lag_limit_mm=1.0, window_mm=0.1, min_time_ns=50 * MS)


# The end of the path


def test_an_axis_at_rest_beyond_the_limit_gets_its_time(stage: Make) -> None:
    """The set value stands at 6.5 mm from cycle 650 on, long before the time is over."""
    slow = FixedStopSettings(1.0, min_time_ns=500 * MS)
    run = stage(Axis("Z", stop_mm=5.0), target={"Z": 6.5}, detect=slow).finish()
    assert run.stop.detected_ns == (602 + 500) * MS
    assert run.record.latched_mm == {"Z": 5.0}


@pytest.mark.parametrize(
    "slow",
    [
        FixedStopSettings(1.0, None, 500 * MS, 0, 2.0),
        FixedStopSettings(None, 0.1, 500 * MS, 0, 2.0),
        FixedStopSettings(1.0, 0.1, 500 * MS, 0, 2.0),
    ],
    ids=["lag", "window", "both"],
)
def test_a_stop_in_the_negative_direction_is_found_at_rest_in_the_same_cycle(
    stage: Make, slow: FixedStopSettings
) -> None:
    """Lag and way are negative there; the set value stands long before the time is over."""
    up = stage(Axis("Z", stop_mm=5.0), target={"Z": 6.5}, detect=slow).finish()
    down = stage(Axis("Z", stop_mm=5.0, sign=-1), target={"Z": -6.5}, detect=slow).finish()
    assert (up.record.latched_mm, down.record.latched_mm) == ({"Z": 5.0}, {"Z": -5.0})
    assert up.stop.detected_ns == down.stop.detected_ns
    assert up.stop.detected_ns is not None
    assert up.stop.detected_ns > (652 + 50) * MS


@pytest.mark.parametrize("order", ["XZ", "ZX"])
def test_of_several_axes_the_longest_time_is_waited_for(stage: Make, order: str) -> None:
    """X runs free and has 50 ms, Z is held and has 500: each moves 0.01 mm in a cycle."""
    axes = {"X": Axis("X"), "Z": Axis("Z", stop_mm=5.0)}
    detect = {
        "X": FixedStopSettings(1.0, min_time_ns=50 * MS),
        "Z": FixedStopSettings(1.0, min_time_ns=500 * MS),
    }
    made = stage(
        *(axes[name] for name in order),
        target=dict.fromkeys(order, 6.5),
        detect=detect,
        speed_mm_s=10.0 * 2**0.5,
    )
    run = made.finish()
    assert run.stop.detected_by == "Z"
    assert run.stop.detected_ns == (602 + 500) * MS


@pytest.mark.parametrize("detect", [WINDOW, BOTH])
def test_a_window_that_flickers_at_rest_is_waited_for_no_longer_than_its_time(
    stage: Make, detect: FixedStopSettings
) -> None:
    """A window of 0 and a time of 51 cycles: its two ends are on either side of a swing."""
    held = FixedStopSettings(detect.lag_limit_mm, 0.0, 51 * MS, 0, 4.9)
    axis = Axis("Z", stop_mm=5.0, swing_mm=1e-6)
    made = stage(axis, target={"Z": 6.5}, detect=held, is_error=False)
    run = made.finish()
    assert run.record.latched_mm == {}
    # Set position at the target 651, seen to stand 652, at rest 702, 51 cycles of the time
    assert run.stop.relax_begin_ns == pytest.approx((702 + 52) * MS, abs=2 * MS)


def test_a_rest_in_a_feedhold_is_none_at_the_target(stage: Make) -> None:
    """The time at the target counts from the rest there, not from that of the feedhold."""
    slow = FixedStopSettings(1.0, min_time_ns=500 * MS)
    holds = range(100, 1000)
    made = stage(Axis("Z", stop_mm=5.0), target={"Z": 6.5}, detect=slow, holds=holds)
    run = made.finish()
    assert run.stop.detected_ns == (602 + 900 + 500) * MS
    assert run.record.latched_mm == {"Z": 5.0}


def test_a_lag_that_flickers_about_its_limit_at_rest_is_no_stop(stage: Make) -> None:
    """Each cycle below begins the time anew; the run ends all the same."""
    axis = Axis("Z", stop_mm=5.0, swing_mm=1e-6)
    made = stage(axis, target={"Z": 6.0}, detect=LAG, is_error=False)
    assert made.finish(3000).record.latched_mm == {}


def test_a_lag_that_was_never_judged_is_not_waited_for(stage: Make) -> None:
    """The path ends before the start distance; the set position of 650 is seen to stand in 652."""
    never = FixedStopSettings(1.0, min_time_ns=900 * MS, start_distance_mm=30.0)
    run = stage(Axis("Z", 5.0), target={"Z": 6.5}, detect=never, is_error=False).finish()
    assert run.stop.relax_begin_ns == (652 + 50) * MS


def test_without_anything_to_wait_for_the_run_ends_with_the_rest(stage: Make) -> None:
    """Set position at the target 500 (seen to stand in 502), at rest 50 cycles later."""
    armed = FixedStopSettings(window_mm=0.1, min_time_ns=900 * MS, start_distance_mm=4.9)
    run = stage(Axis("Z"), target={"Z": 5.0}, detect=armed, is_error=False).finish()
    assert run.stop.relax_begin_ns == (502 + 50) * MS


@pytest.mark.parametrize(("detect", "found"), [(WINDOW, True), (BOTH, False), (LAG, False)])
def test_an_axis_at_rest_at_a_stop_with_too_little_lag(
    stage: Make, detect: FixedStopSettings, found: bool
) -> None:
    """0.05 mm behind the set value: the window holds, the lag does not."""
    armed = FixedStopSettings(detect.lag_limit_mm, detect.window_mm, 50 * MS, 0, 4.9)
    made = stage(Axis("Z", stop_mm=5.0), target={"Z": 5.05}, detect=armed, is_error=False)
    assert bool(made.finish().record.latched_mm) is found


# The window without the lag


def test_the_window_alone_finds_the_stop_while_the_set_value_moves(stage: Make) -> None:
    """5 mm are reached in cycle 501 and seen in 502; 50 cycles less 10 for 0.1 mm."""
    armed = FixedStopSettings(window_mm=0.1, min_time_ns=50 * MS, start_distance_mm=2.0)
    run = stage(Axis("Z", stop_mm=5.0), target={"Z": 20.0}, detect=armed).finish()
    assert run.stop.detected_ns == pytest.approx((502 + 50 - 10) * MS, abs=MS)
    assert run.stop.window_ns == {"Z": run.stop.detected_ns}


def test_the_window_alone_finds_a_standing_axis_when_the_block_begins(stage: Make) -> None:
    """Predicted: without a start distance the axis still stands (domain: arm it later)."""
    run = stage(Axis("Z"), target={"Z": 20.0}, detect=WINDOW).finish()
    assert run.stop.detected_ns == 2 * MS


@pytest.mark.parametrize("lag_mm", [None, 0.1])
@pytest.mark.parametrize("slowing", [0, 1000])
def test_the_window_finds_nothing_at_the_target(
    stage: Make, slowing: int, lag_mm: float | None
) -> None:
    """Slowing down for 1 s the axis is slower than W / tau = 2 mm/s for 200 ms.

    A lag limit below the running lag of 0.2 mm leaves the decision to the window.
    """
    armed = FixedStopSettings(lag_mm, window_mm=0.1, min_time_ns=50 * MS, start_distance_mm=2.0)
    axis = Axis("Z", running_mm=0.2)
    made = stage(axis, target={"Z": 9.0}, detect=armed, is_error=False, slowing=slowing)
    assert made.finish().record.latched_mm == {}


def test_both_find_a_stop_on_the_slope_to_the_target_when_the_axis_rests(stage: Make) -> None:
    """Set position: 8 mm and 1 s of slowing down; seen to stand in its last cycle and one more."""
    armed = FixedStopSettings(0.1, window_mm=0.1, min_time_ns=50 * MS, start_distance_mm=2.0)
    made = stage(Axis("Z", stop_mm=8.0), target={"Z": 9.0}, detect=armed, slowing=1000)
    run = made.finish()
    assert run.record.latched_mm == {"Z": 8.0}
    last = round((9.0 - 0.01 * 1000 / 2) / 0.01) + 1000
    assert run.stop.detected_ns == pytest.approx((last + 2 + 50) * MS, abs=MS)


def test_the_buffer_does_not_shift_the_arming_of_the_window(stage: Make) -> None:
    """The set position stands for 5 cycles while the path begins: that is no feedhold."""
    armed = FixedStopSettings(window_mm=0.1, min_time_ns=50 * MS, start_distance_mm=2.0)
    made = stage(Axis("Z", stop_mm=1.0), target={"Z": 9.0}, detect=armed, buffer=5)
    run = made.finish()
    assert run.stop.armed_ns == run.stop.detected_ns == 201 * MS


def test_a_start_distance_of_the_whole_path_arms_at_its_end(stage: Make) -> None:
    """A share of 1000 per mille may come out an atom longer than the path."""
    armed = FixedStopSettings(1.0, start_distance_mm=6.5 + 1e-12, min_time_ns=50 * MS)
    run = stage(Axis("Z", stop_mm=5.0), target={"Z": 6.5}, detect=armed).finish()
    assert run.record.latched_mm == {"Z": 5.0}


@pytest.mark.parametrize("lag_mm", [None, 0.005])
def test_the_window_finds_nothing_in_a_feedhold_nor_when_the_path_goes_on(
    stage: Make, lag_mm: float | None
) -> None:
    """After it the path has to go the start distance again, as behind the start of the block.

    A lag limit of 5 um below the running lag leaves the decision to the window.
    """
    armed = FixedStopSettings(lag_mm, window_mm=0.1, min_time_ns=50 * MS, start_distance_mm=2.0)
    held = range(300, 900)
    free = stage(
        Axis("Z", running_mm=0.02), target={"Z": 9.0}, detect=armed, is_error=False, holds=held
    )
    assert free.finish().record.latched_mm == {}
    # Held at 2.98 mm, armed again from 4.98 on: that is cycle 1100
    stopped = stage(Axis("Z", stop_mm=4.0), target={"Z": 9.0}, detect=armed, holds=held)
    assert stopped.finish().stop.detected_ns == 1100 * MS


def test_in_a_feedhold_an_axis_that_rests_at_a_stop_is_found(stage: Make) -> None:
    """The set value is held 0.02 mm behind the stop; 50 cycles of rest and the time are enough."""
    armed = FixedStopSettings(window_mm=0.01, min_time_ns=50 * MS, start_distance_mm=2.0)
    made = stage(Axis("Z", stop_mm=4.0), target={"Z": 9.0}, detect=armed, holds=range(404, 2000))
    assert made.finish().stop.detected_ns == pytest.approx(455 * MS, abs=2 * MS)
