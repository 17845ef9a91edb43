"""The slopes of a measurement run: by hand, by a sum over the motion, and beside the kernel's."""

import itertools
import math

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from axisrig.bench.oracles.fixed_stop.slopes import Slope, has_ramps, slopes_as_written
from axisrig.kernel.motion.dynamics import Motion, axis_slopes
from axisrig.kernel.motion.profile import Slope as KernelSlope
from axisrig.kernel.parameters import ParameterSet

PROFILE = "getriebe[0].lslope_profil"
# Every parameter has another value, so that a value says which parameter acts
VALUES = {
    "a_grenz_stufe_1": 5, "a_grenz_stufe_2": 6, "d_grenz_stufe_1": 280, "d_grenz_stufe_2": 281,
    "a_stufe_1": 11, "a_stufe_2": 12, "d_stufe_1": 282, "d_stufe_2": 283, "a_feedh": 24,
    "vb_grenz_stufe_1_2": 211_000, "vb_stufe_1_2": 221_000,
}  # fmt: skip
SWITCHES = ("meas_use_std_dynamic", "meas_deceleration_mode", "use_drive_curr_limit")
RAPID, FEED = Slope(5.0, 6.0, 211.0), Slope(11.0, 12.0, 221.0)
RAPID_DOWN, HOLD = Slope(280.0, 281.0, 211.0), Slope(24.0, 24.0, 211.0)


def listed(**values: int) -> dict[str, object]:
    return {f"{PROFILE}.{name}": value for name, value in values.items()}


@pytest.mark.parametrize(
    ("switches", "up", "on_signal"),
    [
        ((0, 0, 0), RAPID, RAPID_DOWN),
        ((0, 0, 1), RAPID, HOLD),
        ((0, 1, 0), RAPID, RAPID),
        ((0, 1, 1), RAPID, RAPID),
        ((1, 0, 0), FEED, HOLD),
        ((1, 0, 1), FEED, HOLD),
        ((1, 1, 0), FEED, HOLD),
        ((1, 1, 1), FEED, HOLD),
    ],
)
def test_the_table_of_the_manual(
    switches: tuple[int, int, int], up: Slope, on_signal: Slope
) -> None:
    """FCT-C4 2.1, second table."""
    found = slopes_as_written(listed(**VALUES), dict(zip(SWITCHES, switches, strict=True)))
    assert (found.up, found.on_signal) == (up, on_signal)


def test_lists_that_are_silent_have_the_defaults_of_the_manual() -> None:
    found = slopes_as_written({}, {})
    assert found.up == found.on_signal == Slope(1000.0, 1000.0, 100.0)


def test_a_deceleration_of_0_is_the_acceleration_of_its_step() -> None:
    axis = listed(**(VALUES | {"d_grenz_stufe_2": 0}))
    assert slopes_as_written(axis, {}).on_signal == Slope(280.0, 6.0, 211.0)


def test_a_feedhold_of_0_is_the_smaller_rapid_step() -> None:
    axis = listed(**(VALUES | {"a_feedh": 0}))
    found = slopes_as_written(axis, {"use_drive_curr_limit": True})
    assert found.on_signal == Slope(5.0, 5.0, 211.0)


def test_way_of_both_steps_by_hand() -> None:
    """20 mm/s with 100 mm/s2 are 2 mm; on to 60 mm/s with 400 mm/s2 are 4 mm more."""
    slope = Slope(100.0, 400.0, 20.0)
    assert slope.way_mm(10.0) == 0.5
    assert slope.way_mm(20.0) == 2.0
    assert slope.way_mm(60.0) == 6.0


@pytest.mark.long
@given(st.floats(10.0, 1e5), st.floats(10.0, 1e5), st.floats(1.0, 1000.0), st.floats(0.1, 1000.0))
def test_way_is_the_sum_of_the_motion(
    low_mm_s2: float, high_mm_s2: float, change_mm_s: float, speed_mm_s: float
) -> None:
    """The trapezoids under the speed are exact where each ends at a change of the acceleration."""
    corners = sorted({0.0, min(change_mm_s, speed_mm_s), speed_mm_s})
    way_mm = 0.0
    for below, above in itertools.pairwise(corners):
        rate_mm_s2 = low_mm_s2 if above <= change_mm_s else high_mm_s2
        time_s = (above - below) / rate_mm_s2
        way_mm += time_s * (below + above) / 2.0
    assert math.isclose(Slope(low_mm_s2, high_mm_s2, change_mm_s).way_mm(speed_mm_s), way_mm)


rates = st.one_of(st.none(), st.integers(1, 100_000))
rates_or_0 = st.one_of(st.none(), st.just(0), st.integers(1, 100_000))
speeds_um_s = st.one_of(st.none(), st.integers(1, 1_000_000))
axis_lists = st.fixed_dictionaries(
    {
        name: rates_or_0 if name[0] == "d" or name == "a_feedh" else rates
        for name in VALUES
        if not name.startswith("vb")
    }
    | {"vb_grenz_stufe_1_2": speeds_um_s, "vb_stufe_1_2": speeds_um_s}
)
channel_lists = st.fixed_dictionaries({name: st.sampled_from([None, 0, 1]) for name in SWITCHES})


def parameters(kind: str, values: dict[str, int | None], stem: str = "") -> ParameterSet:
    found = ParameterSet("axis" if kind == "axis" else "channel")
    for name, value in values.items():
        if value is not None:
            found.set(stem + name, str(value), "test")
    return found


def same(ours: Slope, kernels: KernelSlope, speed_mm_s: float) -> bool:
    numbers = (kernels.a_low_mm_s2, kernels.a_high_mm_s2, kernels.change_over_mm_s)
    return (ours.low_mm_s2, ours.high_mm_s2, ours.change_over_mm_s) == numbers and math.isclose(
        ours.way_mm(speed_mm_s), kernels.distance_mm(speed_mm_s), rel_tol=1e-12
    )


@settings(max_examples=500, deadline=None)
@given(axis_lists, channel_lists, st.floats(0.001, 2000.0))
@example(dict.fromkeys(VALUES), dict.fromkeys(SWITCHES), 100.0)
@pytest.mark.long
def test_the_kernel_has_derived_the_same(
    axis_list: dict[str, int | None], channel_list: dict[str, int | None], speed_mm_s: float
) -> None:
    """Two readings of lists and manuals, each without the other, with what lists leave out."""
    axis = parameters("axis", axis_list, f"{PROFILE}.")
    channel = parameters("channel", channel_list)
    kernels = axis_slopes(axis, channel, Motion.MEASURING)
    ours = slopes_as_written(dict(axis.items()), dict(channel.items()))
    assert same(ours.up, kernels.acceleration, speed_mm_s)
    assert same(ours.on_signal, kernels.stop_deceleration, speed_mm_s)


def test_what_is_here_holds_for_the_linear_slope_only() -> None:
    assert not has_ramps({})
    assert [has_ramps({"prog_start.slope.profile": value}) for value in range(3)] == [
        False,
        True,
        True,
    ]
