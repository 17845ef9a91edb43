"""Rows of the block trace by hand: files, ways, waits, runs and axes beside the path."""

import math
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.recording.block_log import BlockLog
from axisrig.bench.record.blocks import STATES, BlockTrace
from axisrig.kernel.channel.path.execution import BlockEnd
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.measuring_types import measuring_types
from axisrig.kernel.time.clock import MS

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

DONE, STOPPED, RESET = BlockEnd


class Log:
    """A log of a channel that stands at X 0, Y 0, Z 10, A 0; `go` lets time pass."""

    def __init__(self, folder: str | None = None) -> None:
        self.clock: Any = SimpleNamespace(now_ns=0)
        self.path = SimpleNamespace(
            position_mm=lambda: {"X": 0.0, "Y": 0.0, "Z": 10.0, "A": 0.0},
            position_acs_mm=lambda axis: {"Z": 10.0}.get(axis, 0.0),
            transformation=SimpleNamespace(kinematic=None),
            interpolator=SimpleNamespace(path=SimpleNamespace(length_mm=77.0)),
            travelled_mm=0.0,
            holds=[],
        )
        self.records: list[Any] = []
        self.ended: list[tuple[int, Any, bool]] = []
        self.alarms: list[tuple[int, bool]] = []
        channel: Any = SimpleNamespace(
            path=self.path,
            records=self.records,
            single=SimpleNamespace(independent=SimpleNamespace(ended=self.ended)),
        )
        self.channel = channel
        self.log = BlockLog(self.clock, channel, folder)

    def go(self, time_ms: float) -> None:
        self.clock.now_ns += round(time_ms * MS)

    def carry_out(self, command: Any, took_ms: float = 1.0, how: BlockEnd = DONE) -> None:
        self.log.waits(command)
        self.log.begins(command)
        self.go(took_ms)
        self.log.ends(how)

    def record(self, block: Block, begin_ms: float, **more: Any) -> None:
        given = {"start_ns": 1, "signal_ns": None, "fixed_stop": None} | more
        self.records.append(
            SimpleNamespace(block=str(block), begin_ns=round(begin_ms * MS), **given)
        )

    def trace(self) -> BlockTrace:
        self.channel.alarm_ns = [at * MS for at, _ in self.alarms]
        self.channel.alarms = [SimpleNamespace(ends_program=ends) for _, ends in self.alarms]
        return self.log.trace()

    def rows(self) -> list[tuple[str, float, float, float, str]]:
        """Kind, due, begin and end in ms, state."""
        trace = self.trace()
        rows = trace.rows()
        return [
            (trace.kinds[kind], due / MS, begin / MS, end / MS, STATES[state])
            for kind, due, begin, end, state in zip(
                rows.kind, rows.due_ns, rows.begin_ns, rows.end_ns, rows.state, strict=True
            )
        ]


def block(line: int, file: str | None = None) -> Block:
    return Block(line, 10 * line, f"N{10 * line}", file=file)


def move(line: int, **target: float) -> canon.LinearMove:
    return canon.LinearMove(block(line), target, False, 600.0)


def run(line: int, measuring_type: int = 1) -> canon.MeasuringRun:
    return canon.MeasuringRun(block(line), {"Z": 0.0}, ("Z",), ("Z",), 600.0, measuring_type)


@pytest.mark.parametrize(
    ("folder", "file", "shown"),
    [
        ("/jobs/nc", "/jobs/nc/part.nc", "part.nc"),
        ("/jobs/nc", "/jobs/cycles/probe.nc", "../cycles/probe.nc"),
        ("/jobs/nc", "/jobs/nc/sub/a.nc", "sub/a.nc"),
        (None, "/jobs/nc/part.nc", "/jobs/nc/part.nc"),
        ("/jobs/nc", None, ""),
        (None, None, ""),
    ],
)
def test_a_file_is_named_from_the_folder_of_the_program(
    folder: str | None, file: str | None, shown: str
) -> None:
    log = Log(folder)
    log.carry_out(canon.Dwell(block(3, file), MS))
    (line,) = log.trace().lines
    assert (line.file, line.line, line.number, line.text) == (shown, 3, 30, "N30")


