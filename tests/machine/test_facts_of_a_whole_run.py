"""Facts of one short run on a real machine, and of a run that broke off."""

from pathlib import Path
from typing import NamedTuple

import pytest
from tests.machine.made_rigs import settings_of

from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.machine import Machine, SimulatedTimeoutError
from axisrig.bench.record.facts import Facts
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import MS, US

PROGRAM = """%whole
N10 #MSG SYN["a=%.1f b=%d", 1.5, 7]
#MSG SYN["without a number"]
N20 #DRIVE WR [AX=Z KEY=TORQUE_LIMIT VAL=40]
N30 G1 Z129.5 F600
N40 M0
N50 M30
"""
LOOP = "%loop\nN10 $WHILE 1\nN20 G4 0.001\nN30 $ENDWHILE\nN40 M30\n"
CHANGES = ("fault:drop=Z.TPDO2 at=motion count=2", "plc:V.E.A=0; 3 at=motion+1ms",
           "plc:start_ms=5", "set:Z.antr.nbr_delay_cycles=3")  # fmt: skip


def machine_of(
    folder: Path, *changes: str, text: str = PROGRAM, limit_ns: int | None = None
) -> Machine:
    program = folder / "whole.nc"
    program.write_text(text, encoding="utf-8")
    settings = settings_of("drive-functions.toml", *changes)
    return Machine(settings, read_program(program, ("Z",)), limit_ns=limit_ns)


class Run(NamedTuple):
    """A machine that has run and is closed, its facts, and those of two runs that broke off."""

    machine: Machine
    facts: Facts
    burst: Facts
    late: Facts


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    machine = machine_of(tmp_path_factory.mktemp("whole"), *CHANGES)
    try:
        took_ns = machine.run()
        burst, late = PlantError("z", 5 * MS, "it burst"), ValueError("it took too long")
        return Run(
            machine,
            facts_of(machine, took_ns),
            facts_of(machine, 123, broken_by=burst),
            facts_of(machine, broken_by=late),
        )
    finally:
        machine.close()


def test_times_of_a_run_are_in_their_order(run: Run) -> None:
    machine, facts = run.machine, run.facts
    assert (facts.timing.period_ns, facts.timing.offset_ns, facts.timing.buffer_cycles) == (
        MS, machine.settings.rig.cycle.cycle_offset_us * US, 0,
    )  # fmt: skip
    assert facts.sim_ns == machine.scheduler.now_ns
    assert facts.start_ns is not None
    assert 0 < facts.start_ns < facts.end_ns <= facts.sim_ns
    assert facts.end_ns % MS == 0  # the end of the period in which the program ended
    assert machine.channel.end_ns is not None
    assert 0 <= facts.end_ns - machine.channel.end_ns < MS
    assert facts.fine_ns == machine.plant.fine_ns
    assert (facts.is_stopped, facts.unfinished, facts.alarms, facts.real_time) == (
        False, "", (), None,
    )  # fmt: skip
    assert (run.burst.sim_ns, run.late.sim_ns) == (123, facts.sim_ns)


def test_what_was_printed_and_given_to_the_drive_is_there_with_its_place(
    run: Run,
) -> None:
    facts = run.facts
    assert [(one.block, one.values) for one in facts.messages] == [(10, (1.5, 7.0)), (None, ())]
    assert "a=1.5 b=7" in facts.messages[0].shown
    assert "without a number" in facts.messages[1].shown
    (written,) = facts.drive_writes
    assert (written.axis, written.words) == ("Z", "#DRIVE WR Z TORQUE_LIMIT = 40")
    assert facts.start_ns is not None
    assert facts.start_ns <= written.time_ns < facts.end_ns


