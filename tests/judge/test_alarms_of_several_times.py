"""Alarms of a distance control that is on several times: which time counts, and what is watched.

On from the program in row 99, so that row 100 makes the first step; off in row 299 or frozen from
300 on; on again in row 499. The tool is 2 mm above the surface, the lower end of the sensor -5 mm.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import ROWS, K, recorded, seen

from axisrig.bench.judge.distance.truth import ACTIVE, ACTIVE_CONST_DIST, ERROR, FREEZE, INACTIVE
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.distance import DistanceOrder
from axisrig.bench.record.facts import AlarmRecord
from axisrig.kernel.time.clock import MS, US

LATE, AFTER = "distance_alarm_late_cycles", "distance_alarm_after_cycles"
LEFT, JUMPED = 70576, 70329
"""IDs: the sensor value is below its range, or has changed by more than P-AXIS-00417 allows."""
FIRST, OFF, AGAIN = 99, 299, 499
CONST_DIST = "ON_CONST_DIST"


def order(row: int, action: str = "", by: str = "NC", **of_order: Any) -> DistanceOrder:
    return DistanceOrder(row * MS, by, action, **of_order)


def states(between: int = INACTIVE, first: int = ACTIVE_CONST_DIST) -> Any:
    """On in the rows 99 to 298, and from 499 on."""
    found = np.full(ROWS, float(ACTIVE_CONST_DIST))
    found[:FIRST], found[FIRST:OFF], found[OFF:AGAIN] = INACTIVE, first, between
    return found


TWICE = (order(FIRST, CONST_DIST), order(OFF, "OFF"), order(AGAIN, CONST_DIST))
FROZEN = (order(FIRST, CONST_DIST), order(OFF, "FREEZE"), order(AGAIN, CONST_DIST))
BY_SURFACE = (order(FIRST, "ON"), *FROZEN[1:])
"""Before the freeze it follows the surface."""


def several(
    *alarms: tuple[int, int],
    orders: tuple[DistanceOrder, ...] = TWICE,
    state: Any = None,
    behind_mm: Any = 0.0,
    **words: Any,
) -> Observed:
    """alarms: row of the cycle and ID."""
    columns = {"distance_state": states() if state is None else state}
    observed = recorded(behind_mm, orders=orders, columns=columns, words=words)
    records = tuple(AlarmRecord(row * MS + 600 * US, number, 7, True, "") for row, number in alarms)
    return Observed(replace(observed.facts, alarms=records), observed.series)


def test_a_dry_run_before_it_counts_as_the_first_time() -> None:
    """It reads the sensor as the control does, and its alarms come up as well."""
    on = np.where(K < FIRST, float(INACTIVE), float(ACTIVE_CONST_DIST))
    orders = (order(FIRST, CONST_DIST, is_dry_run=True), order(AGAIN, CONST_DIST))
    assert seen(several((700, LEFT), orders=orders, state=on), AFTER).value == 600


@pytest.mark.parametrize("row", [100, 104])
def test_what_the_plc_switches_on_makes_its_first_step_in_the_same_cycle(row: int) -> None:
    orders = tuple(
        order(at + 1, action, "PLC") for at, action in ((FIRST, CONST_DIST), (OFF, "OFF"))
    )
    state = np.where((K < 100) | (K >= 300), float(INACTIVE), float(ACTIVE_CONST_DIST))
    assert seen(several((row, LEFT), orders=orders, state=state), AFTER).value == row - 100


# What is due


def away(*rows: tuple[int, int]) -> Any:
    """The tool is 6 mm above the surface in these rows."""
    found = np.zeros(ROWS)
    for begin, end in rows:
        found[begin:end] = -4.0
    return found


WATCHED = {"max_act_value_change": 10**9, "max_deviation": 10**9}


@pytest.mark.parametrize(
    ("rows", "due_row"),
    [
        (((600, 700),), 600),  # in the second time
        (((200, 250), (600, 700)), 200),  # in both: the first one
        (((320, 450), (600, 700)), 600),  # while it was off nothing is watched
        (((450, 700),), 500),  # from the first step of the second time on
    ],
)
@pytest.mark.parametrize("late", [0, 2])
def test_an_alarm_is_due_where_the_control_is_on(
    rows: tuple[tuple[int, int], ...], due_row: int, late: int
) -> None:
    state = states()
    state[due_row + late :] = ERROR
    observed = several((due_row + late, LEFT), state=state, behind_mm=away(*rows), **WATCHED)
    found = seen(observed, LATE)
    assert found.value == late
    assert found.note.endswith(f"due in the cycle of {due_row} ms")


@pytest.mark.parametrize(
    ("between", "orders", "row", "due_row"),
    [
        (INACTIVE, TWICE, 400, None),  # while it was off
        (INACTIVE, TWICE, 500, None),  # its first value has none before it
        (INACTIVE, TWICE, 501, 501),
        (FREEZE, FROZEN, 400, None),  # frozen it watches nothing
        (FREEZE, FROZEN, 500, 500),  # but goes on reading
        (FREEZE, FROZEN, 501, 501),
        (FREEZE, BY_SURFACE, 500, 500),  # by another law too
        (FREEZE, BY_SURFACE, 501, 501),
        (FREEZE, FROZEN, 200, 200),
        (INACTIVE, TWICE, 100, None),
        (INACTIVE, TWICE, 101, 101),
    ],
)
def test_a_jump_is_one_where_a_value_came_before(
    between: int, orders: tuple[DistanceOrder, ...], row: int, due_row: int | None
) -> None:
    """The sensor value jumps by 0.5 mm in a row; 5 mm/s are 0.005 mm a cycle."""
    jumped = np.where(row <= K, -0.5, 0.0)
    state = states(between, ACTIVE if orders is BY_SURFACE else ACTIVE_CONST_DIST)
    observed = several(
        (800, JUMPED), orders=orders, state=state, behind_mm=jumped, max_deviation=10**9
    )
    found = seen(observed, LATE)
    if due_row is None:
        assert (found.value, found.note) == (None, "due: none, raised: 70329")
    else:
        assert found.value == 800 - due_row


@pytest.mark.parametrize(("row", "due_row"), [(450, None), (500, None), (501, 501)])
def test_behind_a_freeze_that_was_switched_off_the_first_value_has_none_before_it(
    row: int, due_row: int | None
) -> None:
    """Frozen from row 299 on, off from 400 on, on again from 499 on."""
    state = states(FREEZE)
    state[400:AGAIN] = INACTIVE
    orders = (*FROZEN[:2], order(399, "OFF"), FROZEN[2])
    jumped = np.where(row <= K, -0.5, 0.0)
    observed = several((800, JUMPED), orders=orders, state=state, behind_mm=jumped,
                       max_deviation=10**9)  # fmt: skip
    assert seen(observed, LATE).value == (None if due_row is None else 800 - due_row)


@pytest.mark.parametrize(("row", "um"), [(200, 3.0), (400, 0.0), (700, 3.0), (98, 0.0)])
def test_the_offset_is_compared_with_its_model_each_time(row: int, um: float) -> None:
    """3 um beside it in one row; each time begins with the offset that is there."""
    offset = np.where(row == K, 0.003, 0.0)
    offset[310:] += 0.25  # handed over while it is off
    columns = {"distance_state": states(), "offset_mm": offset}
    observed = recorded(orders=TWICE, columns=columns)
    assert seen(observed, "offset_model_error_um").value == pytest.approx(um, abs=1e-9)