def test_a_block_that_comes_again_is_one_line_and_two_rows() -> None:
    log = Log()
    first, second = canon.Dwell(block(1), MS), canon.Dwell(block(2), MS)
    for command in (first, second, first):
        log.carry_out(command)
    trace = log.trace()
    assert [line.number for line in trace.lines] == [10, 20]
    assert (trace.rows().line.tolist(), trace.kinds, trace.count) == ([0, 1, 0], ("dwell",), 3)


@pytest.mark.parametrize(
    ("kinematic", "target", "way"),
    [
        # All axes count, degrees as mm: 3, 4, 12; only what changes moves
        (None, {"X": 3.0, "Y": 4.0, "A": 12.0}, 13.0),
        (None, {"Z": 4.0}, 6.0),
        # With a kinematic the way of the tool centre point, else of what turns
        (object(), {"X": 3.0, "Y": 4.0, "A": 12.0}, 5.0),
        (object(), {"A": -30.0}, 30.0),
    ],
)
def test_the_way_of_a_straight_block(
    kinematic: object, target: dict[str, float], way: float
) -> None:
    for kind in (move, lambda _line, **to: canon.MeasuringRun(block(1), to, (), (), 600.0, 1)):
        log = Log()
        log.path.transformation.kinematic = kinematic
        log.carry_out(kind(1, **target))
        assert log.trace().rows().path_mm.tolist() == pytest.approx([way])


def test_the_way_of_a_circle_and_of_an_axis_beside_the_path() -> None:
    """A circle is as long as its path when it has moved; Z goes from 10 to 2.5."""
    log = Log()
    arc = canon.ArcMove(block(1), {"X": 0.0}, {}, {}, math.pi, 300.0)
    log.path.travelled_mm = 40.0
    log.carry_out(arc)
    log.carry_out(arc, 0.0, STOPPED)
    log.carry_out(canon.IndependentMove(block(2), "Z", 2.5, 1200.0))
    rows = log.trace().rows()
    assert rows.path_mm.tolist() == pytest.approx([77.0, math.nan, 7.5], nan_ok=True)
    assert rows.travelled_mm.tolist() == pytest.approx([40.0, 0.0, math.nan], nan_ok=True)
    assert rows.feed_mm_min.tolist() == pytest.approx([300.0, 300.0, 1200.0])


def test_rapid_traverse_has_no_feed_and_another_kind() -> None:
    log = Log()
    log.carry_out(canon.LinearMove(block(1), {"X": 1.0}, True, None))
    log.carry_out(move(2, X=1.0))
    trace = log.trace()
    assert trace.kinds == ("rapid", "feed")
    assert trace.rows().feed_mm_min.tolist() == pytest.approx([math.nan, 600.0], nan_ok=True)


def test_what_waits_is_due_before_it_begins() -> None:
    log = Log()
    dwell = canon.Dwell(block(1), MS)
    log.log.waits(dwell)
    log.go(5)
    log.log.begins(dwell)
    log.go(2)
    log.log.ends(DONE)
    log.log.waits(canon.ExactStop(block(2)))
    log.go(3)
    log.log.ends(RESET)
    log.log.ends(DONE)  # nothing is under way any more
    assert log.rows() == [
        ("dwell", 0.0, 5.0, 7.0, "done"),
        ("exact stop", 7.0, 10.0, 10.0, "not begun"),
    ]


@pytest.mark.parametrize(("how", "state"), [(DONE, "done"), (STOPPED, "stopped"), (RESET, "reset")])
def test_a_block_ends_as_it_was_ended(how: BlockEnd, state: str) -> None:
    log = Log()
    log.carry_out(move(1, X=1.0), how=how)
    assert [row[-1] for row in log.rows()] == [state]


