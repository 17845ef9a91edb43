"""Effective dynamics: the table of FCT-C4 2.1 row by row, and limits of a path over axes."""

import csv
import itertools
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import axisrig.kernel.motion
from axisrig.kernel.motion.dynamics import (
    CHANNEL_SETTINGS,
    Dynamics,
    Motion,
    axis_slopes,
    effective_row,
    path_dynamics,
)
from axisrig.kernel.motion.profile import Slope, plan
from axisrig.kernel.parameters import ParameterSet

PROFILE = "getriebe[0].lslope_profil"
# Every parameter another value, so that the values tell which parameters act.
VALUES = {
    "a_grenz_stufe_1": 5, "a_grenz_stufe_2": 6, "d_grenz_stufe_1": 280, "d_grenz_stufe_2": 281,
    "a_stufe_1": 11, "a_stufe_2": 12, "d_stufe_1": 282, "d_stufe_2": 283, "a_feedh": 24,
    "vb_grenz_stufe_1_2": 211_000, "vb_stufe_1_2": 221_000,
}  # fmt: skip
RAPID_A, RAPID_D = Slope(5.0, 6.0, 211.0), Slope(280.0, 281.0, 211.0)
FEED_A, FEED_D = Slope(11.0, 12.0, 221.0), Slope(282.0, 283.0, 221.0)
HOLD = Slope(24.0, 24.0, 211.0)


def axis(**more: int) -> ParameterSet:
    parameters = ParameterSet("axis")
    for name, value in (VALUES | more).items():
        parameters.set(f"{PROFILE}.{name}", str(value), "test")
    return parameters


def channel(std_dynamic: int, mode: int, curr_limit: int) -> ParameterSet:
    parameters = ParameterSet("channel")
    for name, value in zip(CHANNEL_SETTINGS, (std_dynamic, mode, curr_limit), strict=True):
        parameters.set(name, str(value), "test")
    return parameters


@pytest.mark.parametrize(
    ("settings", "acceleration", "deceleration", "on_signal"),
    [
        ((0, 0, 0), RAPID_A, RAPID_D, RAPID_D),
        ((0, 0, 1), RAPID_A, RAPID_D, HOLD),
        ((0, 1, 0), RAPID_A, RAPID_D, RAPID_A),
        ((0, 1, 1), RAPID_A, RAPID_D, RAPID_A),
        ((1, 0, 0), FEED_A, FEED_D, HOLD),
        ((1, 0, 1), FEED_A, FEED_D, HOLD),
        ((1, 1, 0), FEED_A, FEED_D, HOLD),
        ((1, 1, 1), FEED_A, FEED_D, HOLD),
    ],
)
def test_measurement_run(
    settings: tuple[int, int, int], acceleration: Slope, deceleration: Slope, on_signal: Slope
) -> None:
    found = axis_slopes(axis(), channel(*settings), Motion.MEASURING)
    assert found.acceleration == acceleration
    assert found.deceleration == deceleration
    assert found.stop_deceleration == on_signal


@pytest.mark.parametrize("curr_limit", [0, 1])
def test_rapid_and_feed_motion(curr_limit: int) -> None:
    rapid = axis_slopes(axis(), channel(0, 0, curr_limit), Motion.RAPID)
    feed = axis_slopes(axis(), channel(0, 0, curr_limit), Motion.FEED)
    assert (rapid.acceleration, rapid.deceleration) == (RAPID_A, RAPID_D)
    assert (feed.acceleration, feed.deceleration) == (FEED_A, FEED_D)
    assert rapid.stop_deceleration == (HOLD if curr_limit else RAPID_D)
    assert feed.stop_deceleration == (HOLD if curr_limit else FEED_D)


@pytest.mark.parametrize(("std_dynamic", "mode"), [*itertools.product((0, 1), (0, 1))])
@pytest.mark.parametrize("motion", Motion)
def test_the_feedhold_of_the_plc_side_is_by_p_chan_00097_alone(
    motion: Motion, std_dynamic: int, mode: int
) -> None:
    """0: the deceleration of the motion; 1: P-AXIS-00024, also where the signal has another."""
    assert axis_slopes(axis(), channel(std_dynamic, mode, 0), motion).feedhold is None
    assert axis_slopes(axis(), channel(std_dynamic, mode, 1), motion).feedhold == HOLD


def test_feedhold_of_0_is_the_smaller_rapid_step() -> None:
    found = axis_slopes(axis(a_feedh=0), channel(1, 0, 0), Motion.MEASURING)
    assert found.stop_deceleration == Slope(5.0, 5.0, 211.0)


def test_rapid_speed_limits_rapid_motion_only() -> None:
    """Documented defaults: 166.666 mm/s rapid, 200 mm/s at most."""
    speeds = {m: axis_slopes(axis(), channel(0, 0, 0), m).speed_max_mm_s for m in Motion}
    assert speeds == {Motion.RAPID: 166.666, Motion.FEED: 200.0, Motion.MEASURING: 200.0}


@pytest.mark.parametrize(
    ("rapid", "highest", "expected"),
    [
        (150_000, 180_000, (150.0, 180.0)),
        (180_000, 150_000, (150.0, 150.0)),  # rapid traverse is no faster than the axis
        (170_000, 170_000, (170.0, 170.0)),
    ],
)
def test_no_motion_is_faster_than_the_axis(
    rapid: int, highest: int, expected: tuple[float, float]
) -> None:
    """P-AXIS-00209 (rapid traverse) and P-AXIS-00212 in um/s."""
    parameters = axis()
    parameters.set("getriebe[0].vb_eilgang", str(rapid), "test")
    parameters.set("getriebe[0].dynamik.vb_max", str(highest), "test")
    found = {m: axis_slopes(parameters, channel(0, 0, 0), m).speed_max_mm_s for m in Motion}
    of_rapid, of_others = expected
    assert found == {Motion.RAPID: of_rapid, Motion.FEED: of_others, Motion.MEASURING: of_others}


