"""What parameter lists say about a fixed stop. By hand: FCT-C4 8.2.2, TF5200 axis parameters."""

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.fixed_stop.record import Criteria
from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.parameters import Origin, ParameterSet

MS = 1_000_000
BLOCK_MM = 200.0
KENNGR, ANTR = "kenngr.measure.fixed_stop_detect", "antr.fixed_stop.detect"
NUMBERS = {
    774: f"{KENNGR}.pos_lag_limit",
    775: f"{KENNGR}.min_time",
    776: f"{KENNGR}.start_distance",
    777: f"{KENNGR}.start_distance_per_mille",
    778: f"{KENNGR}.max_delta_position_window",
    769: f"{ANTR}.pos_lag_limit",
    770: f"{ANTR}.min_time",
    771: f"{ANTR}.start_distance",
    772: f"{ANTR}.start_distance_per_mille",
    773: f"{ANTR}.max_delta_position_window",
    331: "kenngr.fixed_stop_pos_lag_limit",
    332: "kenngr.fixed_stop_nbr_cycles",
}


def read(values: dict[int, int]) -> FixedStopSettings:
    """Settings of a list that sets parameters by the ends of their numbers."""
    axis = ParameterSet("axis")
    for line, (number, value) in enumerate(values.items(), 1):
        axis.load(NUMBERS[number], str(value), Origin("axis.lst", line))
    return FixedStopSettings.read(axis)


@pytest.mark.parametrize(
    ("values", "limit_mm"),
    [
        ({}, None),
        ({774: 15000}, 1.5),
        ({774: 15000, 769: 20000, 331: 30000}, 1.5),
        ({774: -1, 769: 20000, 331: 30000}, 2.0),
        ({769: 20000}, 2.0),
        ({774: -1, 769: -1, 331: 30000}, 3.0),
        ({331: 30000}, 3.0),
        ({774: -7, 769: -7}, None),
        # 0 switches the lag off, whatever is behind it
        ({774: 0, 769: 20000, 331: 30000}, None),
        ({774: -1, 769: 0, 331: 30000}, None),
        ({774: -1, 769: -1, 331: 0}, None),
        ({331: 0}, None),
    ],
)
def test_lag_limit(values: dict[int, int], limit_mm: float | None) -> None:
    assert read(values).criteria(MS).lag_limit_mm == limit_mm


@pytest.mark.parametrize(
    ("values", "period_ns", "time_ns"),
    [
        ({}, MS, 0),
        ({775: 50_000, 770: 60_000, 332: 70}, MS, 50 * MS),
        ({775: 0, 770: 60_000, 332: 70}, MS, 60 * MS),
        ({332: 70}, MS, 70 * MS),
        ({332: 70}, 2 * MS, 140 * MS),
        ({770: 60_000}, 2 * MS, 60 * MS),
    ],
)
def test_minimum_time(values: dict[int, int], period_ns: int, time_ns: int) -> None:
    assert read(values).criteria(period_ns).min_time_ns == time_ns


@pytest.mark.parametrize(
    ("values", "window_mm"),
    [
        ({}, None),
        ({778: 20, 773: 30}, 0.002),
        ({778: -1, 773: 30}, 0.003),
        ({773: 30}, 0.003),
        ({778: -1, 773: -1}, None),
        # 0 is a window that allows no motion at all
        ({778: 0, 773: 30}, 0.0),
        ({778: -1, 773: 0}, 0.0),
    ],
)
def test_window(values: dict[int, int], window_mm: float | None) -> None:
    assert read({**values, 775: 50_000}).criteria(MS).window_mm == window_mm


def test_a_window_without_a_time_is_no_criterion() -> None:
    """|x(t) - x(t - 0)| is 0 always: it would find a stop in the first cycle."""
    assert read({778: 20}).criteria(MS) == Criteria(None, None, 0)


@pytest.mark.parametrize(
    ("values", "start_mm"),
    [
        ({}, 0.0),
        ({776: 300_000}, 30.0),
        ({776: 300_000, 771: 400_000}, 30.0),
        ({776: -1, 771: 400_000}, 40.0),
        ({776: -1, 771: -1}, 0.0),
        ({776: -1}, 0.0),
        # P-AXIS-00771 is asked for below 0 only, and 0 is the default of P-AXIS-00776
        ({771: 400_000}, 0.0),
        ({777: 500}, 100.0),
        ({777: 500, 772: 250}, 100.0),
        ({777: -1, 772: 250}, 50.0),
        ({772: 250}, 50.0),
        ({777: -1, 772: -1}, 0.0),
        ({777: 0}, 0.0),
        ({777: 1000}, 200.0),
        # Of both the smaller, of what is set
        ({776: 300_000, 777: 500}, 30.0),
        ({776: 3_000_000, 777: 500}, 100.0),
        ({776: -1, 777: 500}, 100.0),
        ({776: -1, 771: 400_000, 777: 500}, 40.0),
        ({776: 0, 777: 500}, 0.0),
        ({776: -1, 771: 0, 777: 500}, 0.0),
        ({776: 300_000, 777: 0}, 0.0),
    ],
)
def test_path_before_the_stop_is_looked_for(values: dict[int, int], start_mm: float) -> None:
    assert read(values).start_mm(BLOCK_MM) == pytest.approx(start_mm, abs=1e-12)


@pytest.mark.parametrize(
    ("values", "permille"),
    [({777: 1001}, 1001), ({777: -1, 772: 1001}, 1001), ({777: 2000, 772: 10}, 2000)],
)
@pytest.mark.provokes(51026, 2, axis="Z", limit_permille=1000)
def test_51026_for_more_than_the_whole_block(values: dict[int, int], permille: int) -> None:
    with pytest.raises(Alarm) as caught:
        read(values).check("Z")
    assert caught.value.values["value_permille"] == permille


@pytest.mark.parametrize("values", [{777: 1000}, {777: 10, 772: 1001}, {}])
def test_no_51026_for_a_part_of_the_block(values: dict[int, int]) -> None:
    """P-AXIS-00772 above 1000 does not matter where P-AXIS-00777 decides."""
    read(values).check("Z")
