"""The block trace of a channel: what it notes of begin, end, wait and way of each command.

Closed forms with a = 1000 mm/s² and cycles of 1 ms: a move of L at v takes L/v + v/a. What the set
positions of the interpolation do is seen by an observer of its own.
"""

from collections.abc import Callable
from typing import Any, get_args

import pytest
from tests.channel.conftest import MS, ChannelBench

from axisrig.bench.machine.recording import block_log
from axisrig.bench.machine.recording.block_log import BlockLog
from axisrig.bench.record.blocks import STATES, BlockTrace
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

Make = Callable[..., ChannelBench]


def watched(bench: ChannelBench) -> BlockLog:
    log = BlockLog(bench.scheduler, bench.channel)
    bench.channel.execution.watches.append(log)
    return log


def noted(bench: ChannelBench, *commands: canon.Command) -> BlockTrace:
    """Run a program and return its block trace."""
    log = watched(bench)
    bench.run([*commands, canon.EndOfProgram(Block(99, 990, "N990 M30"))])
    return log.trace()


def table(trace: BlockTrace) -> list[tuple[int | None, str, str]]:
    """Number, kind and state of each row."""
    rows = trace.rows()
    return [
        (trace.lines[line].number, trace.kinds[kind], STATES[state])
        for line, kind, state in zip(rows.line, rows.kind, rows.state, strict=True)
    ]


@pytest.mark.long
def test_a_move_begins_and_ends_with_its_set_position(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    trace = noted(bench, words.move(1, 3000.0, Y=30.0, Z=40.0), words.move(2, 600.0, Z=35.0))
    assert table(trace) == [
        (10, "feed", "done"),
        (20, "feed", "done"),
        (990, "end of program", "done"),
    ]
    rows = trace.rows()
    # 50 mm at 50 mm/s: Z has 4/5 of the path, which so has 1250 mm/s²; then 5 mm at 10 mm/s
    assert (rows.end_ns - rows.begin_ns)[:2].tolist() == [1040 * MS, 510 * MS]
    assert rows.begin_ns[1] == rows.end_ns[0]
    assert rows.path_mm[:2].tolist() == [50.0, 5.0]
    assert rows.travelled_mm[:2].tolist() == pytest.approx([50.0, 5.0])
    assert rows.feed_mm_min[:2].tolist() == [3000.0, 600.0]
    # A cycle at t gives the set position that belongs to t + 1 ms
    moving = [sample.time_ns for sample in bench.samples if 0.0 < sample.set_mm[0] < 30.0]
    assert moving[0] == rows.begin_ns[0]
    assert moving[-1] == rows.end_ns[0] - 2 * MS


@pytest.mark.long
def test_what_waits_is_seen(channel_bench: Make, words: Any) -> None:
    """A dwell time lasts, an exact stop waits until the axis is in its window."""
    bench = channel_bench(words.axis("Z", window_mm=0.001))
    dwell = canon.Dwell(Block(2, 20, "N20 G4 X0.25"), 250 * MS)
    stop = canon.ExactStop(Block(3, 30, "N30 G60"))
    trace = noted(bench, dwell, words.move(1, 600.0, Z=5.0), stop, words.wait(4))
    assert table(trace)[:3] == [
        (20, "dwell", "done"),
        (10, "feed", "done"),
        (30, "exact stop", "done"),
    ]
    rows = trace.rows()
    assert rows.end_ns[0] - rows.begin_ns[0] == 250 * MS
    assert rows.due_ns[2] == rows.end_ns[1]
    assert rows.begin_ns[2] == rows.end_ns[2]
    # The loop of first order with Kv 40/s has the rest of its lag of 0.25 mm below 1 um after
    # ln(250)/40 s = 138 ms at most; the ramp of 10 ms takes some away, but not all but 10 um
    assert 58 * MS < rows.begin_ns[2] - rows.due_ns[2] < 150 * MS


@pytest.mark.long
def test_a_loop_that_asks_the_plc_side_is_one_row(channel_bench: Make, words: Any) -> None:
    block = Block(1, 10, "N10 $WHILE V.E.X == 0")
    bench = channel_bench(words.axis("Z"))
    turns = [canon.Wait(block, for_cycle=True) for _ in range(40)]
    trace = noted(bench, *turns, words.move(2, 600.0, Z=5.0))
    assert table(trace)[0] == (10, "wait for machine", "done")
    assert trace.count == 3
    rows = trace.rows()
    assert rows.end_ns[0] - rows.begin_ns[0] == 40 * MS
    assert rows.due_ns[1] == rows.end_ns[0]


def test_a_wait_that_takes_no_time_is_no_row(channel_bench: Make, words: Any) -> None:
    trace = noted(channel_bench(words.axis("Z")), words.wait(1), words.wait(2))
    assert table(trace) == [(990, "end of program", "done")]


@pytest.mark.long
@pytest.mark.parametrize(("plane_mm", "state"), [(110.0, "signal"), (None, "no signal")])
def test_a_measurement_run_says_whether_it_had_its_signal(
    channel_bench: Make, words: Any, plane_mm: float | None, state: str
) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=plane_mm)
    trace = noted(bench, words.probe(1, 1200.0, error_no_signal=False, Z=100.0))
    assert table(trace)[0] == (10, "measurement run", state)
    rows, (record,) = trace.rows(), bench.channel.records
    assert (rows.begin_ns[0], rows.end_ns[0]) == (record.begin_ns, record.end_ns)
    assert rows.path_mm[0] == pytest.approx(30.0, abs=1e-4)
    assert rows.travelled_mm[0] == pytest.approx(130.0 - bench.final_mm("Z"), abs=1e-4)


