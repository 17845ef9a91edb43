"""Which mode, which word and which filter of a distance control a metric is about.

Recordings made of formulas (`controls.py`): 1 ms, kp 0.2, no filter, on from row 100 on.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.judge.controls import (
    ON,
    ROWS,
    WITH_CONST_DIST,
    WITH_SET_POS,
    K,
    no_value,
    recorded,
    seen,
)
from tests.recordings import kept
from tests.reports import tilted

from axisrig.bench.judge.distance.control_stretches import compared, of_last_filter
from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.distance.truth import ACTIVE, ACTIVE_CONST_DIST, DistanceTruth
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.distance import Controller, DistanceChange, DistanceOrder, PlcSensor
from axisrig.kernel.time.clock import MS


def truth_of(*given: Any, **changes: Any) -> DistanceTruth:
    found = distance_truth(recorded(*given, **changes), "Z")
    assert found is not None
    return found


def word(row: int, by: str = "NC", **words: Any) -> DistanceOrder:
    return DistanceOrder(row * MS, by, words=words)


@pytest.mark.parametrize(
    ("state", "order"), [(ACTIVE, WITH_SET_POS), (ACTIVE_CONST_DIST, WITH_CONST_DIST)]
)
def test_a_control_was_on_in_either_mode(state: int, order: DistanceOrder) -> None:
    """0.25 mm too near in one row, and an offset that starts with 0.5 mm in a cycle."""
    behind = np.where(K == 300, 0.25, 0.0)
    level = {"actual_mm": 2.0 - behind, "set_pos_mm": np.full(ROWS, -2.0)}
    observed = recorded(behind, state=state, orders=(order,), columns=level)
    assert seen(observed, "distance_behind_um_max").value == pytest.approx(250.0)
    columns = {"offset_mm": np.where(K >= 400, 0.5, 0.0)}
    observed = recorded(state=state, orders=(order,), columns=columns)
    assert seen(observed, "offset_acceleration_mm_s2_max").value == pytest.approx(0.5e6)
    truth = truth_of(behind, state=state, orders=(order,))
    assert truth.was_on
    assert [(one.begin, one.end) for one in compared(truth)] == [(ON, ROWS)]


@pytest.mark.parametrize("name", ["set_pos_mm", "set_dist_mm"])
@pytest.mark.parametrize(
    ("orders", "at_0_mm"),
    [
        ((), 2.5),
        ((("PLC", 2.5),), 2.5),
        ((("NC", 2.5),), 0.0),  # nothing was wanted before
        ((("PLC", 2.25), ("NC", 2.5)), 2.25),
    ],
)
def test_what_the_program_wants_in_the_first_row_acts_in_the_second(
    name: str, orders: tuple[tuple[str, float], ...], at_0_mm: float
) -> None:
    asked: Any = [DistanceOrder(0, by, **{name: mm}) for by, mm in orders]
    values = np.where(K < ROWS - 1, 2.5, 7.0)
    truth = truth_of(orders=(*asked, WITH_CONST_DIST), columns={name: values})
    wanted = truth.wanted_mm(name)
    assert wanted[[0, 1, 2, ROWS - 1]].tolist() == [at_0_mm, 2.5, 2.5, 7.0]


@pytest.mark.parametrize("optimized", [0, 1])
def test_the_program_is_what_was_sent_less_the_offset_in_it(optimized: int) -> None:
    """An offset is sent in its own cycle with optimized scheduling, else in the next one."""
    program = np.clip((K - 200) * 0.01, 0.0, 3.0)
    offset = np.select([K < 300, K < 500], [0.0, 0.5], -0.25)
    sent = offset if optimized else np.concatenate([offset[:1], offset[:-1]])
    columns = {"set_mm": program + sent, "offset_mm": offset}
    truth = truth_of(columns=columns, words={"optimized_scheduling": optimized})
    assert truth.program_mm == pytest.approx(program)


@pytest.mark.parametrize(("row", "begins"), [(ON - 1, [ON]), (ON, [ON]), (ON + 1, [ON, ON + 2])])
def test_the_row_that_shows_the_new_state_belongs_to_what_begins(
    row: int, begins: list[int]
) -> None:
    """A word acts in the cycle after its own; in the first two rows it belongs to the begin."""
    orders = (DistanceOrder((ON - 1) * MS, "NC", "ON_CONST_DIST"), word(row, kp=0.1))
    found = compared(truth_of(orders=orders))
    assert [one.begin for one in found] == begins
    assert found[-1].kp == 0.1
    late = compared(truth_of(orders=(DistanceOrder(ON * MS, "NC", "ON_CONST_DIST"),)))
    assert [one.begin for one in late] == [ON]


@pytest.mark.parametrize(
    ("listed", "words"),
    [
        ({"filter_type": "LOWPASS"}, {"low_pass_filter_fg_f0": 50.0}),
        ({"filter_type": "LOWPASS"}, {"low_pass_filter_order": 2}),
        ({"filter_type": "KALMAN_MA", "n_cycles": 4}, {"kalman_sigma": 300}),
        ({"filter_type": "EXPO_MEAN", "n_cycles": 4}, {"smoothing_factor": 0.5}),
        ({"n_cycles": 4}, {"n_cycles": 5}),
        ({"n_cycles": 4}, {"filter_type": "EXPO_MEAN"}),
    ],
)
def test_the_last_filter_is_that_with_all_of_its_numbers(
    listed: Mapping[str, Any], words: Mapping[str, Any]
) -> None:
    """Another kp in row 300, another filter in row 500, another kp again in row 700."""
    orders = (WITH_CONST_DIST, word(300, kp=0.1), word(500, **words), word(700, kp=0.3))
    found = of_last_filter(truth_of(orders=orders, words=listed))
    assert [(one.begin, one.end) for one in found] == [(501, 701), (701, ROWS)]
    same = (WITH_CONST_DIST, word(300, kp=0.1), word(700, kp=0.3))
    found = of_last_filter(truth_of(orders=same, words=listed))
    assert [one.begin for one in found] == [ON, 301, 701]


@pytest.mark.parametrize(
    ("step_mm", "delta_mm"), [(0.01, 0.02), (0.02, 0.01), (-0.01, -0.02), (-0.02, -0.01)]
)
@pytest.mark.parametrize("metric", ["distance_error_expected_um", "distance_behind_expected_um"])
def test_a_limit_that_holds_an_offset_back_leaves_no_closed_form(
    metric: str, step_mm: float, delta_mm: float
) -> None:
    """In both directions, and also where it keeps a step larger than what is asked for."""
    surface = np.where(K < 300, 0.0, (K - 300) * 0.01)
    lag = np.where(K > 300, 0.05, 0.0)
    free = {"step_mm": np.full(ROWS, step_mm), "delta_mm": np.full(ROWS, step_mm)}
    held = {**free, "delta_mm": np.full(ROWS, delta_mm)}
    assert seen(recorded(lag, surface, columns=free), metric).value == pytest.approx(50.0)
    assert no_value(recorded(lag, surface, columns=held), metric).startswith(
        "the offset is limited"
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("asked", [0.04, 0.06])
def test_a_loop_is_measured_behind_what_limits_hold_up_or_down(asked: float, sign: float) -> None:
    """Steps of 0.05 mm until row 340, less or more than what is asked; then 0.9 is left a cycle."""
    step = np.where(K < 300, 0.0, np.where(K < 340, 0.05, 0.05 * 0.9 ** (K - 340.0)))
    delta = np.where((K >= 300) & (K < 340), asked, step)
    columns = {"step_mm": sign * step, "delta_mm": sign * delta}
    found = seen(recorded(0.0, np.where(K < 300, 0.0, 2.0), columns=columns), "distance_growth")
    assert found.value == pytest.approx(0.9, abs=1e-3)


# Where the surface is, and what is wanted


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_surface_is_where_the_plant_has_the_axis_less_its_gap(side: float) -> None:
    """Not where the drive reports the axis."""
    surface = side * np.clip((K - 300) * 0.01, 0.0, 2.0)
    truth = truth_of(0.125, surface, columns={"actual_mm": np.full(ROWS, 7.0)})
    assert truth.surface_mm == pytest.approx(surface)
    assert truth.behind_mm == pytest.approx(0.125)


@pytest.mark.parametrize("speed_mm", [0.01, -0.02])
def test_a_surface_position_is_wanted_of_where_the_axis_has_been_sent(speed_mm: float) -> None:
    """What is sent in a cycle is reached two SYNCs later (docs/architecture.md)."""
    program = speed_mm * np.clip(K - 300, 0, None)
    late = np.concatenate([program[:1], program[:1], program[:-2]])
    columns = {"set_mm": program, "set_pos_mm": np.full(ROWS, -1.5)}
    truth = truth_of(state=ACTIVE, orders=(WITH_SET_POS,), columns=columns)
    assert truth.wanted_gap_mm == pytest.approx(late + 1.5)
    constant = truth_of(columns=columns)
    assert constant.wanted_gap_mm[ON:] == pytest.approx(2.0)


def referenced(gap_mm: Any, sensor_mm: Any, *spans: tuple[int, int]) -> DistanceTruth:
    """The program has set the zero (REF) before each time in which the control is on."""
    state = np.zeros(ROWS)
    orders: list[DistanceOrder] = []
    for begin, end in spans:
        state[begin:end] = ACTIVE_CONST_DIST
        orders += [DistanceOrder(begin * MS, "PLC", "ON_CONST_DIST"),
                   DistanceOrder(end * MS, "PLC", "OFF")]  # fmt: skip
    observed = recorded(2.0 - gap_mm, orders=tuple(orders), columns={
        "distance_state": state, "sensor_mm": sensor_mm * np.ones(ROWS)})  # fmt: skip
    control = replace(observed.facts.distance["Z"], is_referenced=True)
    facts = replace(observed.facts, distance={"Z": control})
    found = distance_truth(Observed(facts, observed.series), "Z")
    assert found is not None
    return found


@pytest.mark.parametrize("odd", [100, 150, 299])
def test_a_zero_is_what_the_sensor_gives_most_of_the_time(odd: int) -> None:
    """3 mm beside the sensor value; one row of the time is a millimetre off."""
    gap = np.where(odd == K, 4.0, 3.0)
    assert referenced(gap, 0.0, (100, 300)).zero_mm == pytest.approx(3.0)


def test_each_time_has_the_zero_that_was_set_before_it() -> None:
    """2 mm in the first time, 3.5 mm in the second one, and before the first one as in it."""
    gap = np.where(K < 400, 2.0, 3.5)
    truth = referenced(gap, 0.0, (100, 300), (500, 900))
    assert truth.zero_mm == pytest.approx(3.5)
    assert truth.zero_by_row_mm[[0, 100, 299, 499, 500, 999]] == pytest.approx(
        [2.0, 2.0, 2.0, 2.0, 3.5, 3.5]
    )
    # SET_DIST is 2 mm: so much is wanted beside the zero
    assert truth.wanted_gap_mm[[150, 600]] == pytest.approx([4.0, 5.5])
    behind = truth.behind_mm
    assert behind is not None
    assert behind[[150, 600]] == pytest.approx([2.0, 2.0])


@pytest.mark.parametrize(("is_variable", "um"), [(False, 5.0), (True, 0.1)])
def test_an_increment_is_that_of_the_encoder_or_of_a_variable(is_variable: bool, um: float) -> None:
    """20 increments in 0.1 um times 1000: 5 um by the list; a variable counts in 0.1 um."""
    controller = Controller(0.2, 0.0, 0.0, "DEFAULT", 1, 0.7, 4, 25.0, 0.1, False)
    sensor = "VARIABLE V.E.GAP" if is_variable else "60E4"
    change = DistanceChange(ON * MS, "ACTIVE_CONST_DIST", "NC", sensor, False, controller)
    observed = recorded(0.001, changes=(change,))
    axis = observed.facts.axes["Z"]
    listed = {
        **axis.written, "lr_hw[1].encoder_resolution_num": 20,
        "lr_hw[1].encoder_resolution_denom": 1000,
    }  # fmt: skip
    facts = replace(
        observed.facts, axes={"Z": replace(axis, written=listed)},
        plc_sensors={"V.E.GAP": PlcSensor("gap", -1, 0)},
    )  # fmt: skip
    found = seen(Observed(facts, observed.series), "distance_behind_end_um")
    assert (found.value, found.uncertainty) == (pytest.approx(1.0), pytest.approx(um))


# The tool


def of_tool(metric: str, changes: Mapping[str, Any]) -> Any:
    """changes: added to columns of `reports/tilted.py`."""
    table = tilted.trace()
    for name, more in changes.items():
        values = pa.array(table[name].to_numpy() + more)
        table = table.set_column(table.column_names.index(name), name, values)
    observed = Observed(tilted.left(), kept(table))
    return observe(observed, parse_check(metric, "> -1e9", "")).value


@pytest.mark.parametrize("stem", ["tcp", "clamping"])
@pytest.mark.parametrize("parts", [(3.0, 4.0, 0.0), (0.0, -3.0, 4.0), (-2.0, 3.0, 6.0)])
def test_an_error_of_a_kinematic_is_a_way_in_space(
    stem: str, parts: tuple[float, float, float]
) -> None:
    """Of TCP or clamping point, nm, in one row in which the kinematic is on."""
    at = np.arange(tilted.ROWS)
    changes = {
        f"gap.{stem}_{letter}_mm": np.where(at == 333, part * 1e-3, 0.0)
        for letter, part in zip("xyz", parts, strict=True)
    }
    expected = 1e3 * float(np.linalg.norm(parts))
    assert of_tool("kinematic_error_nm", changes) == pytest.approx(expected, rel=1e-6)
    assert of_tool("kinematic_error_nm", {}) == pytest.approx(0.0, abs=1e-3)
