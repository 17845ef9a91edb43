"""Parameters of distance control: the reading of the oracles beside that of the kernel.

The report takes what acted in a run from the kernel's settings, programmed values in it; so what
both make of a list has to agree.
"""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from axisrig.bench.machine.recording.distance_log import controller
from axisrig.bench.oracles.distance.lists import Listed, as_written
from axisrig.kernel.distance import DistanceSettings
from axisrig.kernel.parameters import ParameterSet

FILTERS = ("DEFAULT", "MOVING_AVERAGE", "LOWPASS", "KALMAN_MA", "EXPO_MEAN", "KALMAN_EXPO")
wide, positive = st.integers(-1_000_000, 1_000_000), st.integers(1, 1_000_000)
from_0, switch = st.integers(0, 1_000_000), st.sampled_from([0, 1])
weights = st.integers(0, 1999)
VALUES = {
    "n_cycles": st.integers(0, 99), "max_deviation": from_0, "v_max": positive, "a_max": from_0,
    "max_act_value_change": from_0, "max_pos": wide, "min_pos": wide, "tolerance": from_0,
    "mode_dist_use_both_encoder": switch, "use_adaptive_acceleration": switch, "a_min": positive,
    "dist_error_a_min": from_0, "dist_error_a_max": from_0, "low_pass_filter_enable": switch,
    "low_pass_filter_order": st.integers(0, 6), "low_pass_filter_fg_f0": st.integers(0, 400),
    "v_weight_down": weights, "a_weight_down": weights, "kp": st.sampled_from([0.05, 0.3, 1.5]),
    "i_tn": st.sampled_from([0, 0.1, 7.5]), "d_tv": st.sampled_from([0, 0.002, 1]),
    "filter_type": st.sampled_from(FILTERS), "kalman_sigma": from_0,
    "smoothing_factor": st.sampled_from([0.01, 0.5, 1]),
}  # fmt: skip
OLDER = {
    "max_deviation": "max_abweichung",
    "max_act_value_change": "max_istw_sprung",
    "tolerance": "toleranz",
}
lists = st.fixed_dictionaries({}, optional=VALUES)
stems = st.sampled_from(["kenngr.dist_ctrl[0].", "kenngr.distc."])


def read(values: dict[str, object], stem: str, *, german: bool, axis_a: int | None) -> ParameterSet:
    parameters = ParameterSet("axis")
    for name, value in values.items():
        parameters.set(stem + (OLDER.get(name, name) if german else name), str(value), "test")
    if axis_a is not None:
        parameters.set("getriebe[0].dynamik.a_max", str(axis_a), "test")
    return parameters


def limits(listed: Listed) -> tuple[object, ...]:
    found = listed.limits
    return (
        found.v_mm_s, found.a_mm_s2, found.deviation_mm, found.change_mm_s, found.low_mm,
        found.high_mm, found.v_weight, found.a_weight, found.adaptive, listed.uses_both,
    )  # fmt: skip


def limits_of_kernel(of: DistanceSettings) -> tuple[object, ...]:
    adaptive = (of.a_min_mm_s2, of.error_a_min_mm, of.error_a_max_mm)
    return (
        of.v_max_mm_s, of.a_mm_s2, of.max_deviation_mm, of.max_change_mm_s,
        of.min_pos_mm + of.tolerance_mm, of.max_pos_mm - of.tolerance_mm,
        of.v_weight_down_permille, of.a_weight_down_permille,
        adaptive if of.is_adaptive else None, of.both_encoders,
    )  # fmt: skip


def rounded(values: tuple[object, ...]) -> list[object]:
    """Sums and products of a unit in another order differ in the last digit."""
    return [round(value, 9) if isinstance(value, float) else value for value in values]


@settings(max_examples=400, deadline=None)
@given(lists, stems, st.booleans(), st.one_of(st.none(), st.integers(1, 100_000)))
@pytest.mark.long
def test_the_kernel_has_read_the_same(
    values: dict[str, object], stem: str, german: bool, axis_a: int | None
) -> None:
    parameters = read(values, stem, german=german, axis_a=axis_a)
    kernels = DistanceSettings.read(parameters)
    ours = as_written(dict(parameters.items()))
    assert ours.control == controller(kernels).control
    assert rounded(limits(ours)) == rounded(limits_of_kernel(kernels))


def test_without_a_list_both_have_the_same_defaults() -> None:
    parameters = ParameterSet("axis")
    kernels, ours = DistanceSettings.read(parameters), as_written({})
    assert ours.control == controller(kernels).control
    assert rounded(limits(ours)) == rounded(limits_of_kernel(kernels))


@pytest.mark.parametrize("stem", ["kenngr.dist_ctrl[0].", "kenngr.distc."])
@pytest.mark.parametrize(("inverts", "sensor_mm"), [(0, 27.5), (1, -32.5)])
def test_a_sensor_counts_in_its_own_resolution(stem: str, inverts: int, sensor_mm: float) -> None:
    """P-AXIS-00422 of 400 increments for 00423 of 30 000 in 0.1 um: 4000 are 30 mm, 2.5 mm off."""
    listed = as_written({
        "lr_hw[1].encoder_resolution_num": 400, "lr_hw[1].encoder_resolution_denom": 30_000,
        "lr_hw[1].vz_istw": inverts, f"{stem}ref_offset": 25_000,
        "lr_hw[0].encoder_resolution_num": 7, "lr_hw[0].vz_istw": 1 - inverts,
    })  # fmt: skip
    assert listed.sensor_mm(4000) == pytest.approx(sensor_mm)
