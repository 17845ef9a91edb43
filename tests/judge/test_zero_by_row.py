"""Which gap has the sensor value 0 in each row, of a whole run and of some rows of it."""

from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts

from axisrig.bench.judge.distance.truth import DistanceTruth
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.series import Series

ROWS = 100
ZEROS = [(5, 1.0), (20, 2.0), (60, 3.0)]


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("begin", "end"), [(0, 100), (0, 20), (3, 70), (25, 50), (40, 80), (90, 97)]
)
def test_a_zero_holds_from_its_row_on_until_the_next_one(begin: int, end: int) -> None:
    """REF at rows 5, 20 and 60; before the first the control counts as after it."""
    times = pa.array(np.arange(ROWS, dtype=np.int64))
    series = Series(pa.table({"time_ns": times}))
    whole = DistanceTruth("Z", Observed(facts(), series))
    whole.__dict__["zeros"] = ZEROS
    part = replace(whole, observed=Observed(facts(), series, slice(begin, end)), whole=whole)
    by_row = [1.0] * 20 + [2.0] * 40 + [3.0] * 40
    assert part.zero_by_row_mm.tolist() == by_row[begin:end]
    assert whole.zero_by_row_mm.tolist() == by_row
