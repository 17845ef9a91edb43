"""Rows of runs that begin at one instant, and of the same block again: each has its own record."""

import pytest
from tests.machine.test_rows_of_blocks import DONE, STOPPED, Log, block, run

from axisrig.bench.record.blocks import STATES
from axisrig.kernel.channel.path.execution import BlockEnd
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


def states(log: Log) -> list[str]:
    return [STATES[state] for state in log.trace().rows().state]


@pytest.mark.parametrize("order", [(1, 2), (2, 1)])
def test_a_run_has_the_record_of_its_own_block_among_those_of_its_instant(
    order: tuple[int, int],
) -> None:
    """Of the block 2 an axis beside the path measures, with a signal; the block 1 has none."""
    log = Log()
    command = run(1)
    for line in order:
        log.record(block(line), 0.0, signal_ns=5 if line == 2 else None)
    log.carry_out(command)
    assert states(log) == ["no signal"]


def test_runs_beside_the_path_that_begin_together_have_each_its_own_state() -> None:
    log = Log()
    runs = [
        canon.IndependentMove(block(line), axis, 2.0, 600.0, measuring_type=1)
        for line, axis in ((1, "Z"), (2, "A"), (3, "X"))
    ]
    for one, signal_ns in zip(runs, (None, 4, None), strict=True):
        log.carry_out(one, 0.0)
        log.record(one.block, 0.0, signal_ns=signal_ns)
        log.ended.append((3 * MS, one, False))
    log.go(9)
    assert states(log) == ["no signal", "signal", "no signal"]


@pytest.mark.parametrize("how", [DONE, STOPPED])
def test_a_run_that_has_no_record_has_gone_no_way(how: BlockEnd) -> None:
    """What there is is of another block, or of another turn of it."""
    log = Log()
    log.path.travelled_mm = 4.0
    command = run(1)
    log.go(5)
    log.record(block(2), 5.0, signal_ns=5)
    log.record(command.block, 4.999, signal_ns=5)
    log.record(command.block, 5.001, signal_ns=5)
    log.carry_out(command, how=how)
    rows = log.trace().rows()
    assert rows.travelled_mm.tolist() == [0.0]
    assert STATES[rows.state[0]] == ("done" if how is DONE else "stopped")


@pytest.mark.parametrize(("took_ms", "way_mm"), [(0.0, 0.0), (1.0, 4.0)])
def test_a_block_that_ends_at_its_own_instant_has_gone_no_way(
    took_ms: float, way_mm: float
) -> None:
    """The path is that of the block before still."""
    log = Log()
    log.path.travelled_mm = 4.0
    log.carry_out(canon.LinearMove(block(1), {"X": 1.0}, False, 600.0), took_ms)
    assert log.trace().rows().travelled_mm.tolist() == [way_mm]
