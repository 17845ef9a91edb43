"""Each parameter of distance control as a list writes it: unit, name, and which list wins."""

from collections.abc import Mapping
from typing import Any

import pytest

from axisrig.bench.oracles.distance.lists import (
    NEWER,
    OF_AXIS,
    OF_CHANNEL,
    OLDER,
    Control,
    Listed,
    as_written,
    axis_limits,
    cycles_of,
)

CHANNEL = OF_CHANNEL[0]
STEMS = pytest.mark.parametrize(
    ("stem", "stems"),
    [(NEWER, OF_AXIS), (OLDER, OF_AXIS), (CHANNEL, OF_CHANNEL)],
    ids=["newer", "older", "channel"],
)
MS = 1_000_000


def listed(stem: str, stems: tuple[str, ...], **values: object) -> Listed:
    return as_written({stem + name: value for name, value in values.items()}, stems)


LIMITS = {
    # In the list, what is meant: um/s, 0.1 um, mm/s2, per mille
    "v_max": (30_000, "v_mm_s", 30.0),
    "a_max": (700, "a_mm_s2", 700.0),
    "max_deviation": (25_000, "deviation_mm", 2.5),
    "max_act_value_change": (8000, "change_mm_s", 8.0),
    "min_pos": (-12_500, "low_mm", -1.25),
    "max_pos": (17_500, "high_mm", 1.75),
    "v_weight_down": (300, "v_weight", 300.0),
    "a_weight_down": (400, "a_weight", 400.0),
}
CONTROL = {
    "kp": (0.3, "kp", 0.3),
    "i_tn": (0.5, "tn_s", 0.5),
    "d_tv": (0.02, "tv_s", 0.02),
    "filter_type": ("KALMAN_MA", "filter_type", "KALMAN_MA"),
    "n_cycles": (7, "count", 7),
    "smoothing_factor": (0.25, "alpha", 0.25),
    "low_pass_filter_order": (2, "order", 2),
    "low_pass_filter_fg_f0": (40, "corner_hz", 40.0),
    "kalman_sigma": (500, "sigma_mm", 0.05),
}


@STEMS
@pytest.mark.parametrize("name", LIMITS)
def test_a_limit_has_its_unit_and_changes_no_other(
    name: str, stem: str, stems: tuple[str, ...]
) -> None:
    value, field, meant = LIMITS[name]
    found, usual = listed(stem, stems, **{name: value}), as_written({}, stems)
    expected = {**vars(usual.limits), field: pytest.approx(meant)}
    assert vars(found.limits) == expected
    assert found.control == usual.control


@STEMS
@pytest.mark.parametrize("name", CONTROL)
def test_a_value_of_the_controller_changes_no_other(
    name: str, stem: str, stems: tuple[str, ...]
) -> None:
    value, field, meant = CONTROL[name]
    found = listed(stem, stems, **{name: value})
    assert vars(found.control) == {**vars(Control()), field: pytest.approx(meant)}
    assert found.limits == as_written({}, stems).limits


@STEMS
@pytest.mark.parametrize(
    ("german", "value", "field", "meant"),
    [
        ("max_abweichung", 25_000, "deviation_mm", 2.5),
        ("max_istw_sprung", 8000, "change_mm_s", 8.0),
    ],
)
def test_a_limit_has_a_german_name_too(
    german: str, value: int, field: str, meant: float, stem: str, stems: tuple[str, ...]
) -> None:
    found = listed(stem, stems, **{german: value}).limits
    assert vars(found) == {**vars(as_written({}, stems).limits), field: meant}


@STEMS
@pytest.mark.parametrize("name", ["tolerance", "toleranz"])
def test_a_tolerance_is_taken_off_both_ends_of_the_sensor(
    name: str, stem: str, stems: tuple[str, ...]
) -> None:
    found = listed(stem, stems, min_pos=-12_500, max_pos=17_500, **{name: 2500}).limits
    assert (found.low_mm, found.high_mm) == pytest.approx((-1.0, 1.5))


