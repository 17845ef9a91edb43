"""Runs to a fixed stop on an axis with a frozen offset: the axis ends where it is."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
OFFSET_MM, STOP_MM = 0.75, 12.0
LAG = FixedStopSettings(lag_limit_mm=1.0, min_time_ns=50 * MS)


@pytest.mark.long
@pytest.mark.parametrize("beside", [False, True])
def test_behind_a_fixed_stop_the_set_position_is_the_actual_one(
    distance_bench: Make, say: Any, words: Any, beside: bool
) -> None:
    made = distance_bench(
        lambda _time_ns: OFFSET_MM,
        spec={"source": "FIXED_STOP", "fixed_stop": LAG, "stop_mm": STOP_MM},
    )
    block = Block(4, 40, "N40")
    run = (
        canon.IndependentMove(block, "Z", 30.0, feed_mm_min=600.0, measuring_type=7)
        if beside
        else words.probe(4, 600.0, 7, Z=30.0)
    )
    made.run(
        say.command("on", set_pos_mm=0.0), say.dwell(100), say.command("freeze"), run,
        canon.WaitIndependent(block, ("Z",)), say.dwell(50), say.command("off", wait=True),
    )  # fmt: skip
    assert made.alarm_ids == []
    (record,) = made.channel.records
    assert record.latched_mm["Z"] == pytest.approx(STOP_MM, abs=2 / say.per_mm)
    at_rest = next(k for k, ns in enumerate(made.seen.time_ns) if ns > record.end_ns) + 10
    assert made.seen.offset_mm[at_rest] == pytest.approx(OFFSET_MM, abs=2 / say.per_mm)
    assert made.seen.sent_mm[at_rest] == pytest.approx(STOP_MM, abs=2 / say.per_mm)
