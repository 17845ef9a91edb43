"""The own model of the offset: what a pause leaves of its sum, words while it is on, what ends it.

The tool is 1 um behind all along: kp e = 0.2 um a cycle. With Tn = 0.1 s a cycle of 1 ms adds g =
T/Tn = 0.01 of the error to the sum: the step j of a time is kp e (1 + g j).
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import ON, ROWS, WITH_CONST_DIST, WITH_SET_POS, K, recorded, seen

from axisrig.bench.judge.distance.truth import (
    ACTIVE,
    ACTIVE_CONST_DIST,
    ERROR,
    FREEZE,
    INACTIVE,
)
from axisrig.bench.record.distance import DistanceOrder
from axisrig.kernel.time.clock import MS

E_MM, KP, G = 0.001, 0.2, 0.01
CONST = "ON_CONST_DIST"
WIDE = {"v_max": 10**9, "a_max": 10**9, "max_deviation": 10**9}


def error_um(offset_mm: Any, behind_mm: Any = E_MM, **changes: Any) -> float:
    """Largest difference between the own model and an offset."""
    columns = {"offset_mm": offset_mm, **changes.pop("columns", {})}
    found = seen(recorded(behind_mm, columns=columns, **changes), "offset_model_error_um").value
    assert isinstance(found, float)
    return found


def order(row: int, action: str = "", by: str = "NC", **more: Any) -> DistanceOrder:
    return DistanceOrder(row * MS, by, action, **more)


# The sum of the errors

PAUSES: dict[str, tuple[int, tuple[DistanceOrder, ...]]] = {
    "dry run": (ACTIVE_CONST_DIST, (order(199, CONST, is_dry_run=True), order(249, CONST))),
    "freeze": (FREEZE, (order(200, "FREEZE", "PLC"), order(250, CONST, "PLC"))),
    "off": (INACTIVE, (order(200, "OFF", "PLC"), order(250, CONST, "PLC"))),
}


@pytest.mark.parametrize("pause", PAUSES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_behind_a_pause_the_sum_of_the_errors_begins_anew(pause: str, sign: float) -> None:
    """On in rows 100 to 199 and 250 to 349; nothing moves in between."""
    between, orders = PAUSES[pause]
    state = np.where((K >= ON) & (K < 350), float(ACTIVE_CONST_DIST), float(INACTIVE))
    state[200:250] = between
    numbers = np.where((K >= ON) & (K < 200), K - ON + 1, np.where(K >= 250, K - 249, 0))
    steps = np.where((numbers > 0) & (K < 350), sign * KP * E_MM * (1.0 + G * numbers), 0.0)
    found = error_um(
        np.cumsum(steps), sign * E_MM, orders=(WITH_CONST_DIST, *orders, order(350, "OFF", "PLC")),
        words={"i_tn": 0.1}, columns={"distance_state": state},
    )  # fmt: skip
    assert found == pytest.approx(0.0, abs=1e-9)


def test_a_command_for_what_is_on_leaves_the_sum() -> None:
    numbers = np.where((K >= ON) & (K < 350), K - ON + 1, 0)
    steps = np.where(numbers > 0, KP * E_MM * (1.0 + G * numbers), 0.0)
    state = np.where((K >= ON) & (K < 350), float(ACTIVE_CONST_DIST), float(INACTIVE))
    orders = (WITH_CONST_DIST, order(249, CONST), order(350, "OFF", "PLC"))
    found = error_um(np.cumsum(steps), orders=orders, words={"i_tn": 0.1},
                     columns={"distance_state": state})  # fmt: skip
    assert found == pytest.approx(0.0, abs=1e-9)


# Words while it is on

FIVE = np.where(K < 300, E_MM, 5 * E_MM)
"""5 um behind from row 300 on."""


def errors_of(*first: float) -> Any:
    """1 um until row 300, then these, then 5 um."""
    found = np.where(K < ON, 0.0, FIVE)
    found[300 : 300 + len(first)] = first
    return found


@pytest.mark.parametrize(
    ("words", "listed", "errors_mm"),
    [
        ({}, {}, errors_of()),
        ({"n_cycles": 4}, {}, errors_of(0.002, 0.003, 0.004)),
        ({"n_cycles": 1}, {"n_cycles": 4}, errors_of()),
        ({"n_cycles": 2}, {"n_cycles": 4}, errors_of(0.003)),
        # Weights 1 and 1 - alpha of the last two values
        ({"filter_type": "EXPO_MEAN"}, {"n_cycles": 2, "smoothing_factor": 0.5},
         errors_of(0.001 + 0.004 * 2 / 3)),
        ({"smoothing_factor": 0.75}, {"filter_type": "EXPO_MEAN", "n_cycles": 2},
         errors_of(0.001 + 0.004 * 0.8)),
        ({"filter_type": "DEFAULT"}, {"filter_type": "EXPO_MEAN", "n_cycles": 2},
         errors_of(0.003)),
    ],
)  # fmt: skip
def test_another_filter_of_the_program_acts_in_the_model(
    words: Mapping[str, Any], listed: Mapping[str, Any], errors_mm: Any
) -> None:
    """It is given in row 200, where all that the filter has had is 1 um."""
    orders = (WITH_CONST_DIST, order(200, words=words))
    found = error_um(np.cumsum(KP * errors_mm), FIVE, orders=orders, words={**WIDE, **listed})
    assert found == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("row", [150, 200])
def test_an_integral_part_of_the_program_sums_from_its_cycle_on(row: int) -> None:
    """Tn = 0.1 s is given in a row, and taken again 100 rows later: then the sum is none."""
    orders = (WITH_CONST_DIST, order(row, words={"i_tn": 0.1}), order(row + 100, words={"i_tn": 0}))
    numbers = np.where((row < K) & (row + 100 >= K), K - row, 0)
    steps = np.where(K >= ON, KP * E_MM * (1.0 + G * numbers), 0.0)
    assert error_um(np.cumsum(steps), orders=orders) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "listed", "words", "steps_um"),
    [
        # Until the word of row 400, and after it; a far surface takes all of v_max
        ("v_max", 10_000, 20_000, (10.0, 20.0)),
        ("v_max", 10_000, 4_000, (10.0, 4.0)),
    ],
)
def test_a_limit_of_the_program_acts_in_the_model(
    name: str, listed: int, words: int, steps_um: tuple[float, float]
) -> None:
    steps = 1e-3 * np.select([K < ON, K <= 400], [0.0, steps_um[0]], steps_um[1])
    orders = (WITH_CONST_DIST, order(400, words={name: words}))
    found = error_um(np.cumsum(steps), 1.0, orders=orders, words={**WIDE, name: listed})
    assert found == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_largest_offset_of_the_program_acts_in_the_model(sign: float) -> None:
    """10 um until row 400, then 20 um."""
    course = np.minimum(np.clip(K - ON + 1, 0, None) * KP * E_MM, 0.01)
    course = np.where(K > 400, np.minimum(0.01 + (K - 400) * KP * E_MM, 0.02), course)
    orders = (WITH_CONST_DIST, order(400, words={"max_deviation": 200}))
    found = error_um(sign * course, sign * E_MM, orders=orders, words={"max_deviation": 100})
    assert found == pytest.approx(0.0, abs=1e-9)


# What begins and ends it


@pytest.mark.parametrize(
    ("row", "um"),
    [(98, 0.0), (100, 3.0), (200, 3.0), (300, 3.0), (301, 3.0), (450, 3.0), (599, 3.0), (650, 0.0),
     (700, 3.0), (800, 3.0)],
)  # fmt: skip
def test_the_model_goes_on_through_another_mode(row: int, um: float) -> None:
    """By the surface from row 100, by the distance from 300 to 600, and from 700 on again.

    Nothing is wanted of the offset; it is 3 um off in one row.
    """
    state = np.select([K < ON, K < 300, (K >= 600) & (K < 700)],
                      [float(INACTIVE), ACTIVE, INACTIVE], ACTIVE_CONST_DIST)  # fmt: skip
    orders = (WITH_SET_POS, order(299, CONST), order(600, "OFF", "PLC"), order(700, CONST, "PLC"))
    columns = {
        "distance_state": state,
        "set_pos_mm": np.zeros(ROWS),
        "actual_mm": np.full(ROWS, 2.0),
    }
    found = error_um(np.where(row == K, 0.003, 0.0), 0.0, orders=orders, columns=columns)
    assert found == pytest.approx(um, abs=1e-9)


@pytest.mark.parametrize("end", [500, 501])
def test_the_cycle_of_an_alarm_moves_nothing_and_is_not_compared(end: int) -> None:
    """The offset stands from the row on that is in ERROR; nothing more is compared."""
    state = np.where(K < ON, float(INACTIVE), float(ACTIVE_CONST_DIST))
    state[end:] = ERROR
    steps = np.where((K >= ON) & (end > K), KP * E_MM, 0.0)
    for more in (0.0, 5.0):
        offset = np.cumsum(steps) + more * (end <= K)
        assert error_um(offset, columns={"distance_state": state}) == pytest.approx(0.0, abs=1e-9)
