"""One run to a fixed stop with axes of a closed form: 10 mm/s are 0.01 mm in a cycle of 1 ms."""

from collections.abc import Callable

import pytest
from tests.measuring.fixed_stop.conftest import MS, Axis, Stage

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.fixed_stop.record import Criteria
from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.measuring.run import Order

Make = Callable[..., Stage]


def test_a_whole_run(stage: Make) -> None:
    """The set value of cycle k is k / 100 mm, the run sees it in k + 1: 6.01 in cycle 602."""
    made = stage(Axis("Z", stop_mm=5.0), target={"Z": 20.0})
    run = made.finish()
    stop = run.stop
    assert [order for _, order in made.orders] == [Order.START, Order.BRAKE, Order.RELAX]
    assert (stop.watch_off_ns, run.record.start_ns, stop.armed_ns) == (MS, MS, 2 * MS)
    assert stop.criteria == {"Z": Criteria(1.0, None, 50 * MS)}
    assert stop.beyond_ns == {"Z": 602 * MS}
    assert stop.detected_ns == run.record.signal_ns == 652 * MS == made.at(Order.BRAKE) * MS
    assert (stop.detected_by, stop.window_ns) == ("Z", {})
    assert stop.set_mm == {"Z": pytest.approx(6.51)}
    assert stop.actual_mm == run.record.latched_mm == {"Z": 5.0}
    # Three more cycles of motion, the fourth has no way left
    assert stop.brake_end_ns == stop.relax_begin_ns == 655 * MS
    assert run.targets_mm == {"Z": 5.0}
    # 1.54 mm back
    assert stop.relax_end_ns == stop.watch_on_ns == run.record.end_ns == (655 + 154) * MS
    assert made.axes["Z"].set_mm == 5.0


def test_the_lag_is_not_monitored_from_the_start_to_the_end(stage: Make) -> None:
    slave, made = Axis("X2"), None
    made = stage(Axis("X", stop_mm=5.0), target={"X": 20.0}, beside=(slave,))
    watched = []
    while not made.run.is_done:
        made.step()
        watched.append((made.axes["X"].watches_lag, slave.watches_lag))
    assert watched[:-1] == [(False, False)] * (len(watched) - 1)
    assert watched[-1] == (True, True)


@pytest.mark.parametrize("after", [0, 1, 100, 640, 655, 660])
def test_an_abort_at_any_time_brings_the_monitoring_back_and_no_value(
    stage: Make, after: int
) -> None:
    made = stage(Axis("Z", stop_mm=5.0), target={"Z": 20.0})
    for _ in range(after):
        made.step()
    made.run.abort()
    assert made.run.is_done
    assert made.axes["Z"].watches_lag
    assert made.run.record.latched_mm == {}
    assert made.run.stop.watch_on_ns == (after * MS if after else None)


def test_the_first_axis_ends_the_run_and_every_axis_goes_back_to_its_own_place(
    stage: Make,
) -> None:
    """X stops at 5, Y runs on with 0.05 mm of lag; a third one only stands and is not led."""
    axes = Axis("X", stop_mm=5.0), Axis("Y", running_mm=0.05), Axis("Z", actual_mm=0.005)
    made = stage(*axes, target={"X": 20.0, "Y": 20.0})
    run = made.finish()
    assert run.stop.detected_by == "X"
    y_mm = run.stop.set_mm["Y"] - 0.05
    assert run.record.latched_mm == {"X": 5.0, "Y": pytest.approx(y_mm), "Z": 0.005}
    assert run.targets_mm == {"X": 5.0, "Y": pytest.approx(y_mm)}
    assert run.record.has_signal


def test_of_two_axes_in_one_cycle_the_first_of_the_channel_is_named(stage: Make) -> None:
    axes = Axis("X", stop_mm=5.0), Axis("Y", stop_mm=5.0)
    assert stage(*axes, target={"X": 20.0, "Y": 20.0}).finish().stop.detected_by == "X"


@pytest.mark.parametrize(
    ("settings", "armed_mm"),
    [
        ((30_000, None), 3.0),
        ((30_000, 100), 1.0 * 2**0.5),
        ((None, 500), 5.0 * 2**0.5),
        ((0, 500), 0.0),
    ],
)
def test_the_smallest_way_of_all_axes_arms_them_all(
    stage: Make, settings: tuple[int | None, int | None], armed_mm: float
) -> None:
    """The path of 10 and 10 mm is 14.1 mm long; shares are of the path."""
    start, share = settings
    one = FixedStopSettings(1.0, start_distance_mm=None if start is None else start / 1e4)
    other = FixedStopSettings(1.0, start_per_mille=share)
    ways = {"X": one, "Y": other}
    if start is None or share is None:
        ways = dict.fromkeys("XY", one if share is None else other)
    made = stage(Axis("X"), Axis("Y"), target={"X": 10.0, "Y": 10.0}, detect=ways)
    assert made.run.stop.start_distance_mm == pytest.approx(armed_mm)
    while made.run.stop.armed_ns is None:
        before_mm = made.travelled_mm
        made.step()
    # The path that the interpolation has travelled when the cycle begins
    assert before_mm >= armed_mm - 1e-9 > before_mm - 0.011


