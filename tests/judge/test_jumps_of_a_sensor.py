"""When a jump of the sensor value is due as an alarm, and when a transient is over."""

import math
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import ON, ROWS, WITH_CONST_DIST, K, recorded

from axisrig.bench.judge.distance.control_stretches import Stretch as Part
from axisrig.bench.judge.distance.control_stretches import last_active, must_settle
from axisrig.bench.judge.distance.expected_offset import due, walk
from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.distance.truth import ACTIVE_CONST_DIST, FREEZE, INACTIVE
from axisrig.bench.oracles.distance.following import settling_cycles
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.distance import DistanceOrder
from axisrig.kernel.time.clock import MS

JUMP, DEVIATION = 70329, 70331
WORDS = {"max_act_value_change": 500_000, "max_deviation": 10**9}
"""500 mm/s: 0.4 mm in a cycle of 1 ms are credible, 0.6 mm are none."""


def due_in(jumps: dict[int, float], between: int | None = None, **of: Any) -> Any:
    """jumps: of the distance, by row. between: state of rows 130 to 149, by the PLC side."""
    behind = np.sum([np.where(row <= K, -mm, 0.0) for row, mm in jumps.items()], axis=0)
    state = np.where((K < ON) | (K >= 220), INACTIVE, ACTIVE_CONST_DIST)
    orders: tuple[DistanceOrder, ...] = (WITH_CONST_DIST,)
    if between is not None:
        state[130:150] = between
        word = "OFF" if between == INACTIVE else "FREEZE"
        orders = (*orders, DistanceOrder(130 * MS, "PLC", word),
                  DistanceOrder(150 * MS, "PLC", "ON_CONST_DIST"))  # fmt: skip
    columns = {"distance_state": state.astype(float), **of.pop("columns", {})}
    words = {**WORDS, **of.pop("words", {})}
    truth = distance_truth(recorded(behind, words=words, columns=columns, orders=orders), "Z")
    assert truth is not None
    return due(truth, walk(truth))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_jump_is_due_where_the_control_has_read_a_value_before_it(side: float) -> None:
    """Switched on from INACTIVE the first value has none before it; behind a FREEZE it has."""
    cases: list[tuple[dict[int, float], int | None, int | None]] = [
        ({120: 0.4}, None, None),
        ({120: 0.6}, None, 120),
        ({120: 0.4, 121: 0.6, 122: 0.6}, None, 121),
        ({99: 0.6}, None, None),
        ({100: 0.6}, None, None),
        ({101: 0.6}, None, 101),
        ({140: 0.6}, INACTIVE, None),
        ({150: 0.6}, INACTIVE, None),
        ({151: 0.6}, INACTIVE, 151),
        ({150: 0.6}, FREEZE, 150),
        ({140: 0.6}, FREEZE, None),
    ]
    for jumps, between, row in cases:
        found = due_in({at: side * mm for at, mm in jumps.items()}, between)
        expected = None if row is None else (JUMP, row)
        assert (found and (found.alarm, found.row)) == expected, (jumps, between)


@pytest.mark.parametrize("held", [0, 50])
def test_an_offset_is_too_large_in_the_cycle_that_asks_for_it(held: int) -> None:
    """1 um behind: 0.2 um a cycle from row 100 on, so that the 51st asks for more than 10 um."""
    columns = {"distance_held": ((K >= 120) & (120 + held > K)).astype(float)}
    found = due_in({0: -0.001}, words={"max_deviation": 100}, columns=columns)
    assert (found.alarm, found.row) == (DEVIATION, 150 + held)
    wide = {"max_deviation": 100_000}  # 10 mm
    assert due_in({0: -0.001}, words=wide, columns=columns) is None


BELOW = 70576


@pytest.mark.parametrize(
    ("away", "back", "row"),
    [(110, None, 110), (119, None, 119), (120, None, 170), (130, None, 170), (130, 150, None),
     (130, 170, None), (130, 171, 170), (170, None, 170)],
)  # fmt: skip
def test_nothing_is_watched_while_the_offset_is_held(
    away: int, back: int | None, row: int | None
) -> None:
    """Held in rows 120 to 169; the tool is 6 mm above the surface, 5 mm are allowed."""
    columns = {"distance_held": ((K >= 120) & (K < 170)).astype(float)}
    jumps = {away: 4.0} if back is None else {away: 4.0, back: -4.0}
    found = due_in(jumps, columns=columns, words={"max_act_value_change": 10**9})
    assert (found and (found.alarm, found.row)) == (None if row is None else (BELOW, row))


@pytest.mark.parametrize("count", [1, 5, 21])
def test_a_transient_is_over_when_loop_and_filter_have_settled(count: int) -> None:
    """To a thousandth, and twice the delay (N - 1)/2 of the filter, before the last fifth."""
    truth = distance_truth(recorded(words={"n_cycles": count, "kp": 0.02}), "Z")
    assert truth is not None
    stretch = last_active(truth)
    loop = truth.loop(stretch.mode, stretch.listed)
    needed = settling_cycles(loop, 0.02, 1e-3) + count - 1
    enough = math.ceil(needed / 0.8 + 1e-9)
    assert enough + 1 < ROWS

    def part(rows: int) -> Part:
        return Part(100, 100 + rows, stretch.mode, stretch.listed)

    must_settle(loop, part(enough + 1))
    with pytest.raises(NoClosedFormError, match=f"needs {needed:.0f} cycles"):
        must_settle(loop, part(enough - 1))
