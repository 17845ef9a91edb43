"""Which axes a run to a fixed stop checks and records, and when a window says nothing."""

from collections.abc import Callable

import pytest
from tests.measuring.fixed_stop.conftest import MS, Axis, Stage

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.fixed_stop.detector import StopDetector
from axisrig.kernel.measuring.fixed_stop.record import Criteria
from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings

Make = Callable[..., Stage]
BOTH = FixedStopSettings(lag_limit_mm=1.0, window_mm=0.1, min_time_ns=50 * MS)


@pytest.mark.parametrize("wrong", ["X", "Y", "Z"])
def test_a_share_above_the_whole_block_is_refused_of_each_axis(stage: Make, wrong: str) -> None:
    detect = {
        name: FixedStopSettings(1.0, start_per_mille=1001 if name == wrong else 1000)
        for name in "XYZ"
    }
    with pytest.raises(Alarm) as refused:
        stage(*map(Axis, "XYZ"), target=dict.fromkeys("XYZ", 10.0), detect=detect)
    assert refused.value.id == 51026
    assert refused.value.values == {"axis": wrong, "value_permille": 1001, "limit_permille": 1000}


def test_a_run_records_its_slaves_beside_its_axes(stage: Make) -> None:
    axes = Axis("X", stop_mm=5.0), Axis("Y")
    made = stage(*axes, target={"X": 20.0}, beside=(Axis("X2"),))
    assert made.run.stop.axes == ("X", "Y", "X2")
    assert made.run.record.axes == ("X", "Y")
    run = made.finish()
    assert set(run.stop.set_mm) == set(run.stop.actual_mm) == {"X", "Y", "X2"}
    assert set(run.record.latched_mm) == {"X", "Y"}


@pytest.mark.parametrize("start_mm", [0.5, 2.0])
@pytest.mark.parametrize("running_mm", [0.0, 0.005])
def test_an_axis_that_follows_a_path_which_slows_down_is_at_no_stop(
    stage: Make, start_mm: float, running_mm: float
) -> None:
    """In the last 200 cycles the way of 50 ms falls below the window of 0.1 mm, and to 0."""
    detect = FixedStopSettings(None, 0.1, 50 * MS, 0, start_mm)
    made = stage(
        Axis("Z", running_mm=running_mm), target={"Z": 6.5}, detect=detect, slowing=200,
        is_error=False,
    )  # fmt: skip
    run = made.finish()
    assert run.stop.window_ns == {}
    assert run.stop.detected_ns is None
    assert run.record.latched_mm == {}


def test_a_window_that_holds_outside_of_the_exact_stop_is_not_named_as_standstill(
    stage: Make,
) -> None:
    """It rests 0.5 mm before its target: its window holds, and its lag is too small."""
    made = stage(Axis("Z", stop_mm=5.0), target={"Z": 5.5}, detect=BOTH)
    with pytest.raises(Alarm) as missed:
        made.finish()
    assert missed.value.id == 900240
    words = str(missed.value.values["criteria"])
    assert "largest lag 0.5000 mm" in words
    assert "standstill" not in words


@pytest.mark.parametrize(("time_us", "holds"), [(2000, True), (2500, False), (3000, False)])
def test_a_window_of_no_whole_number_of_cycles_is_rounded_up(time_us: int, holds: bool) -> None:
    """0.04 mm in a cycle of 1 ms: 0.08 in two are inside of 0.1 mm, 0.12 in three are not."""
    detector = StopDetector(Criteria(None, 0.1, time_us * 1000))
    for cycle in range(10):
        detector.take(cycle * MS, 0.0, 0.04 * cycle, is_armed=True)
    assert (detector.window_ns is not None) is holds


@pytest.mark.parametrize("is_found", [True, False])
def test_the_axes_of_the_motion_are_led_back_and_no_others(stage: Make, is_found: bool) -> None:
    """X moves, Y measures with it: what is led back is where X is, with a stop and without."""
    axes = Axis("X", stop_mm=5.0 if is_found else 1e9, running_mm=0.004), Axis("Y")
    run = stage(*axes, target={"X": 20.0}, is_error=False).finish()
    assert set(run.targets_mm) == {"X"}
    assert run.targets_mm["X"] == pytest.approx(5.0 if is_found else 20.0)
    assert set(run.record.latched_mm) == ({"X", "Y"} if is_found else set())