def test_waits_for_the_next_cycle_are_one_row_for_their_block() -> None:
    """Three turns of one loop, two of the next one; a block under way is one too."""
    log = Log()
    blocks = {line: block(line) for line in (1, 2)}
    for line in (1, 1, 1, 2, 2):
        log.carry_out(canon.Wait(blocks[line], for_cycle=True))
    log.log.begins(canon.Dwell(block(3), MS))
    log.go(4)
    assert log.rows() == [
        ("wait for machine", 0.0, 0.0, 3.0, "done"),
        ("wait for machine", 3.0, 3.0, 5.0, "done"),
        ("dwell", 5.0, 5.0, 9.0, "under way"),
    ]


@pytest.mark.parametrize("is_same_block", [False, True])
def test_what_waits_behind_a_loop_ends_the_loop_and_is_due_from_then_on(
    is_same_block: bool,
) -> None:
    """Two turns, then an exact stop that waits for 5 ms; it may be of the block of the loop."""
    log, loop = Log(), block(1)
    for _ in range(2):
        log.carry_out(canon.Wait(loop, for_cycle=True))
    stop = canon.ExactStop(loop if is_same_block else block(2))
    log.log.waits(stop)
    log.go(5)
    log.log.begins(stop)
    log.go(3)
    log.log.ends(DONE)
    assert log.rows() == [
        ("wait for machine", 0.0, 0.0, 2.0, "done"),
        ("exact stop", 2.0, 7.0, 10.0, "done"),
    ]


@pytest.mark.parametrize("second", [1, 2])
def test_a_loop_that_waits_before_its_turns_is_due_when_it_begins_to_wait(second: int) -> None:
    """Each turn waits for 2 ms and takes 1 ms; another loop behind it is another row."""
    log = Log()
    blocks = {line: block(line) for line in (1, 2)}
    for line in (1, 1, second):
        turn = canon.Wait(blocks[line], for_cycle=True)
        log.log.waits(turn)
        log.go(2)
        log.log.begins(turn)
        log.go(1)
        log.log.ends(DONE)
    spans = [(0.0, 2.0, 9.0)] if second == 1 else [(0.0, 2.0, 6.0), (6.0, 8.0, 9.0)]
    assert [row[1:4] for row in log.rows()] == spans


def test_what_waits_behind_a_loop_when_the_program_ends_has_not_begun() -> None:
    """By a reset, by an alarm, or as the recording ends."""
    for how in (RESET, STOPPED, None):
        log = Log()
        log.carry_out(canon.Wait(block(1), for_cycle=True))
        log.log.waits(canon.ExactStop(block(2)))
        log.go(4)
        if how is not None:
            log.log.ends(how)
            log.go(6)  # what comes later is none of it
        assert log.rows() == [
            ("wait for machine", 0.0, 0.0, 1.0, "done"),
            ("exact stop", 1.0, 5.0, 5.0, "not begun"),
        ]


@pytest.mark.parametrize(("how", "state"), [(STOPPED, "stopped"), (RESET, "reset")])
def test_a_loop_that_is_broken_off_ends_then(how: BlockEnd, state: str) -> None:
    log, loop = Log(), block(1)
    for each in (DONE, how):
        log.carry_out(canon.Wait(loop, for_cycle=True), how=each)
    log.go(3)
    log.carry_out(canon.Dwell(block(2), MS))
    assert log.rows() == [
        ("wait for machine", 0.0, 0.0, 2.0, state),
        ("dwell", 5.0, 5.0, 6.0, "done"),
    ]


def test_a_loop_under_way_lasts_until_the_recording_ends() -> None:
    log = Log()
    log.carry_out(canon.Wait(block(1), for_cycle=True))
    log.go(6)
    found = [("wait for machine", 0.0, 0.0, 7.0, "under way")]
    assert log.rows() == found
    assert log.rows() == found  # asked again


def test_a_command_that_waits_twice_is_due_from_the_first_time_on() -> None:
    log = Log()
    dwell = canon.Dwell(block(1), MS)
    for _ in range(3):
        log.log.waits(dwell)
        log.go(2)
    log.log.begins(dwell)
    log.go(1)
    log.log.ends(DONE)
    assert [row[1:4] for row in log.rows()] == [(0.0, 6.0, 7.0)]


