"""What EtherCAT lines of a run have carried: load in closed form, working counters, AL states."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.ethercat.frame import time_on_wire_ns
from axisrig.bench.machine.ethercat.family import EthercatLines
from axisrig.bench.machine.ethercat.line_meter import LineMeter
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.record.bus import LineFigures
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.time.clock import MS, US

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
SHORTEST = 60
"""Bytes of a frame that has the wire for 84 bytes of 80 ns: 6.72 us."""
INDEX = 17
FIGURES = LineFigures(1000.0, 6.72, 20, 20, 3, 0, 0, ())


class Meant:
    """A line with one slave, whose frames are right where their last byte is 1."""

    def __init__(self) -> None:
        self.observers: list[Any] = []
        states = SimpleNamespace(observers=self.observers)
        self.now_ns = 0
        line: Any = SimpleNamespace(
            nodes={"Z": SimpleNamespace(states=states)},
            master=SimpleNamespace(image_in=lambda frame: 0 if frame[-1] else None),
        )
        clock: Any = self
        self.meter = LineMeter(line, clock)

    def cyclic(self, *are_right: bool) -> None:
        for is_right in are_right:
            frame = bytearray(SHORTEST)
            frame[INDEX], frame[-1] = 0x80, is_right
            self.meter.take(self.now_ns, bytes(frame))
            self.now_ns += MS

    def enters(self, state: AlState, code: int = 0) -> None:
        for observer in self.observers:
            observer(state, code)


@pytest.mark.interpreted
def test_the_load_is_that_of_the_frames_on_the_wire() -> None:
    """One frame of 6.72 us in each ms is 0.672 %, in every window too."""
    line = Meant()
    line.now_ns = MS
    line.cyclic(*[True] * 200)
    wire_ns = time_on_wire_ns(SHORTEST)
    assert wire_ns == 6720
    end_ns = 201 * MS
    assert line.meter.load_pct(end_ns) == pytest.approx(100 * 200 * wire_ns / end_ns)
    assert line.meter.worst_pct(100 * MS, end_ns) == pytest.approx(0.672)
    assert line.meter.worst_pct(MS, end_ns) == pytest.approx(0.672)
    assert line.meter.recent_pct(200 * MS, 100 * MS) == pytest.approx(0.672)


@pytest.mark.interpreted
def test_a_burst_is_seen_in_the_window_that_it_is_in() -> None:
    """Frames back to back for 0.5 ms make half of the worst ms busy."""
    line = Meant()
    wire_ns = time_on_wire_ns(SHORTEST)
    count = round(0.5 * MS / wire_ns)
    for number in range(count):
        line.meter.take(10 * MS + number * wire_ns, bytes(SHORTEST))
    assert line.meter.worst_pct(MS, 20 * MS) == pytest.approx(100 * count * wire_ns / MS)
    assert line.meter.worst_pct(100 * US, 20 * MS) == pytest.approx(100.0)
    assert line.meter.back == 0  # mailbox frames are no cyclic ones


@pytest.mark.interpreted
def test_a_run_that_is_shorter_than_the_window_is_all_of_it() -> None:
    """Four frames of 6.72 us in 5 ms; without a frame, or without time, there is no load."""
    line = Meant()
    assert line.meter.worst_pct(MS, 5 * MS) == line.meter.load_pct(5 * MS) == 0.0
    line.now_ns = MS
    line.cyclic(True, False, False, True)
    assert line.meter.worst_pct(100 * MS, 5 * MS) == pytest.approx(100 * 4 * 6720 / (5 * MS))
    assert line.meter.load_pct(5 * MS) == pytest.approx(100 * 4 * 6720 / (5 * MS))
    # The window ends with a frame: the whole of that at its end, none of the one at its begin
    assert line.meter.worst_pct(MS, 5 * MS) == pytest.approx(100 * 6720 / MS)
    assert line.meter.worst_pct(MS + 6720, 5 * MS) == pytest.approx(100 * 2 * 6720 / (MS + 6720))
    assert line.meter.worst_pct(MS, 0) == line.meter.load_pct(0) == 0.0
    assert line.meter.recent_pct(4 * MS, 2 * MS) == pytest.approx(100 * 2 * 6720 / (2 * MS))


@pytest.mark.interpreted
def test_wrong_counters_count_from_the_first_right_one_on() -> None:
    line = Meant()
    line.cyclic(False, False, True, False, False, True, False)
    meter = line.meter
    assert (meter.back, meter.wrong, meter.wrong_in_a_row) == (7, 3, 2)


@pytest.mark.interpreted
def test_al_states_are_events_once_a_slave_was_in_op() -> None:
    line = Meant()
    for state in (AlState.INIT, AlState.PREOP, AlState.SAFEOP, AlState.OP, AlState.OP):
        line.enters(state)
    assert line.meter.changes == []
    line.now_ns = 5 * MS
    line.enters(AlState.SAFEOP, 0x1B)
    line.enters(AlState.SAFEOP, 0x1B)
    line.enters(AlState.OP)
    fall, back = line.meter.changes
    assert (fall.time_ns, fall.port, fall.is_active) == (5 * MS, "Z", False)
    assert fall.state.startswith("SAFEOP, 0x001B, ")
    assert (back.state, back.is_active) == ("OP", True)


@pytest.mark.long
def test_a_run_leaves_the_figures_of_each_carrier(tmp_path: Path) -> None:
    """CAN and EtherCAT in one rig: each has its own, a line has cycle, counter and states."""
    program = tmp_path / "way.nc"
    program.write_text("%way\nN10 G90 G01 Z102 F6000\nN20 M30\n", encoding="utf-8")
    changes = [(parse_assignment("plant:z.position_start_mm=102"), as_written)]
    settings = read_settings(*read_rig(RIGS / "probe-xyz-mixed.toml"), changes)
    machine = Machine(settings, read_program(program, tuple(settings.rig.axis)))
    try:
        facts = facts_of(machine, machine.run())
    finally:
        machine.close()
    lines = {bus.segment: bus.line for bus in facts.buses}
    on_line = {name for name, table in settings.segment.items() if table.is_line}
    assert {name for name, line in lines.items() if line is not None} == on_line == {"ec1"}
    for name in on_line:
        line = lines[name]
        assert line is not None
        assert (line.wrong, line.sent - line.back) == (0, 0)
        axes = [axis for axis, table in settings.rig.axis.items() if table.segment == name]
        assert line.counter == 3 * len(axes)
        assert line.slaves == tuple((axis, "OP") for axis in axes)


@pytest.mark.interpreted
def test_a_live_view_has_the_load_and_the_losses_of_each_line_now(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """10 frames in the first 10 ms, and 5 in the last of 200 ms: the view has the last 100 ms."""
    lines = {name: Meant() for name in ("ec1", "ec2")}
    lines["ec1"].cyclic(*[True] * 10)
    for line, count in zip(lines.values(), (5, 1), strict=True):
        line.now_ns = 190 * MS
        line.cyclic(*[True] * count)
    segments = {"ec1": SimpleNamespace(frames=15, lost=2), "ec2": SimpleNamespace(frames=1, lost=0)}
    monkeypatch.setattr(
        EthercatLines, "_line_figures", lambda _, name: replace(FIGURES, counter=len(name))
    )
    family: Any = object.__new__(EthercatLines)
    family.lines = {name: SimpleNamespace(segment=each) for name, each in segments.items()}
    family._meters = {name: line.meter for name, line in lines.items()}
    family._bench = SimpleNamespace(scheduler=SimpleNamespace(now_ns=200 * MS))
    first, second = family.shown()
    assert [one["segment"] for one in (first, second)] == ["ec1", "ec2"]
    assert [one["load_pct"] for one in (first, second)] == pytest.approx(
        [100 * count * 6720 / (100 * MS) for count in (5, 1)]
    )
    assert [(one["frames"], one["error_frames"]) for one in (first, second)] == [(15, 2), (1, 0)]
    assert first["bitrate"] == 100_000_000
    assert (first["is_outside"], first["lost"], first["counters"]) == (False, None, [])
    assert first["line"]["counter"] == 3