def test_an_axis_without_a_way_of_its_own_arms_at_once(stage: Make) -> None:
    """Nothing set is 0, and the smallest of all axes counts."""
    far = FixedStopSettings(1.0, start_distance_mm=8.0)
    detect = {"X": far, "Y": FixedStopSettings(1.0)}
    made = stage(Axis("X"), Axis("Y"), target={"X": 10.0, "Y": 10.0}, detect=detect)
    assert made.run.stop.start_distance_mm == 0.0


def test_a_stop_before_the_arming_is_found_behind_it(stage: Make) -> None:
    """The set value passes 12 mm in cycle 1202; the lag is long beyond its limit."""
    armed = FixedStopSettings(1.0, min_time_ns=50 * MS, start_distance_mm=12.0)
    run = stage(Axis("Z", stop_mm=5.0), target={"Z": 20.0}, detect=armed).finish()
    assert run.stop.armed_ns == 1201 * MS
    assert run.stop.beyond_ns == {"Z": 1201 * MS}
    assert run.stop.detected_ns == 1251 * MS
    assert run.record.latched_mm == {"Z": 5.0}


# Nothing found


@pytest.mark.provokes(900240, 4, axes="Z")
def test_900240_at_the_target_without_a_stop(stage: Make) -> None:
    made = stage(Axis("Z", running_mm=0.25), target={"Z": 2.0})
    with pytest.raises(Alarm) as caught:
        made.finish()
    assert caught.value.values == {
        "axes": "Z",
        "criteria": "Z lag > 1 mm, no window, min_time 50 ms, largest lag 0.2500 mm, "
        "at rest with 0.0000 mm",
    }


@pytest.mark.parametrize(
    ("detect", "found"),
    [
        (FixedStopSettings(), "Z no criterion active (no lag limit and no window)"),
        (
            FixedStopSettings(window_mm=0.01),
            "Z no criterion active (no lag limit, and min_time 0 for its window of 0.01 mm)",
        ),
        (FixedStopSettings(9.0), "Z lag > 9 mm, no window, min_time 0 ms, largest lag 5"),
        (
            FixedStopSettings(1.0, 0.02, 50 * MS, start_distance_mm=30.0),
            "Z lag > 1 mm, window 0.02 mm, min_time 50 ms, never judged: "
            "only from 30 mm on and the path was 10 mm",
        ),
    ],
)
@pytest.mark.provokes(900240, 4, axes="Z")
def test_900240_says_what_was_looked_for(
    stage: Make, detect: FixedStopSettings, found: str
) -> None:
    made = stage(Axis("Z", stop_mm=5.0), target={"Z": 10.0}, detect=detect)
    with pytest.raises(Alarm) as caught:
        made.finish()
    assert str(caught.value.values["criteria"]).startswith(found)


@pytest.mark.provokes(900240, 4, axes="Z")
def test_900240_says_that_standing_in_the_exact_stop_window_is_no_stop(stage: Make) -> None:
    detect = FixedStopSettings(None, 0.02, 50 * MS, start_distance_mm=1.0)
    made = stage(Axis("Z"), target={"Z": 2.0}, detect=detect)
    with pytest.raises(Alarm) as caught:
        made.finish()
    found = str(caught.value.values["criteria"])
    assert "at rest with 0.0000 mm, inside its exact-stop window of" in found
    assert "(P-AXIS-00236), where standstill is no stop" in found


@pytest.mark.parametrize("stop_mm", [5.0, 1e9])
def test_by_p_chan_00266_the_axes_go_to_where_they_are(stage: Make, stop_mm: float) -> None:
    """A lag of 5 mm is too little here: no value, and the lag is taken away all the same."""
    made = stage(
        Axis("Z", stop_mm), target={"Z": 10.0}, detect=FixedStopSettings(7.0), is_error=False
    )
    run = made.finish()
    assert run.targets_mm == {"Z": min(stop_mm, 10.0)}
    assert (run.record.latched_mm, run.record.signal_ns, run.stop.detected_ns) == ({}, None, None)
    assert run.stop.watch_on_ns == run.record.end_ns is not None
    assert abs(made.axes["Z"].lag_mm) < 0.01
