"""A SERCOS drive in a machine: what is refused at the start, warnings, idents of programs."""

import dataclasses
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from axisrig.bench.drive.sercos import node as virtual
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import Phase

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z-sercos.toml"
SHORT = "%short\nN10 G01 G90 Z129.9 F3000\nN20 M30\n"

Run = Callable[..., Machine]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Run a program with the shipped rig.

    changes: of its keys. prepare: the virtual drive. before: called with the machine.
    """

    def make(
        program: str,
        *changes: str,
        prepare: Callable[[virtual.SercosDrive], None] | None = None,
        before: Callable[[Machine], None] | None = None,
    ) -> Machine:
        (tmp_path / "own.nc").write_text(program, encoding="utf-8")
        assigned = [(parse_assignment(text), as_written) for text in changes]
        settings = read_settings(*read_rig(RIG), assigned)
        check_rig(settings)
        machine = Machine(settings, read_program(tmp_path / "own.nc", ("Z",)))
        try:
            part: Any = machine.installed[0]
            if prepare is not None:
                prepare(part.nodes["Z"])
            if before is not None:
                before(machine)
            machine.run()
        finally:
            machine.close()
        return machine

    return make


def ids(machine: Machine) -> list[int]:
    return [alarm.id for alarm in machine.channel.alarms]


def test_the_plc_side_writes_no_object_of_a_drive_that_has_none(run: Run) -> None:
    with pytest.raises(UserError, match=r"plc:Z\.lag_window: the drive of axis Z has no objects"):
        run(SHORT, "plc:Z.lag_window=100000 at=M50")


@pytest.mark.provokes(900743, 7, axis="Z")
def test_900743_for_an_ident_that_the_drive_does_not_take(run: Run) -> None:
    assert ids(run(SHORT, "drive:servo.idents=S-0-0169=4")) == [900743]


@pytest.mark.provokes(900744, 7, axis="Z", ident="S-0-0303", found="nothing")
def test_900744_for_real_time_bits_of_the_other_set(run: Run) -> None:
    assert ids(run(SHORT, "set:Z.kenngr.echtzeit_bit_nr=2")) == [900744]


@pytest.mark.provokes(900745, 7, axis="Z", found="10000", expected="104857.6")
@pytest.mark.long
def test_900745_for_a_drive_that_counts_otherwise(run: Run) -> None:
    """2^20 per turn of 10 mm by the rig, 100 000 in the drive: a factor of 10.5 and no value."""

    def other(drive: virtual.SercosDrive) -> None:
        drive.idents._profile = dataclasses.replace(drive.sercos, resolution=100_000)

    assert ids(run(SHORT, prepare=other)) == [900745]


@pytest.mark.provokes(900746, 7, axis="Z")
def test_900746_where_nobody_begins_the_probing_cycle(run: Run) -> None:
    program = "%probe\nN10 G100 G90 Z80 F600\nN20 M30\n"
    assert ids(run(program, "drive:servo.probing=none")) == [900746]


@pytest.mark.provokes(900747, 7, axis="Z")
@pytest.mark.long
def test_900747_for_homing_by_the_drive(run: Run) -> None:
    assert ids(run("%home\nN10 G74 Z1\nN20 M30\n")) == [900747]


@pytest.mark.provokes(140038, 1, axis="Z", ident="S-0-0132")
@pytest.mark.long
def test_140038_for_an_ident_that_the_drive_has_not(run: Run) -> None:
    """S-0-0132 is of the second probe, which this drive does not have; its slave refuses SAFEOP."""
    found = ids(run(SHORT, "drive:servo.at=S-0-0051 S-0-0130 S-0-0132"))
    assert found == [140038, 900705]


@pytest.mark.provokes(140040, 1, axis="Z", ident="S-0-0001")
@pytest.mark.provokes(140041, 1, axis="Z", phase=4)
def test_140040_and_140041_for_cycles_that_differ(run: Run) -> None:
    def other(drive: virtual.SercosDrive) -> None:
        def check() -> int:
            drive.idents.put(virtual.BUS_CYCLE, 2000)
            return drive._check_phase_4()

        drive.commands._run[virtual.CHECK_4] = check  # type: ignore[index]

    assert ids(run(SHORT, prepare=other)) == [140040, 140040, 140041, 900705]


@pytest.mark.provokes(140029, 1, axis="Z", state="INIT")
@pytest.mark.long
def test_140029_beside_the_alarm_of_a_slave_in_init(run: Run) -> None:
    falls = "fault:slave_falls=Z state=INIT code=UNSPECIFIED at=motion"
    assert ids(run(SHORT, falls)) == [140029, 900732]


IDENTS = """%idents
N10 #IDENT RD [AX=Z ID=S-0-0092 P=P10 TYP=2 DEC=0 SERC]
N20 #IDENT WR SYN [AX=Z ID=S-0-0092 VAL=100 TYP=2 DEC=0 SERC]
N30 #IDENT RD [AX=Z ID=S-0-0092 P=P11 TYP=2 DEC=0 SERC]
N40 #IDENT RD [AX=Z ID=S-0-0051 P=P12 TYP=4 DEC=0 SERC]
N50 #MSG SYN["%d %d %d", P10, P11, P12]
N60 M30
"""


def test_a_program_reads_and_writes_idents_of_the_drive(run: Run) -> None:
    """130 mm are 13 631 488 increments of 2^20 per 10 mm."""
    machine = run(IDENTS)
    assert ids(machine) == []
    (message,) = machine.messages
    first, second, position = map(int, message.shown.split())
    assert second == 100
    assert first > second
    assert position == pytest.approx(13_631_488, abs=1)


@pytest.mark.long(but=1)
@pytest.mark.parametrize(
    ("command", "alarm"),
    [
        ("WR SYN [AX=Z ID=S-0-0132 VAL=1 TYP=4 DEC=0 SERC]", 900032),  # the drive has not got it
        ("WR SYN [AX=Z ID=S-0-0051 VAL=1 TYP=4 DEC=0 SERC]", 900032),  # read only
        ("WR SYN [AX=Z ID=S-0-0092 VAL=1 TYP=4 DEC=0 SERC]", 900256),  # two bytes
        ("WR SYN [AX=Z ID=S-0-0092 VAL=70000 TYP=2 DEC=0 SERC]", 900112),
    ],
)
def test_an_ident_that_cannot_be_written_is_an_alarm(run: Run, command: str, alarm: int) -> None:
    assert ids(run(f"%wrong\nN10 #IDENT {command}\nN20 M30\n")) == [alarm]


@pytest.mark.long
def test_measuring_type_6_runs_with_a_sercos_axis(run: Run) -> None:
    program = "%six\nN20 G310 G90 Z129 F600 $GOTO [HIT]\nN25 M30\n[HIT]\nN30 M30\n"
    assert ids(run(program, "set:channel.messtyp=6")) == []


def altered(machine: Machine) -> None:
    """Let each AT have the axis 10 mm from where it stands, at 2^20 increments for 10 mm."""
    data = cast("Any", machine.links["Z"])._data
    take = data.take

    def wrong() -> list[int | None]:
        values = list(take())
        values[1] = None if values[1] is None else values[1] + (1 << 20)
        return values

    data.take = wrong


def moved_mm(machine: Machine) -> float:
    return float(np.ptp(machine.recorder.table().column("Z.truth_mm").to_numpy()))


@pytest.mark.interpreted
@pytest.mark.long
def test_an_axis_is_not_led_from_a_place_that_its_telegrams_alone_report(run: Run) -> None:
    """The service channel reads S-0-0051 too; without it the axis jumps, which the test sees."""
    still = "%still\nN10 G4 Z0.02\nN20 M30\n"
    proved = run(still, before=altered)
    assert ids(proved) == [900084]
    assert "the service channel (S-0-0051)" in str(proved.channel.alarms[0])
    assert moved_mm(proved) < 0.01
    assert moved_mm(run(still, "drive:servo.position_check=false", before=altered)) > 0.01


COMMANDS = """%commands
N10 #COMMAND WR SYN [AX=Z ID=S-0-0099 SERC]
N20 #IDENT RD [AX=Z ID=S-0-0135 P=P10 TYP=2 DEC=0 SERC]
N30 #COMMAND WAIT SYN [AX=Z ID=S-0-0099 SERC]
N40 #IDENT RD [AX=Z ID=S-0-0135 P=P11 TYP=2 DEC=0 SERC]
N50 #COMMAND WR [AXNR=3 ID=S-0-0099 SERC]
N60 #COMMAND WAIT SYN [SERC]
N70 #IDENT RD [AX=Z ID=S-0-0135 P=P12 TYP=2 DEC=0 SERC]
N80 #MSG SYN["%d %d %d", P10, P11, P12]
N90 M30
"""
CHANGED = 1 << 5


def test_a_program_runs_a_command_of_the_drive_and_waits_for_its_end(run: Run) -> None:
    """The change bit of S-0-0135 comes with the end of the command, and goes with the waiting."""
    machine = run(COMMANDS)
    assert ids(machine) == []
    (message,) = machine.messages
    assert [bool(int(word) & CHANGED) for word in message.shown.split()] == [True, False, False]


@pytest.mark.long
def test_a_program_waits_as_long_as_a_command_runs(run: Run) -> None:
    """S-0-0099 lets the servo acknowledge its error; here it takes 50 ms to end."""

    def slow(drive: virtual.SercosDrive) -> None:
        def begin() -> int:
            end = partial(drive.commands.end, virtual.RESET, virtual.DONE)
            drive._clock.call_at(drive._clock.now_ns + 50_000_000, Phase.APPLICATION, end)
            return virtual.RUNNING

        drive.commands._run[virtual.RESET] = begin  # type: ignore[index]

    waits = "N15 #COMMAND WAIT SYN [AX=Z ID=S-0-0099 SERC]\n"
    start = "%slow\nN10 #COMMAND WR SYN [AX=Z ID=S-0-0099 SERC]\n"
    after = 'N20 #MSG SYN["after"]\nN30 M30\n'
    late = run(start + waits + after, prepare=slow)
    soon = run(start + after, prepare=slow)
    assert 40e6 < late.end_ns - soon.end_ns < 60e6


@pytest.mark.provokes(900748, 4, axis="Z", key="S-0-0099", state="0xF")
def test_900748_for_a_command_that_ends_with_an_error(run: Run) -> None:
    def fails(drive: virtual.SercosDrive) -> None:
        drive.commands._run[virtual.RESET] = lambda: virtual.FAILED  # type: ignore[index]

    program = COMMANDS.replace("N20", "; N20")
    assert ids(run(program, prepare=fails)) == [900748]


@pytest.mark.provokes(900749, 2, axis="Z", key="S-0-0092")
def test_900749_for_an_ident_that_is_no_command(run: Run) -> None:
    assert ids(run("%no\nN10 #COMMAND WR SYN [AX=Z ID=S-0-0092 SERC]\nN20 M30\n")) == [900749]


@pytest.mark.long(but=1)
@pytest.mark.parametrize("ident", ["S-0-0128", "S-0-0999"])
def test_a_command_that_the_drive_does_not_take_is_an_alarm(run: Run, ident: str) -> None:
    """S-0-0128 in phase 4 (0x7005); one that it does not have (0x1001)."""
    assert ids(run(f"%no\nN10 #COMMAND WR SYN [AX=Z ID={ident} SERC]\nN20 M30\n")) == [900032]
