"""Which wait of a frame a metric is about, and why there may be none."""

from dataclasses import replace

import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.bus import BusFigures, LineFigures, Waiting

SERIES = kept(pa.table({"time_ns": pa.array([0, 1_000_000], pa.int64())}))
AXES = {name: AxisRecord("can1", 1, 1000.0) for name in "XZ"}
CAN = BusFigures("can1", 1_000_000, 1.0, 1.0, 1.0, 9, 0, "", (), ())
LINE = LineFigures(1000.0, 10.0, 5, 5, 3, 0, 0, ())
WAITS = (
    Waiting("SYNC", "", 0x80, 250.0),
    Waiting("Z.TPDO1", "Z", 0x181, 120.0),
    Waiting("Z.RPDO1", "Z", 0x201, 130.5),
)


def longest(*buses: BusFigures, axis: str = "") -> Observation:
    observed = Observed(facts(axes=AXES, buses=buses), SERIES)
    return observe(observed, parse_check(f"queueing_us_max{axis}", "> -1e9", ""))


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize(
    ("axis", "value", "note"),
    [("", 250.0, "SYNC"), (":Z", 130.5, "Z.RPDO1"), (":X", None, "nothing was sent")],
)
def test_frames_that_are_of_no_axis_wait_for_none(
    axis: str, value: float | None, note: str, turn: int
) -> None:
    found = longest(replace(CAN, waiting=WAITS[::turn]), axis=axis)
    assert (found.value, found.note) == (value, note)


def test_on_ethercat_nothing_waits_and_its_lines_are_named() -> None:
    lines = [replace(CAN, segment=name, line=LINE) for name in ("ecat1", "ecat2")]
    words = "nothing waits on EtherCAT ({}): its master alone sends"
    assert (longest(lines[0]).value, longest(lines[0]).note) == (None, words.format("ecat1"))
    assert longest(*lines).note == words.format("ecat1, ecat2")
    assert longest(lines[0], CAN).note == words.format("ecat1")
    beside = longest(*lines, replace(CAN, waiting=WAITS[1:2]))
    assert (beside.value, beside.note) == (120.0, "Z.TPDO1")