WORDS = {  # docs/recording.md, Blocks
    canon.Homing: "homing", canon.DistanceCommand: "distance control", canon.Dwell: "dwell",
    canon.ExactStop: "exact stop", canon.ProgramStop: "programmed stop",
    canon.TechnologyFunction: "function", canon.WaitIndependent: "wait for axes",
    canon.Wait: "wait for machine", canon.DriveWrite: "drive value",
    canon.DriveRead: "drive value", canon.DriveWait: "drive value",
    canon.AxisLinkOn: "axes of the channel", canon.AxisLinkOff: "axes of the channel",
    canon.AxisExchange: "axes of the channel", canon.AdoptActual: "axes of the channel",
    canon.SlopeChoice: "dynamics", canon.DynamicWeights: "dynamics",
    canon.KinematicChoice: "kinematic", canon.ProbeSettings: "probe settings",
    canon.DefaultProbes: "probe settings", canon.PrepareProbe: "probe settings",
    canon.ExternalWrite: "PLC variable", canon.Message: "message", canon.Warn: "warning",
    canon.EndOfProgram: "end of program", canon.ArcMove: "arc",
}  # fmt: skip


def test_a_row_is_of_the_kind_that_the_page_names() -> None:
    """In the order in which they come, each kind once; a row has no way unless it moves."""
    log = Log()
    for command in WORDS:
        made = command.__new__(command)
        object.__setattr__(made, "block", block(1))
        if command is canon.Wait:
            object.__setattr__(made, "for_cycle", False)
        if command is not canon.ArcMove:
            log.carry_out(made)
    log.carry_out(canon.ArcMove(block(1), {"X": 0.0}, {}, {}, math.pi, 300.0))
    trace = log.trace()
    rows = trace.rows()
    assert [trace.kinds[kind] for kind in rows.kind] == [*WORDS.values()]
    assert trace.kinds == tuple(dict.fromkeys(WORDS.values()))
    assert [number for number, way in enumerate(rows.path_mm) if not math.isnan(way)] == [25]
    assert [number for number, feed in enumerate(rows.feed_mm_min) if feed == 300.0] == [25]


def test_a_wait_of_the_decoder_is_a_row_when_it_takes_time_or_is_cut_off() -> None:
    log = Log()
    log.carry_out(canon.Wait(block(1)), 0.0)
    log.carry_out(canon.Wait(block(2)), 2.0)
    log.carry_out(canon.Wait(block(3)), 0.0, STOPPED)
    assert [(row[0], row[-1]) for row in log.rows()] == [
        ("wait for machine", "done"), ("wait for machine", "stopped"),
    ]  # fmt: skip
    turns = Log()
    for _ in range(2):  # each is a row that ends by itself, also for one block
        turns.carry_out(canon.Wait(block(1)), 2.0)
        turns.go(3)
    assert [row[2:4] for row in turns.rows()] == [(0.0, 2.0), (5.0, 7.0)]


STOP: Any = SimpleNamespace(relax_begin_ns=None)
RELAXED: Any = SimpleNamespace(relax_begin_ns=5)