@STEMS
@pytest.mark.parametrize("tolerance", [0, 2500, 50_000])
def test_a_tolerance_changes_nothing_but_the_ends_of_the_sensor(
    tolerance: int, stem: str, stems: tuple[str, ...]
) -> None:
    usual, found = as_written({}, stems).limits, listed(stem, stems, tolerance=tolerance).limits
    ends = {"low_mm": -5.0 + tolerance / 1e4, "high_mm": 5.0 - tolerance / 1e4}
    assert vars(found) == {**vars(usual), **ends}


@pytest.mark.parametrize(
    ("newer", "older", "change_mm_s"),
    [
        ("max_act_value_change", "max_istw_sprung", 7.0),
        ("max_istw_sprung", "max_act_value_change", 7.0),
        ("max_istw_sprung", "max_istw_sprung", 7.0),
    ],
)
def test_the_newer_structure_wins_whatever_its_word(
    newer: str, older: str, change_mm_s: float
) -> None:
    """Also in the reverse order of the list."""
    written = {NEWER + newer: 7000, OLDER + older: 9000}
    for order in (1, -1):
        found = as_written(dict([*written.items()][::order]))
        assert found.limits.change_mm_s == change_mm_s


def test_a_zero_of_the_newer_structure_is_a_value() -> None:
    written = {
        NEWER + "d_tv": 0,
        OLDER + "d_tv": 0.5,
        NEWER + "tolerance": 0,
        OLDER + "toleranz": 9,
    }
    found = as_written(written)
    assert found.control.tv_s == 0.0
    assert found.limits.high_mm == 5.0


def test_a_text_of_the_newer_structure_wins() -> None:
    written = {OLDER + "filter_type": "LOWPASS", NEWER + "filter_type": "EXPO_MEAN"}
    assert as_written(written).control.filter_type == "EXPO_MEAN"


AXIS_A = "getriebe[0].dynamik.a_max"


@pytest.mark.parametrize(
    ("written", "stems", "a_mm_s2"),
    [
        ({}, OF_AXIS, 1000.0),
        ({AXIS_A: 2500}, OF_AXIS, 2500.0),
        ({AXIS_A: 2500, NEWER + "a_max": 0}, OF_AXIS, 2500.0),
        ({AXIS_A: 2500, OLDER + "a_max": 0}, OF_AXIS, 2500.0),
        ({AXIS_A: 2500, OLDER + "a_max": 700}, OF_AXIS, 700.0),
        ({NEWER + "a_max": 0}, OF_AXIS, 1000.0),
        ({}, OF_CHANNEL, 1.0),
        ({CHANNEL + "a_max": 0}, OF_CHANNEL, 1.0),
        ({AXIS_A: 2500}, OF_CHANNEL, 1.0),
        ({AXIS_A: 2500, CHANNEL + "a_max": 0}, OF_CHANNEL, 1.0),
        ({AXIS_A: 2500, CHANNEL + "a_max": 700}, OF_CHANNEL, 700.0),
    ],
)
def test_an_acceleration_of_0_is_that_of_the_axis_and_of_the_channel_the_least(
    written: Mapping[str, object], stems: tuple[str, ...], a_mm_s2: float
) -> None:
    """P-AXIS-00414 and P-AXIS-00008; docs/distance-3d.md."""
    assert as_written(written, stems).limits.a_mm_s2 == a_mm_s2


@STEMS
@pytest.mark.parametrize(
    ("chosen", "acting"),
    [
        (None, "LOWPASS"),
        ("DEFAULT", "LOWPASS"),
        ("MOVING_AVERAGE", "MOVING_AVERAGE"),
        ("EXPO_MEAN", "EXPO_MEAN"),
        ("KALMAN_MA", "KALMAN_MA"),
        ("KALMAN_EXPO", "KALMAN_EXPO"),
        ("LOWPASS", "LOWPASS"),
    ],
)
def test_the_older_switch_is_for_a_filter_that_nobody_has_chosen(
    chosen: str | None, acting: str, stem: str, stems: tuple[str, ...]
) -> None:
    values: dict[str, Any] = {} if chosen is None else {"filter_type": chosen}
    on = listed(stem, stems, low_pass_filter_enable=1, **values)
    off = listed(stem, stems, low_pass_filter_enable=0, **values)
    assert on.control.filter_type == acting
    assert off.control.filter_type == (chosen or "DEFAULT")


