"""Criteria of a run to a fixed stop from lists as written; each row follows the manual by hand."""

import pytest

from axisrig.bench.oracles.fixed_stop.lists import (
    Limits,
    arming_mm,
    delay_cycles,
    limits_as_written,
)

CYCLE_NS = 2_000_000
M, A = "kenngr.measure.fixed_stop_detect.", "antr.fixed_stop.detect."
OLD_LAG, OLD_CYCLES = "kenngr.fixed_stop_pos_lag_limit", "kenngr.fixed_stop_nbr_cycles"


def read(**written: int) -> Limits:
    names = {"m_": M, "a_": A}
    whole = {names.get(key[:2], "kenngr.") + key[2:]: value for key, value in written.items()}
    return limits_as_written(whole, CYCLE_NS)


@pytest.mark.parametrize(
    ("written", "limit_mm"),
    [
        ({}, None),
        ({"m_pos_lag_limit": 15_000}, 1.5),
        ({"m_pos_lag_limit": 0, "a_pos_lag_limit": 20_000}, None),
        ({"m_pos_lag_limit": -1, "a_pos_lag_limit": 20_000}, 2.0),
        ({"a_pos_lag_limit": 20_000, "k_fixed_stop_pos_lag_limit": 3000}, 2.0),
        ({"a_pos_lag_limit": 0, "k_fixed_stop_pos_lag_limit": 3000}, None),
        ({"a_pos_lag_limit": -1, "k_fixed_stop_pos_lag_limit": 3000}, 0.3),
        ({"m_pos_lag_limit": -5, "k_fixed_stop_pos_lag_limit": 0}, None),
    ],
)
def test_lag_limit(written: dict[str, int], limit_mm: float | None) -> None:
    assert read(**written).lag_limit_mm == limit_mm


@pytest.mark.parametrize(
    ("written", "time_ns"),
    [
        ({}, 0),
        ({"m_min_time": 65_400}, 65_400_000),
        ({"m_min_time": 0, "a_min_time": 300}, 300_000),
        ({"a_min_time": 0, "k_fixed_stop_nbr_cycles": 7}, 7 * CYCLE_NS),
        ({"m_min_time": 10, "a_min_time": 20, "k_fixed_stop_nbr_cycles": 7}, 10_000),
    ],
)
def test_minimum_time(written: dict[str, int], time_ns: int) -> None:
    assert read(**written).min_time_ns == time_ns


@pytest.mark.parametrize(
    ("written", "window_mm"),
    [
        ({"m_min_time": 1}, None),
        ({"m_min_time": 1, "m_max_delta_position_window": 500}, 0.05),
        ({"m_min_time": 1, "m_max_delta_position_window": 0}, 0.0),
        (
            {
                "m_min_time": 1,
                "m_max_delta_position_window": -1,
                "a_max_delta_position_window": 20,
            },
            0.002,
        ),
        ({"m_max_delta_position_window": 500}, None),  # without a time it is no criterion
    ],
)
def test_window(written: dict[str, int], window_mm: float | None) -> None:
    assert read(**written).window_mm == window_mm


@pytest.mark.parametrize(
    ("written", "way_mm"),
    [
        ({}, 0.0),
        ({"m_start_distance": 15_000}, 1.5),
        ({"m_start_distance": -1, "a_start_distance": 2_000}, 0.2),
        ({"m_start_distance_per_mille": 200}, 2.0),
        ({"a_start_distance_per_mille": 300}, 3.0),
        ({"m_start_distance_per_mille": -1, "a_start_distance_per_mille": 300}, 3.0),
        ({"m_start_distance": 15_000, "m_start_distance_per_mille": 200}, 1.5),
        ({"m_start_distance": 25_000, "m_start_distance_per_mille": 200}, 2.0),
        ({"m_start_distance": 0, "m_start_distance_per_mille": 200}, 0.0),
        ({"m_start_distance": -1, "m_start_distance_per_mille": 200}, 2.0),
        # the default of P-AXIS-00776 is 0, no negative one: P-AXIS-00771 is not asked
        ({"a_start_distance": 2_000}, 0.0),
        ({"m_start_distance": -1, "a_start_distance": 0}, 0.0),
        ({"m_start_distance": -1, "a_start_distance": -1}, 0.0),
        # a share of 0 is one: only negative ones are not set
        ({"m_start_distance_per_mille": 0}, 0.0),
        ({"m_start_distance": 15_000, "m_start_distance_per_mille": 0}, 0.0),
        ({"m_start_distance": 15_000, "a_start_distance_per_mille": 0}, 0.0),
        ({"m_start_distance_per_mille": 0, "a_start_distance_per_mille": 300}, 0.0),
        ({"m_start_distance": 15_000, "m_start_distance_per_mille": 1000}, 1.5),
        ({"m_start_distance_per_mille": 1000}, 10.0),
        (
            {
                "m_start_distance": 15_000,
                "m_start_distance_per_mille": -1,
                "a_start_distance_per_mille": -7,
            },
            1.5,
        ),
    ],
)
def test_arming_path_of_a_block_of_10_mm(written: dict[str, int], way_mm: float) -> None:
    assert read(**written).arming_mm(10.0) == pytest.approx(way_mm)


def test_over_all_axes_the_smallest_path_counts() -> None:
    axes = [Limits(start_distance_mm=3.0), Limits(per_mille=100.0), Limits(start_distance_mm=2.0)]
    assert arming_mm(axes, 10.0) == pytest.approx(1.0)
    assert arming_mm(axes, None) is None, "the share needs the length of the block"
    assert arming_mm([*axes, Limits()], None) == 0.0, "at once whatever the others say"


def test_a_share_of_zero_arms_at_once_whatever_other_axes_say() -> None:
    axes = [Limits(start_distance_mm=3.0), Limits(per_mille=0.0), Limits(per_mille=500.0)]
    assert [arming_mm(axes[:n], 10.0) for n in (1, 2, 3)] == [3.0, 0.0, 0.0]


def test_a_path_that_is_zero_needs_no_length_of_the_block() -> None:
    assert Limits(start_distance_mm=0.0, per_mille=100.0).arming_mm(None) == 0.0
    assert Limits(start_distance_mm=3.0, per_mille=100.0).arming_mm(None) is None
    assert Limits(start_distance_mm=3.0).arming_mm(None) == 3.0
    assert Limits().arming_mm(None) == 0.0


def test_any_criterion_detects_also_a_window_of_zero() -> None:
    assert not Limits().detects
    assert not Limits(min_time_ns=5, start_distance_mm=1.0, per_mille=3.0).detects
    assert Limits(lag_limit_mm=0.1).detects
    assert Limits(window_mm=0.0).detects


@pytest.mark.parametrize(("written", "cycles"), [(None, 4), (0, 0), (1, 1), (2, 2), (10, 10)])
def test_cycles_of_the_lag_are_four_when_not_set_and_as_written_else(
    written: int | None, cycles: int
) -> None:
    """P-AXIS-00191; docs/ambiguities.md: what is judged takes 0 as 1, what is shown does not."""
    given = {} if written is None else {"antr.nbr_delay_cycles": written}
    assert delay_cycles(given) == cycles


@pytest.mark.parametrize("period_ns", [1_000_000, 4_000_000])
def test_cycles_of_the_old_time_are_those_of_the_position_control(period_ns: int) -> None:
    assert limits_as_written({OLD_CYCLES: 3}, period_ns).min_time_ns == 3 * period_ns
    assert limits_as_written({M + "min_time": 3}, period_ns).min_time_ns == 3000
