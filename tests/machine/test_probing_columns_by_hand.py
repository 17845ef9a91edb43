"""Columns that write the probing units of an axis without a PLC task: values, words, times."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.plc.probing_columns import ProbingColumns
from axisrig.bench.rig.plc.axis_words import ProbingWrite
from axisrig.kernel.plc.probing import AxisWrites, LatchOrder, LatchTask, ProbingUnit

pytestmark = pytest.mark.interpreted


def columns(*written: ProbingWrite) -> tuple[ProbingColumns, dict[str, ProbingUnit], Any, Any]:
    """Axes Y and Z; returns the columns, the units, the channel and the clock."""
    units = {name: ProbingUnit() for name in "YZ"}
    axes = {name: SimpleNamespace(probing=unit) for name, unit in units.items()}
    channel: Any = SimpleNamespace(plc=SimpleNamespace(axis=axes), sync_ns=0)
    clock: Any = SimpleNamespace(now_ns=0)
    return ProbingColumns(channel, clock, 2_000_000, written), units, channel, clock


@pytest.mark.parametrize(
    ("position_mm", "position_units", "words"),
    [(0.57, 5700, "0.57"), (-0.57, -5700, "-0.57"), (0.0, 0, "0"),
     (-12.34567, -123457, "-12.34567"), (1.00006, 10001, "1.00006"),
     (100000.0, 10**9, "100000"), (8.1, 81000, "8.1")],
)  # fmt: skip
def test_a_position_is_given_in_the_nearest_unit_of_a_tenth_of_a_micrometre(
    position_mm: float, position_units: int, words: str
) -> None:
    write = ProbingWrite("Z", position_mm=position_mm)
    made, units, _, _ = columns(write)
    assert made.write(write) == f"Z.probing_position = {words} mm from the PLC"
    assert units["Z"].writes == AxisWrites(position_units=position_units)
    assert units["Y"].writes == AxisWrites()


def test_each_unit_keeps_what_the_others_get_and_may_get_less() -> None:
    made, units, _, clock = columns(ProbingWrite("Z", level=True))
    done = units["Z"]
    done.writes = AxisWrites(timestamp_ns=17, done_order=0)
    order = LatchOrder(LatchTask.ENABLE, 1)
    done.give(order, 1)
    done.give(LatchOrder(LatchTask.DISABLE, 1), 2)
    steps: list[tuple[ProbingWrite, str, AxisWrites]] = [
        (ProbingWrite("Z", level=True), "probing_signal = 1", AxisWrites(True, 17, None)),
        (ProbingWrite("Z", position_mm=2.5), "probing_position = 2.5 mm",
         AxisWrites(True, 17, 25000)),
        (ProbingWrite("Z", level=False), "probing_signal = 0", AxisWrites(False, 17, 25000)),
        (ProbingWrite("Z", position_mm=0.0), "probing_position = 0 mm", AxisWrites(False, 17, 0)),
    ]  # fmt: skip
    for number, (write, words, writes) in enumerate(steps, 10):
        clock.now_ns = number
        assert made.write(write) == f"Z.{words} from the PLC"
        assert units["Z"].writes == writes
    # No column acknowledges an order: the second one still waits
    assert (done.order, done.number, len(done.waiting)) == (order, 1, 1)
    made.write(ProbingWrite("Y", level=False))
    assert units["Y"].writes == AxisWrites(signal=False)


def test_the_task_is_there_where_a_column_writes_and_never_silent() -> None:
    """It has the cycle of the NC, and the SYNC of each cycle is that of every axis."""
    none, _, channel, _ = columns()
    none.begin_turn()
    assert none.task is None
    made, _, channel, _ = columns(ProbingWrite("Z", level=True))
    task = made.task
    assert task is not None
    assert task.sync_ns == {}
    for sync_ns in (2_000_000, 4_000_000):
        channel.sync_ns = sync_ns
        made.begin_turn()
        assert task.sync_ns == {"Y": sync_ns, "Z": sync_ns}
    assert task.cycle_ns == 2_000_000
    assert [task.silent_ns(now_ns) for now_ns in (0, 10**15)] == [None, None]
    assert task.late_cycles == 0
    assert task.stamps.bus_ns(123) == 123
