"""Ends of bands, times in whole cycles and ramps; where a tool is frozen and where it turns."""

import math
from typing import Any

import numpy as np
import pytest

from axisrig.bench.oracles.fixed_stop.slopes import slopes_as_written
from axisrig.bench.oracles.fixed_stop.timing import Cycles, Instant, after, later, least_path_mm
from axisrig.bench.oracles.kinematics.chain import Chain
from axisrig.kernel.time.clock import MS, US

SLOPE = "getriebe[0].lslope_profil."


@pytest.mark.parametrize(
    ("low", "high", "hold", "acts"), [(800, 300, 0, 300), (300, 800, 0, 300), (800, 300, 500, 500)]
)
def test_a_feedhold_of_0_is_the_smaller_step_of_the_rapid_acceleration(
    low: int, high: int, hold: int, acts: int
) -> None:
    """P-AXIS-00024."""
    axis = {
        SLOPE + "a_grenz_stufe_1": low, SLOPE + "a_grenz_stufe_2": high, SLOPE + "a_feedh": hold,
    }  # fmt: skip
    for channel in ({"meas_use_std_dynamic": 1}, {"use_drive_curr_limit": 1}):
        found = slopes_as_written(axis, channel).on_signal
        assert (found.low_mm_s2, found.high_mm_s2) == (acts, acts)


@pytest.mark.parametrize(
    ("measured_ns", "is_inside"), [(4, False), (5, True), (10, True), (20, True), (21, False)]
)
def test_a_band_has_both_of_its_ends(measured_ns: int, is_inside: bool) -> None:
    assert Instant(10.0, 5.0, 20.0).holds(measured_ns) is is_inside


@pytest.mark.parametrize(("time_us", "cycles"), [(20_000, 20), (20_400, 21), (1, 1), (0, 0)])
def test_what_has_lasted_moves_the_whole_band_by_whole_cycles(time_us: int, cycles: int) -> None:
    begin = Instant(10.0, 5.0, 20.0, "begin", 3.0)
    found = after(begin, time_us * US, Cycles(MS, (0, 0)), "then")
    more = cycles * MS
    assert found == Instant(10.0 + more, 5.0 + more, 20.0 + more, "then; begin", 3.0)


@pytest.mark.parametrize("turn", [1, -1])
def test_of_two_criteria_the_later_one_has_its_own_doubt(turn: int) -> None:
    early, late = Instant(10.0, 5.0, 30.0, "early", 3.0), Instant(15.0, 4.0, 20.0, "late", 1.0)
    found = later(*(early, late)[::turn])
    assert found == Instant(15.0, 5.0, 30.0, "the later of both criteria: late", 1.0)


@pytest.mark.parametrize(
    ("window_mm", "path_mm"),
    [
        # W/(a tau) + tau/2 below tau: the way from rest is W itself
        (0.1, 0.1), (0.05, 0.05), (0.19, 0.19),
        # a tau^2/2 = 0.2 mm: the last tau of the ramp alone counts from there on
        (0.2, 0.2), (0.4, 0.45), (0.6, 0.8),
    ],
)  # fmt: skip
def test_a_ramp_leaves_a_window_within_its_first_time_or_later(
    window_mm: float, path_mm: float
) -> None:
    """1000 mm/s2, 20 ms."""
    assert least_path_mm(window_mm, 20 * MS, 1000.0) == pytest.approx(path_mm)


# Chains


def extended(*hd_deg: float) -> Chain:
    """A head whose tool of 80 mm is extended: HD2, HD3 and HD4 of kinematic 98."""
    stem = "kin_step[1].trafo[0]."
    written: dict[str, Any] = {"kin_step[0].trafo[0].id": 9, stem + "id": 98}
    written |= {f"{stem}param[{k}]": deg * 1e4 for k, deg in enumerate(hd_deg, start=1)}
    return Chain((9, 98), written, {}, 80.0)


@pytest.mark.parametrize(
    ("hd_deg", "tilt_deg", "held_deg"),
    [
        ((50.0, 70.0, 85.0), 30.0, 50.0), ((50.0, 70.0, 85.0), 50.0, 50.0),
        ((50.0, 70.0, 85.0), 60.0, 60.0), ((50.0, 70.0, 85.0), 70.0, 70.0),
        ((50.0, 70.0, 85.0), 80.0, 70.0),  # frozen from HD3 on
        ((50.0, 0.0, 75.0), 72.0, 72.0), ((50.0, 0.0, 75.0), 80.0, 75.0),  # without it from HD4 on
        ((90.0, 70.0, 85.0), 80.0, 90.0),  # never extended
    ],
)  # fmt: skip
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_tool_is_extended_from_hd2_to_hd3_or_hd4(
    hd_deg: tuple[float, float, float], tilt_deg: float, held_deg: float, side: float
) -> None:
    """cos HD2/cos of the tilt (FCT-M3 12.4.2)."""
    chain = extended(*hd_deg)
    frame = chain.frame(np.array([[0.0, 0.0, 300.0, 25.0, side * tilt_deg]]))
    factor = 1.0
    if hd_deg[0] < 90.0:
        factor = math.cos(math.radians(hd_deg[0])) / math.cos(math.radians(held_deg))
    assert chain.length_mm(frame) == pytest.approx([80.0 * factor])


@pytest.mark.parametrize(
    ("angle_deg", "place_mm"),
    [(0.0, (150.0, 20.0)), (90.0, (100.0, 70.0)), (180.0, (50.0, 20.0)), (-90.0, (100.0, -30.0))],
)
def test_a_rotary_axis_turns_about_its_own_point(
    angle_deg: float, place_mm: tuple[float, float]
) -> None:
    """About Z through (100, 20): what is 50 mm beside it goes round."""
    written = {
        "trafo[0].id": 91, "trafo[0].number_of_axes": 1, "trafo[0].axis[0].type": 2,
        "trafo[0].axis[0].orientation[2]": 1, "trafo[0].axis[0].point[0]": 1_000_000,
        "trafo[0].axis[0].point[1]": 200_000, "trafo[0].zero_position[0]": 1_500_000,
        "trafo[0].zero_position[1]": 200_000, "trafo[0].zero_orientation[2]": 1,
    }  # fmt: skip
    frame = Chain((91,), written, {}, 0.0).frame(np.array([[angle_deg]]))
    assert frame[0, :3, 3] == pytest.approx([*place_mm, 0.0])