def test_a_fault_and_the_plc_side_leave_what_they_did(run: Run) -> None:
    facts = run.facts
    (fault,) = facts.faults
    assert fault.axis == "Z"
    begin_ns = fault.marks[0][0]
    assert fault.words == f"fault drop Z.TPDO2: from {begin_ns / MS:g} ms, frames hit: 2"
    assert [words for _, words in fault.marks] == [
        "drop Z.TPDO2 begins", "drop Z.TPDO2: 2 frames hit, the last",
    ]  # fmt: skip
    words = [note.words for note in facts.plc]
    assert words == ["V.E.A = 3 from the PLC", "M0: stop", "M0: started again"]
    stop, again = facts.plc[1:]
    # 5 ms later, in the next cycle of the channel
    assert 5 * MS <= again.time_ns - stop.time_ns <= 6 * MS


def test_what_lists_have_set_is_left_of_each_axis_and_of_the_channel(
    run: Run,
) -> None:
    machine, facts = run.machine, run.facts
    assert [*facts.axes] == ["Z"]
    assert facts.axes["Z"].written["antr.nbr_delay_cycles"] == 3
    assert dict(facts.channel) == dict(machine.settings.channel.items())
    assert [*facts.plants] == ["z"] == [*machine.plant.axes]
    assert {*facts.probes} == {*machine.plant.probes}
    assert facts.blocks is not None
    blocks = facts.blocks.rows()
    assert blocks.end_ns.max() <= facts.end_ns
    numbers = [facts.blocks.lines[line].number for line in blocks.line]
    assert numbers == [10, None, 20, 30, 40, 50]


def test_after_a_failure_of_a_plant_no_fmu_is_asked(run: Run) -> None:
    assert (run.burst.plants, run.burst.unfinished) == (
        {}, "plant z at t = 5.000000 ms: it burst",
    )  # fmt: skip
    assert run.burst.axes == run.facts.axes
    assert (run.late.plants, run.late.unfinished) == (run.facts.plants, "it took too long")


@pytest.mark.long
@pytest.mark.parametrize(("limit_s", "text"), [("0.02", "0.02 s"), ("0.5", "0.5 s")])
def test_a_program_that_does_not_end_is_given_up(tmp_path: Path, limit_s: str, text: str) -> None:
    """The limit counts simulated time from 0 on; the loop is named."""
    machine = machine_of(tmp_path, f"plc:limit_s={limit_s}", text=LOOP)
    try:
        with pytest.raises(SimulatedTimeoutError) as caught:
            machine.run()
        now_ns = machine.scheduler.now_ns
    finally:
        machine.close()
    assert f"did not end within {text} of simulated time (plc:limit_s)" in str(caught.value)
    assert float(limit_s) * 1e9 <= now_ns < float(limit_s) * 1e9 + MS


@pytest.mark.parametrize(
    ("limit_s", "asked_ms", "limit_ms"),
    [("0.02", None, 20), ("0.02", 30, 30), ("0.5", 10.5, 10.5)],
)
def test_a_limit_that_is_asked_for_takes_the_place_of_that_of_the_settings(
    tmp_path: Path, limit_s: str, asked_ms: float | None, limit_ms: float
) -> None:
    """A longer one as well as a shorter one, and one that ends within a cycle."""
    asked_ns = None if asked_ms is None else round(asked_ms * MS)
    machine = machine_of(tmp_path, f"plc:limit_s={limit_s}", text=LOOP, limit_ns=asked_ns)
    try:
        with pytest.raises(SimulatedTimeoutError, match=f"within {limit_ms / 1e3:g} s of"):
            machine.run()
        now_ns = machine.scheduler.now_ns
    finally:
        machine.close()
    assert limit_ms * MS <= now_ns < (limit_ms + 1) * MS


def test_a_program_that_has_ended_may_go_on_past_the_limit(tmp_path: Path) -> None:
    """The limit is that of the program; after its end the run goes on as long as it has to."""
    changes = ("plc:limit_s=0.04", "plc:after_end_ms=30")
    machine = machine_of(tmp_path, *changes, text="%short\nN10 M30\n")
    try:
        took_ns = machine.run()
        ended_ns = machine.channel.end_ns
    finally:
        machine.close()
    assert ended_ns is not None
    assert ended_ns < 40 * MS < ended_ns + 30 * MS <= took_ns