@STEMS
@pytest.mark.parametrize(
    ("values", "adaptive"),
    [
        ({}, (500.0, 0.1, 0.5)),
        ({"a_min": 40}, (40.0, 0.1, 0.5)),
        ({"dist_error_a_min": 3000}, (500.0, 0.3, 0.5)),
        ({"dist_error_a_max": 7000}, (500.0, 0.1, 0.7)),
    ],
)
def test_an_adaptive_acceleration_has_its_least_one_and_two_errors(
    values: dict[str, object],
    adaptive: tuple[float, float, float],
    stem: str,
    stems: tuple[str, ...],
) -> None:
    on = listed(stem, stems, use_adaptive_acceleration=1, **values)
    assert on.limits.adaptive == pytest.approx(adaptive)
    for off in ({"use_adaptive_acceleration": 0}, {}):
        assert listed(stem, stems, **off, **values).limits.adaptive is None


@STEMS
@pytest.mark.parametrize(
    ("name", "field"),
    [("optimized_scheduling", "is_optimized"), ("mode_dist_use_both_encoder", "uses_both")],
)
def test_a_switch_of_a_list_is_off_without_a_word(
    name: str, field: str, stem: str, stems: tuple[str, ...]
) -> None:
    others = {"is_optimized", "uses_both"} - {field}
    for value, is_on in ((None, False), (0, False), (1, True)):
        found = vars(listed(stem, stems, **({} if value is None else {name: value})))
        assert found[field] is is_on
        assert [found[other] for other in others] == [False]


@STEMS
def test_a_reference_offset_is_taken_off_the_sensor(stem: str, stems: tuple[str, ...]) -> None:
    found = listed(stem, stems, ref_offset=-15_000)
    assert found.ref_offset_mm == -1.5
    assert found.sensor_mm(20_000) == pytest.approx(3.5)  # an increment is 0.1 um


def test_words_of_the_other_list_do_not_count() -> None:
    written = {CHANNEL + "kp": 0.3, NEWER + "kp": 0.4}
    assert as_written(written).control.kp == 0.4
    assert as_written(written, OF_CHANNEL).control.kp == 0.3
    assert as_written({CHANNEL + "kp": 0.3}).control.kp == 1.0
    assert as_written({NEWER + "kp": 0.4}, OF_CHANNEL).control.kp == 1.0


def test_what_a_rig_has_chosen_changes_the_law_alone() -> None:
    class Rig:
        derivative_of, limiter, derivative = "error", "clamp", "per_cycle"

    found = as_written({NEWER + "kp": 0.3, NEWER + "d_tv": 0.02})
    chosen = found.choosing(Rig())
    assert (chosen.control.kp, chosen.control.tv_s) == (0.3, 0.02)
    assert chosen.control.looks_at_error
    assert not chosen.control.is_sloped
    assert chosen.control.rate(2 * MS) == pytest.approx(0.02)
    assert (chosen.limits, chosen.sign) == (found.limits, found.sign)
    assert not found.control.looks_at_error
    assert found.control.is_sloped


@pytest.mark.parametrize(
    ("period_ns", "integral", "rate"), [(MS, 0.002, 20.0), (4 * MS, 0.008, 5.0)]
)
def test_times_of_a_controller_are_divided_by_the_cycle(
    period_ns: int, integral: float, rate: float
) -> None:
    control = Control(tn_s=0.5, tv_s=0.02)
    assert control.integral(period_ns) == pytest.approx(integral)
    assert control.rate(period_ns) == pytest.approx(rate)
    assert Control().integral(period_ns) == Control().rate(period_ns) == 0.0


@pytest.mark.parametrize(("time_s", "cycles"), [(0.012, 6.0), (0.003, 1.5), (0.0, 0.0)])
def test_a_time_in_cycles_is_not_rounded(time_s: float, cycles: float) -> None:
    assert cycles_of(time_s, 2 * MS) == pytest.approx(cycles)


def test_an_acceleration_of_0_leaves_an_axis_its_ramps() -> None:
    """P-AXIS-00008 of 0 says nothing; of the ramps 00005 and 00006 the lesser counts."""
    ramp = "getriebe[0].lslope_profil.a_grenz_stufe_"
    for first, second in ((900, 1200), (1200, 900)):
        written = {AXIS_A: 0, f"{ramp}1": first, f"{ramp}2": second}
        assert axis_limits(written)[1] == 900.0
