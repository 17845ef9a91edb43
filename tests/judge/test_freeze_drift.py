"""How far the offset of distance control moved while it was to rest."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.judge.distance.offset_metrics import freeze_drift_um, offset_held_drift_um
from axisrig.bench.judge.distance.times import Unbroken
from axisrig.bench.judge.distance.truth import ACTIVE, FREEZE

OFFSET_MM = np.array([0.0, 0.1, 0.1, 0.5, 0.503, 0.5, 0.9, 0.9, 0.7, 0.701, 1.5])


def truth(rows_of_a_part: int, **times: Any) -> Any:
    """Rows of the offset in parts of a few."""

    def parts(rows: slice) -> Any:
        for first in range(0, len(OFFSET_MM), rows_of_a_part):
            own = slice(max(first, rows.start), min(first + rows_of_a_part, rows.stop))
            if own.start < own.stop:
                inside = slice(own.start - first, own.stop - first)
                part = {"offset_mm": OFFSET_MM[first : first + rows_of_a_part]}
                yield part, own.start, inside

    return SimpleNamespace(parts=parts, **times)


@pytest.mark.parametrize("rows_of_a_part", [2, 100])
@pytest.mark.parametrize("order", [1, -1])
def test_of_several_stretches_the_largest_drift_counts(rows_of_a_part: int, order: int) -> None:
    """0, 3 and 1 um in three times, the largest in the middle, first or last of two; the jumps
    between them are motion of the control.
    """
    frozen = [Unbroken(1, 3, FREEZE), Unbroken(3, 6, FREEZE), Unbroken(8, 10, FREEZE)]
    moving = [Unbroken(6, 8, ACTIVE), Unbroken(10, 11, ACTIVE)]
    for stretches, um in ((frozen, 3.0), (frozen[:2][::order], 3.0), (frozen[::2], 1.0)):
        found = freeze_drift_um(truth(rows_of_a_part, states=[*stretches, *moving]))
        assert found.value == pytest.approx(um)
        assert found.note == f"{len(stretches)} time(s) in FREEZE"


@pytest.mark.parametrize("rows_of_a_part", [2, 100])
def test_a_hold_begins_with_the_row_before_it(rows_of_a_part: int) -> None:
    held = [Unbroken(2, 3, 1), Unbroken(4, 5, 1), Unbroken(9, 10, 1)]
    found = offset_held_drift_um(truth(rows_of_a_part, held=held))
    assert found.value == pytest.approx(3.0)