def test_an_alarm_stops_the_row_and_what_waits_has_not_begun(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z"))
    log = watched(bench)
    bench.prepare([words.move(1, 3000.0, Z=50.0), words.end()])
    bench.scheduler.run_until(_until(bench, lambda: bench.channel.path.is_moving) + 300 * MS)
    bench.channel.stop(Alarm(900070))
    bench.finish()
    trace = log.trace()
    assert table(trace) == [(10, "feed", "stopped")]
    assert trace.rows().travelled_mm[0] == pytest.approx(bench.final_mm("Z"), abs=1e-9)
    assert trace.rows().travelled_mm[0] < trace.rows().path_mm[0] == 50.0


@pytest.mark.long
def test_a_move_to_where_the_axis_is_has_no_way(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z"))
    rows = noted(bench, words.move(1, 3000.0, Z=50.0), words.move(2, 3000.0, Z=50.0)).rows()
    assert rows.path_mm[:2].tolist() == [50.0, 0.0]
    assert rows.travelled_mm[:2].tolist() == pytest.approx([50.0, 0.0])


@pytest.mark.long
def test_a_feedhold_is_an_interval(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z"))
    log = watched(bench)
    bench.prepare([words.move(1, 3000.0, Z=50.0), words.end()])
    begin_ns = _until(bench, lambda: bench.channel.path.is_moving) + 300 * MS
    for is_on in (True, False):
        bench.scheduler.run_until(begin_ns if is_on else begin_ns + 500 * MS)
        bench.channel.plc.feedhold = is_on
    bench.finish()
    trace = log.trace()
    ((hold_ns, free_ns),) = trace.holds
    assert free_ns - hold_ns == 500 * MS
    assert table(trace)[0] == (10, "feed", "done")
    # 50 ms to stop and 50 ms to speed up again do half their way each: 50 ms more than the hold
    assert trace.rows().end_ns[0] - trace.rows().begin_ns[0] == pytest.approx(1550 * MS, abs=2 * MS)


def _until(bench: ChannelBench, is_true: Callable[[], bool]) -> int:
    assert bench.scheduler.run_while(lambda: not is_true(), 10**10)
    return bench.scheduler.now_ns


@pytest.mark.long
def test_an_axis_beside_the_path_has_its_own_end(channel_bench: Make, words: Any) -> None:
    beside = canon.IndependentMove(Block(1, 10, "N10 Z[INDP_ASYN]"), "Z", 50.0, 3000.0)
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    trace = noted(bench, beside, words.move(2, 600.0, Y=5.0))
    assert table(trace)[:2] == [(10, "independent move", "done"), (20, "feed", "done")]
    rows = trace.rows()
    assert rows.begin_ns[0] == rows.begin_ns[1]
    assert (rows.end_ns - rows.begin_ns)[:2].tolist() == pytest.approx(
        [1050 * MS, 510 * MS], abs=MS
    )
    assert rows.path_mm[0] == 50.0


def test_a_reset_stops_the_row_of_an_axis_beside_the_path(channel_bench: Make, words: Any) -> None:
    beside = canon.IndependentMove(Block(1, 10, "N10 Z[INDP_ASYN]"), "Z", 50.0, 3000.0)
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    log = watched(bench)
    bench.prepare([beside, words.move(2, 600.0, Y=5.0), words.end()])
    begin_ns = _until(bench, lambda: bench.channel.path.is_moving) + 100 * MS
    bench.scheduler.run_until(begin_ns)
    bench.channel.plc.wants_reset = True
    bench.finish()
    trace = log.trace()
    assert table(trace) == [(10, "independent move", "reset"), (20, "feed", "reset")]
    # 50 mm/s down with 1000 mm/s² takes 50 ms
    ends_ns = trace.rows().end_ns - begin_ns
    assert ends_ns[0] == pytest.approx(50 * MS, abs=2 * MS)


@pytest.mark.parametrize("kind", get_args(canon.Command), ids=lambda kind: kind.__name__)
def test_every_command_has_a_kind(kind: type) -> None:
    """Also those that no test above gives to a machine."""
    of_fields = (canon.LinearMove, canon.MeasuringRun, canon.IndependentMove)
    assert kind in block_log.KINDS or kind in of_fields


@pytest.mark.long
def test_nothing_moves_otherwise_because_of_it(channel_bench: Make, words: Any) -> None:
    def frames(is_noted: bool) -> list[tuple[int, int, bytes]]:
        bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=110.0)
        if is_noted:
            watched(bench)
        bench.run([words.probe(1, 1200.0, Z=60.0), words.wait(1), words.end()])
        return bench.frames

    assert frames(True) == frames(False)


@pytest.mark.long
def test_an_axis_that_only_moves_in_a_measuring_block_has_the_state_of_its_run(
    channel_bench: Make, words: Any
) -> None:
    """X moves and is not asked, Z measures, Y does neither."""
    bench = channel_bench(
        *map(words.axis, "XY"), words.axis("Z", start_mm=20.0), plane_mm=15.0, bitrate=5_000_000
    )
    seen: dict[str, set[str | None]] = {axis: set() for axis in "XYZ"}

    def look(channel: Any) -> None:
        for axis, states in seen.items():
            states.add(channel.measurement.state_of(axis))

    bench.channel.observers.append(look)
    target = {"X": 5.0, "Z": 10.0}
    run = canon.MeasuringRun(
        words.probe(1, 600.0, Z=0.0).block, target, ("X", "Z"), ("Z",), 600.0, 1
    )
    bench.run([run, words.wait(2), words.move(3, 600.0, Y=1.0), words.end()])
    assert bench.alarm_ids == []
    assert seen["Y"] == {None}
    assert seen["X"] == seen["Z"]
    assert len(seen["X"]) > 2
    assert bench.channel.measurement.state_of("Z") is None
