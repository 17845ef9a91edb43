"""The stamping terminal as the PLC has it: registers of a slave controller, written by hand."""

import struct
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.ethercat.line_terminal import (
    LineTerminal,
    inputs_of,
    register_inputs,
)
from axisrig.bench.machine.ethercat.slaves import slave_of as drive_of_line
from axisrig.bench.machine.ethercat.slaves import terminal_slave
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.reading.plc_task import TerminalTable
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.time.clock import MS, S
from axisrig.kernel.time.scheduler import new_scheduler

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "plc-timestamp-ethercat.toml"
RISEN, FALLEN, LEVEL = 1, 2, 4
"""Of LATCH0_STATUS, LATCH1_STATUS (registers.csv)."""


def registers(first: int, second: int, *times: int) -> bytes:
    """0x09AE to 0x09CF: both status, then rising and falling edge of each input."""
    return bytes((first, second)) + struct.pack("<4Q", *times)


def terminal(**table: Any) -> tuple[LineTerminal, Any]:
    clock: Any = SimpleNamespace(now_ns=0)
    slave: Any = None
    return LineTerminal(slave, TerminalTable(segment="ec1", **table), clock, 2 * MS), clock


@pytest.mark.parametrize("number", [1, 2])
def test_an_input_is_its_own_level_and_stamps(number: int) -> None:
    """The other one is off where it is on, and has other stamps."""
    found, _ = terminal(**{f"input_{number}": "probe"})
    assert found.image[number].input is False
    for levels, stamps in (((LEVEL, 0), (11, 12, 21, 22)), ((RISEN | FALLEN, LEVEL), (1, 2, 3, 4))):
        found.taken(registers(*levels, *stamps))
        seen = found.image[number]
        assert [*found.image] == [number]
        assert seen.input == bool(levels[number - 1] & LEVEL)
        assert (seen.latch_pos_ns, seen.latch_neg_ns) == stamps[2 * number - 2 : 2 * number]


def test_both_inputs_may_be_wired() -> None:
    found, _ = terminal(input_1="a", input_2="b")
    found.taken(registers(LEVEL | RISEN, FALLEN, 2**40 + 1, 2, 3, 2**63))
    first, second = found.image[1], found.image[2]
    assert (first.input, first.latch_pos_ns, first.latch_neg_ns) == (True, 2**40 + 1, 2)
    assert (second.input, second.latch_pos_ns, second.latch_neg_ns) == (False, 3, 2**63)
    signals: Any = {"a": "signal of a", "b": "signal of b"}
    assert inputs_of(TerminalTable(segment="ec1", input_1="a", input_2="b"), signals) == (
        "signal of a",
        "signal of b",
    )
    assert inputs_of(TerminalTable(segment="ec1", input_2="a"), signals) == (None, "signal of a")


@pytest.mark.parametrize("missing_cycles", [1, 3])
def test_its_state_is_bad_when_frames_stay_out_and_good_when_they_come(
    missing_cycles: int,
) -> None:
    """At 2 ms: as long as no more than so many cycles are without its inputs."""
    found, clock = terminal(input_1="probe", missing_cycles=missing_cycles)
    assert found.wc_state == 1  # nothing has come yet
    for begin_ns in (10 * MS, 50 * MS):
        clock.now_ns = begin_ns
        found.taken(registers(LEVEL, 0, 1, 2, 3, 4))
        found.exchange_until(begin_ns + MS)
        for after_ns, state in ((0, 0), ((missing_cycles + 1) * 2 * MS, 0), (1, 1)):
            clock.now_ns += after_ns
            assert found.wc_state == state
    assert found.image[1].input  # what came last stays


@pytest.mark.parametrize(("edge", "mode"), [("first", b"\3"), ("last", b"\0")])
def test_the_master_reads_its_registers_and_writes_which_edge_counts(
    edge: Any, mode: bytes
) -> None:
    """Bit 0 and 1 of LATCH0_CONTROL: single event; 34 bytes from 0x09AE on; second on the line."""
    settings = read_settings(*read_rig(RIG), [])
    table = TerminalTable(segment="ec1", input_1="probe", stamp_edge=edge)
    found = register_inputs(settings, "ec1", table)
    assert (found.first, found.size, found.node_id) == (0x09AE, 34, 2)
    assert [*found.writes] == [("LATCH0_CONTROL", mode), ("LATCH1_CONTROL", mode)]
    assert dict(found.identity) == {1: 0, 2: 401}


def slave_of(rig: str, *changes: str) -> tuple[Any, Any]:
    """The slave of the terminal of a shipped rig, with the clock that it runs on."""
    assigned = [(parse_assignment(change), as_written) for change in changes]
    settings = read_settings(*read_rig(RIG.parent / rig), assigned)
    clock, beside = new_scheduler(), SimpleNamespace(signals={"probe": None})
    made: Any = beside
    return terminal_slave(settings, "ec1", clock, made, lambda _: None, 7), clock


@pytest.mark.parametrize(("start_us", "drift_ppm"), [(0, 0.0), (25, -40.0), (-3, 100.0)])
def test_its_clock_is_that_of_its_slave_controller(start_us: int, drift_ppm: float) -> None:
    """Of the keys of the line the part of `terminal`; others belong to drives."""
    slave, _ = slave_of(
        "plc-timestamp-line.toml",
        f"bus:ec1.clock_start_us=terminal={start_us} Z=99",
        f"bus:ec1.drift_ppm=terminal={drift_ppm} Z=77",
    )
    local = slave.time.local
    assert local.at(0) == start_us * 1000
    assert local.at(S) == start_us * 1000 + S + round(drift_ppm * 1000)
    assert (slave.description.serial, slave.description.product) == (7, 401)


def test_it_falls_silent_when_its_rig_says_so_and_else_never() -> None:
    slave, clock = slave_of("plc-timestamp-line.toml", "plc:terminal.silent_from_ms=30")
    for time_ns, is_on in ((30 * MS - 1, True), (30 * MS, False), (S, False)):
        clock.run_until(time_ns)
        assert slave.is_on is is_on
    plain, clock = slave_of("plc-timestamp-line.toml")
    clock.run_until(S)
    assert plain.is_on
    assert slave_of("probe-z-ethercat.toml")[0] is None


def test_each_drive_of_a_line_has_its_own_clock_and_samples_when_it_does() -> None:
    """What the control assumes of that is no matter of the slave; on CAN the line says nothing."""
    keys = ("clock_start_us=X=4 Z=-2", "drift_ppm=Y=7.5", "sample_us=X=11 Z=-20",
            "assumed_sample_us=X=1 Y=2 Z=3")  # fmt: skip
    rig = read_rig(RIG.parent / "probe-xyz-ethercat.toml")
    assigned = [(parse_assignment(f"bus:ec1.{key}"), as_written) for key in keys]
    settings = read_settings(*rig, assigned)
    found = [drive_of_line(settings, axis, serial) for serial, axis in enumerate("XYZ", 5)]
    assert [(one.serial, one.start_ns, one.drift_ppm, one.sample_ns) for one in found] == [
        (5, 4000, 0.0, 11_000), (6, 0, 7.5, 0), (7, -2000, 0.0, -20_000)
    ]  # fmt: skip
    on_can = read_settings(*read_rig(RIG.parent / "probe-z.toml"), [])
    one = drive_of_line(on_can, "Z", 3)
    assert (one.serial, one.start_ns, one.drift_ppm, one.sample_ns) == (3, 0, 0.0, 0)