@pytest.mark.parametrize(
    ("more", "how", "state", "travelled_mm"),
    [
        ({"signal_ns": 3}, DONE, "signal", 4.0),
        ({"signal_ns": 0}, DONE, "signal", 4.0),
        ({}, DONE, "no signal", 4.0),
        ({"signal_ns": 3, "fixed_stop": STOP}, DONE, "stop found", 4.0),
        ({"fixed_stop": STOP}, DONE, "no stop", 4.0),
        # A path of its own took the lag away
        ({"signal_ns": 3, "fixed_stop": RELAXED}, DONE, "stop found", math.nan),
        ({"signal_ns": 3}, STOPPED, "stopped", 4.0),
        ({"start_ns": None}, STOPPED, "stopped", 0.0),
        ({"start_ns": None}, DONE, "done", 0.0),
    ],
)
def test_a_run_has_the_state_of_its_own_record(
    more: dict[str, Any], how: BlockEnd, state: str, travelled_mm: float
) -> None:
    """The same block has measured before, with a signal and without."""
    log = Log()
    command = run(1)
    for begin_ms, other in ((0.0, {"signal_ns": 1}), (1.0, {}), (2.0, more)):
        log.record(command.block, begin_ms, **other)
        log.path.travelled_mm = 4.0
        log.carry_out(command, how=DONE if begin_ms < 2.0 else how)
    log.record(command.block, 9.0, signal_ns=9)  # and once more, later
    rows = log.trace().rows()
    states = [STATES[state] for state in rows.state]
    assert states == ["signal", "no signal", state]
    assert rows.travelled_mm[2] == pytest.approx(travelled_mm, nan_ok=True)


def test_a_run_to_a_stop_is_another_kind_than_one_to_a_signal() -> None:
    """By the table of measuring types."""
    log = Log()
    types = {kind.runs_to_stop: number for number, kind in measuring_types().items()}
    for runs_to_stop in (False, True):
        log.carry_out(run(1, types[runs_to_stop]))
    assert log.trace().kinds == ("measurement run", "fixed stop")


def test_axes_beside_the_path_have_ends_of_their_own() -> None:
    """The program goes on at once. Ended; stopped by an alarm; by a reset; still under way; none to
    go. An alarm that does not end the program stops nothing.
    """
    log = Log()
    moves = [
        canon.IndependentMove(block(n), "Z", to, 600.0)
        for n, to in enumerate((2.0, 3.0, 4.0, 5.0, 10.0), 1)
    ]
    for one in moves:
        log.carry_out(one, 0.0)
    log.ended += [(3 * MS, moves[0], False), (4 * MS, moves[1], True), (6 * MS, moves[2], True)]
    log.alarms = [(4, True), (5, False)]
    log.go(20)
    log.carry_out(canon.EndOfProgram(block(9)), 0.0)
    found = [(row[0], row[3], row[4]) for row in log.rows()]
    assert found == [
        ("independent move", 3.0, "done"),
        ("independent move", 4.0, "stopped"),
        ("independent move", 6.0, "stopped"),
        ("independent move", 20.0, "under way"),
        ("independent move", 0.0, "done"),
        ("end of program", 20.0, "done"),
    ]


@pytest.mark.parametrize("alarms", [[], [(1, True)], [(4, False)], [(7, True)]])
def test_without_an_alarm_in_its_time_an_axis_beside_the_path_was_reset(
    alarms: list[tuple[int, bool]],
) -> None:
    log = Log()
    log.go(2)
    one = canon.IndependentMove(block(1), "Z", 2.0, 600.0)
    log.carry_out(one, 0.0)
    log.ended.append((6 * MS, one, True))
    log.alarms = alarms
    log.go(9)
    assert [row[-1] for row in log.rows()] == ["reset"]


@pytest.mark.parametrize(("signal_ns", "state"), [(3, "signal"), (None, "no signal")])
def test_a_run_beside_the_path_has_the_state_of_its_record(
    signal_ns: int | None, state: str
) -> None:
    log = Log()
    one = canon.IndependentMove(block(1), "Z", 2.0, 600.0, measuring_type=1)
    log.carry_out(one, 0.0)
    log.record(one.block, 1.0, signal_ns=signal_ns)
    log.record(one.block, 8.0, signal_ns=None if signal_ns else 9)  # of a later turn
    log.ended.append((5 * MS, one, False))
    log.go(9)
    assert [(row[0], row[-1]) for row in log.rows()] == [("independent run", state)]


def test_feedholds_are_spans_and_the_last_one_may_last() -> None:
    log = Log()
    log.path.holds = [(2, True), (5, False), (7, True)]
    log.clock.now_ns = 11
    assert log.trace().holds == ((2, 5), (7, 11))
    assert Log().trace().holds == ()
