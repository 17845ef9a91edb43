"""SYNCs that no drive has got: where they would have been."""

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.kernel.time.clock import MS, US


@pytest.mark.parametrize(
    ("asked_us", "is_lost"),
    [
        (4300, True),  # when the terminal asked
        (4100, True),  # ... the PLC
        (5000, True),  # ... the control
        (4200, False),  # nobody asks then: it has come, at another time
    ],
)
@pytest.mark.parametrize("moves", [False, True])
def test_a_sync_that_no_drive_has_got_is_looked_for_a_period_after_the_last_one(
    asked_us: int, is_lost: bool, moves: bool
) -> None:
    """The terminal is exchanged at 0.3 ms of every 2, the PLC runs at 1.1 ms of every 3 ms."""
    times = np.arange(10, dtype=np.int64) * MS + 48 * US
    times[5] = asked_us * US
    place = np.arange(10.0)
    if not moves:
        place[5] = place[4]
    task = PlcTaskRecord(3 * MS, 1100 * US, 0, 2 * MS, 300 * US)
    observed = Observed(
        facts(axes={"Z": AxisRecord("can1", 1, 1000.0)}, plc_task=task),
        kept(pa.table({"time_ns": times, "Z.actual_mm": place})),
    )
    is_lost = is_lost and not moves
    assert observed.sync_ns("Z", 5) == (5 * MS + 48 * US if is_lost else asked_us * US)
    assert observed.sync_ns("Z", 4) == 4 * MS + 48 * US