@pytest.mark.parametrize("motion", list(Motion))
def test_exactly_one_row_holds_for_every_setting(motion: Motion) -> None:
    for settings in itertools.product((0, 1), repeat=3):
        assert effective_row(channel(*settings), motion)["motion"] == motion


def test_tables_refer_to_each_other() -> None:
    folder = Path(axisrig.kernel.motion.__path__[0])
    with (folder / "slopes.csv").open(encoding="utf-8", newline="") as file:
        slopes = {row["slope"] for row in csv.DictReader(file)}
    with (folder / "measuring_dynamics.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    columns = ("acceleration", "deceleration", "stop_deceleration")
    assert {row[column] for row in rows for column in columns} == slopes


# --- several axes ----------------------------------------------------------------------------


def dynamics(low: float, high: float, change: float, speed: float) -> Dynamics:
    slope = Slope(low, high, change)
    return Dynamics(slope, slope, slope, speed)


def test_path_of_3_4_5_by_hand() -> None:
    """Direction cosines 0.6 and 0.8."""
    x, y = dynamics(600.0, 300.0, 60.0, 120.0), dynamics(1600.0, 200.0, 40.0, 400.0)
    path = path_dynamics([x, y], [3.0, -4.0])
    assert path.acceleration.a_low_mm_s2 == pytest.approx(min(600 / 0.6, 1600 / 0.8))
    assert path.acceleration.a_high_mm_s2 == pytest.approx(min(300 / 0.6, 200 / 0.8))
    assert path.acceleration.change_over_mm_s == pytest.approx(min(60 / 0.6, 40 / 0.8))
    assert path.speed_max_mm_s == pytest.approx(min(120 / 0.6, 400 / 0.8))
    assert path.acceleration == path.deceleration == path.stop_deceleration


def test_axis_that_stands_does_not_limit() -> None:
    x, y = dynamics(1000.0, 500.0, 100.0, 200.0), dynamics(1.0, 1.0, 1.0, 1.0)
    assert path_dynamics([x, y], [-7.0, 0.0]) == x


def test_path_without_motion_is_a_defect() -> None:
    with pytest.raises(ValueError, match="no axis moves"):
        path_dynamics([dynamics(1.0, 1.0, 1.0, 1.0)], [0.0])


LIMITS = st.builds(
    dynamics, st.floats(10, 9000), st.floats(10, 9000), st.floats(1, 300), st.floats(1, 400)
)
DELTAS = st.lists(st.floats(-100, 100).filter(lambda d: abs(d) > 1e-3), min_size=3, max_size=3)


@given(st.lists(LIMITS, min_size=3, max_size=3), DELTAS)
@pytest.mark.long
def test_no_axis_exceeds_its_own_limits(axes: list[Dynamics], deltas: list[float]) -> None:
    length = math.hypot(*deltas)
    path = path_dynamics(axes, deltas)
    profile = plan(length, path.speed_max_mm_s, path.acceleration, path.deceleration)
    for segment in profile.segments:
        for limits, delta in zip(axes, deltas, strict=True):
            share = abs(delta) / length
            speeds = sorted((segment.start_mm_s * share, segment.end_mm_s * share))
            assert speeds[1] <= limits.speed_max_mm_s * (1 + 1e-9)
            change = limits.acceleration.change_over_mm_s
            if speeds[0] < change * (1 - 1e-9):
                allowed = limits.acceleration.a_low_mm_s2
                assert abs(segment.a_mm_s2) * share <= allowed * (1 + 1e-9)
            if speeds[1] > change * (1 + 1e-9):
                allowed = limits.acceleration.a_high_mm_s2
                assert abs(segment.a_mm_s2) * share <= allowed * (1 + 1e-9)


@pytest.mark.parametrize("place", [0, 1])
def test_a_path_holds_with_the_weakest_of_feedholds_and_decelerations(place: int) -> None:
    """In 3-4-5: an axis without a slope of its own for it holds with its deceleration.

    400 / 0.6 and 900 / 0.8, or 800 / 0.6 and 500 / 0.8; an axis that does not move counts nothing.
    """
    brakes, holds = (800.0, 900.0), (400.0, 500.0)
    axes = [
        Dynamics(
            *(Slope(2000.0, 2000.0, 1.0), Slope(brake, brake, 1.0), Slope(3000.0, 3000.0, 1.0)),
            *(100.0, Slope(hold, hold, 1.0) if at == place else None),
        )
        for at, (brake, hold) in enumerate(zip(brakes, holds, strict=True))
    ]
    weak = Slope(1.0, 1.0, 1.0)
    axes.append(Dynamics(weak, weak, weak, 1.0, weak))
    found = path_dynamics(axes, (3.0, -4.0, 0.0))
    assert found.feedhold is not None
    expected = (400.0 / 0.6, 500.0 / 0.8)[place]
    assert found.feedhold.least_mm_s2 == pytest.approx(expected)
    assert found.deceleration.least_mm_s2 == pytest.approx(900.0 / 0.8)
    assert found.acceleration.least_mm_s2 == pytest.approx(2000.0 / 0.8)
    assert found.stop_deceleration.least_mm_s2 == pytest.approx(3000.0 / 0.8)
    assert found.speed_max_mm_s == pytest.approx(100.0 / 0.8)
    others = [axes[1 - place], axes[2]]
    assert path_dynamics(others, (1.0, 0.0)).feedhold is None
