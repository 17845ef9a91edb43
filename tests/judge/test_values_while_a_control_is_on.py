"""Metrics of distance control: which rows and frames count, and when there is no value."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import (
    INVERTS,
    ON,
    ROWS,
    WITH_CONST_DIST,
    WITH_SET_POS,
    K,
    no_value,
    recorded,
    seen,
)

from axisrig.bench.judge.distance.control_stretches import must_settle
from axisrig.bench.judge.distance.metrics import distance_dead_cycles, distance_dead_time_ms
from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.distance.truth import ACTIVE
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS, Loop
from axisrig.bench.oracles.distance.smoothing import moving_average
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.axes import PlantRecord, PlantValue
from axisrig.bench.record.distance import Controller, DistanceChange, DistanceOrder, PlcSensor
from axisrig.kernel.time.clock import MS


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_largest_distance_behind_counts_while_the_control_is_on(sign: float) -> None:
    """0.3 mm before it is on, and 0.4 mm after it is off again at row 900."""
    behind = sign * (0.3 * (K < ON) + 0.05 * (K == 500) - 0.02 * (K == 700) + 0.4 * (K >= 900))
    states = {"distance_state": np.where((K >= ON) & (K < 900), 4.0, 0.0)}
    found = seen(recorded(behind, columns=states), "distance_behind_um_max")
    assert found.value == pytest.approx(50.0)
    assert seen(recorded(behind, columns=states), "distance_behind_end_um").value == pytest.approx(
        0.0, abs=1e-9
    )


def test_the_dead_time_is_between_the_ends_of_two_frames_and_the_cycles_are_counted() -> None:
    cycles = SimpleNamespace(dead=4, reaction=1, way=3)
    found = SimpleNamespace(seen_ns=10_000_200, shown_ns=14_700_000, cycles=cycles)
    truth: Any = SimpleNamespace(measured_dead=lambda: found, period_ns=1_000_000)
    time = distance_dead_time_ms(truth)
    assert (time.value, time.note) == (pytest.approx(4.6998), "ends of frames on the bus")
    counted = distance_dead_cycles(truth)
    assert (counted.value, counted.note) == (4, "reaction 1, way 3 cycles")


@pytest.mark.parametrize("metric", ["distance_kp_limit", "distance_growth_expected"])
@pytest.mark.parametrize(
    ("mode", "changes", "is_known"),
    [
        (CONST_DIST, {}, False),
        (SET_POS, {"state": ACTIVE, "orders": (WITH_SET_POS,)}, True),
        (SET_POS, {"state": ACTIVE, "orders": (WITH_SET_POS,), "second_delay_cycles": 1}, False),
    ],
)
def test_the_loops_of_a_drive_are_named_with_the_mode_that_has_them(
    metric: str, mode: str, changes: dict[str, Any], is_known: bool
) -> None:
    """In SET_POS they cancel where 6064 and 60E4 are of one SYNC."""
    plain = recorded(**changes)
    with_loops = {"z": PlantRecord({"kv": PlantValue(40.0)})}
    observed = Observed(replace(plain.facts, plants=with_loops), plain.series)
    assert seen(plain, metric).value is not None
    if is_known:
        assert seen(observed, metric).value is not None
        return
    assert no_value(observed, metric) == (
        f"{mode}: the loops of the drive are part of it; axisrig tune distance measures the loop"
    )


def test_a_sensor_that_counts_the_wrong_way_round_is_stable_at_no_kp() -> None:
    plain = recorded()
    listed = {**plain.facts.axes["Z"].written, INVERTS: 0}
    axes = {"Z": replace(plain.facts.axes["Z"], written=listed)}
    observed = Observed(replace(plain.facts, axes=axes), plain.series)
    assert seen(observed, "distance_kp_limit").value == 0.0


@pytest.mark.parametrize(
    ("row", "settles"), [(ROWS - 3, True), (ROWS - 2, True), (ROWS - 1, False)]
)
@pytest.mark.parametrize("last", [ROWS, 900])
def test_a_step_is_settled_where_the_last_row_of_the_control_is_in_its_band(
    row: int, settles: bool, last: int
) -> None:
    """1 mm at row 200, 0.5 mm in one of the last rows; last: row from which on it is off."""
    row -= ROWS - last
    is_off = last <= K
    behind = 1.0 * (K == 200) + 0.5 * (row == K) + 0.7 * is_off
    states = {"distance_state": np.where((K >= ON) & ~is_off, 4.0, 0.0)}
    found = seen(recorded(behind, columns=states), "distance_settling_ms")
    assert found.value == (pytest.approx(row + 1 - 200) if settles else None)


@pytest.mark.parametrize(("delay", "late", "cycles"), [(0, 0, 0), (3, 0, 3), (0, 2, 0), (3, 2, 1)])
def test_a_slope_of_set_pos_goes_past_by_the_age_of_its_value_and_not_below_none(
    delay: int, late: int, cycles: int
) -> None:
    """A variable of the PLC is of the last SYNC, also where 6064 of it comes later: newer by that.

    8 mm/s are 8 um a cycle.
    """
    controller = Controller(0.2, 0.0, 0.0, "DEFAULT", 1, 0.7, 4, 25.0, 0.1, False, limiter="slope")
    change = DistanceChange(ON * MS, "ACTIVE", "NC", "VARIABLE V.E.GAP", False, controller)
    limits = {"v_max": 8000, "a_max": 400}
    made = recorded(state=ACTIVE, orders=(WITH_SET_POS,), words=limits, changes=(change,),
                    late_cycles=late)  # fmt: skip
    sensors = {"V.E.GAP": PlcSensor("gap", -1, delay)}
    observed = Observed(replace(made.facts, plc_sensors=sensors), made.series)
    found = seen(observed, "distance_overshoot_expected_mm")
    assert found.value == pytest.approx(8e-3 * cycles)


@pytest.mark.parametrize(("state", "name"), [(4, "set_dist_mm"), (ACTIVE, "set_pos_mm")])
@pytest.mark.parametrize(
    ("by", "at_400_mm"),
    [
        ((), 2.5),  # no order of the program: as the column has it
        ((("PLC", 2.5),), 2.5),
        ((("NC", 2.5),), 2.0),  # from the next cycle on
        ((("PLC", 2.2), ("NC", 2.5)), 2.2),  # what the PLC gave in the cycle, which came first
    ],
)
def test_a_set_value_of_the_program_acts_in_the_cycle_after_it(
    state: int, name: str, by: tuple[tuple[str, float], ...], at_400_mm: float
) -> None:
    """The column changes from 2 mm to 2.5 mm in row 400, the cycle in which it was asked for."""
    asked: Any = [DistanceOrder(400 * MS + 100, who, **{name: mm}) for who, mm in by]
    begin = WITH_SET_POS if state == ACTIVE else WITH_CONST_DIST
    columns = {name: np.where(K < 400, 2.0, 2.5)}
    truth = distance_truth(recorded(state=state, orders=(begin, *asked), columns=columns), "Z")
    assert truth is not None
    wanted = truth.wanted_mm(name)
    assert wanted[[398, 399, 400, 401, 402]].tolist() == [2.0, 2.0, at_400_mm, 2.5, 2.5]
    other = "set_pos_mm" if name == "set_dist_mm" else "set_dist_mm"
    assert truth.wanted_mm(other)[400] == truth.wanted_mm(other)[399]


@pytest.mark.parametrize(
    ("count", "length", "words"),
    [
        (1, 38, "31 cycles, the surface was even for 30 before"),
        (1, 39, ""),
        (41, 39, "71 cycles, the surface was even for 31 before"),
        (41, 88, "71 cycles, the surface was even for 70 before"),
        (41, 89, ""),
    ],
)
def test_a_transient_is_that_of_the_loop_and_twice_the_delay_of_its_filter(
    count: int, length: int, words: str
) -> None:
    """In SET_POS nothing of the filter comes back: of kp 0.2 is left 0.8 a cycle, a thousandth
    after ln(0.001)/ln(0.8) = 30.96 cycles; a mean of 41 values is late by 20. The first four
    fifths of a stretch are before what is judged.
    """
    part: Any = SimpleNamespace(begin=100, end=100 + length, kp=0.2)
    loop = Loop(SET_POS, 2, moving_average(count))
    if not words:
        must_settle(loop, part)
        return
    with pytest.raises(NoClosedFormError, match=f"the transient needs {words}"):
        must_settle(loop, part)
