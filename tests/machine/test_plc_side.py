"""The PLC side on the machine: values for drives and variables, at their moments."""

import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.judge.program.findings import program_notes
from axisrig.bench.judge.topics import events
from axisrig.kernel.drives.canopen import mapping
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

RunNc = Callable[..., Any]
BASE = "drive-functions.toml"
READ = '#DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=V.P.T]\n#MSG SYN["limit=%d", V.P.T]\n'
"""The drive itself tells its 6072, in per cent: the function of the list divides by 10."""


def said(out: Any) -> list[str]:
    """What `axisrig nc` notes of the PLC side."""
    return [text for text, _ in program_notes(out.facts)]


def at_ns(out: Any, words: str) -> list[int]:
    """Instants of what passed between program and PLC side, by its words."""
    return [note.time_ns for note in out.facts.plc if note.words == words]


@pytest.mark.long
def test_a_function_brings_a_value_to_the_drive_and_waits_until_it_is_there(run_nc: RunNc) -> None:
    out = run_nc(
        f"{READ}N10 M50\n{READ}N20 G1 Z129 F600\nN30 M51\n{READ}",
        "",
        "plc:Z.torque_limit=300 at=M50; 5000 at=M51",
        base=BASE,
    )
    assert out.printed("limit") == [5000, 30, 500]
    period_ns = out.machine.timing.period_ns
    ((answer,), (sent,)) = (
        at_ns(out, "M50 to the PLC"),
        at_ns(out, "Z.torque_limit = 300 from the PLC"),
    )
    assert sent == answer + period_ns
    (taken,) = at_ns(out, "Z.torque_limit = 300: the drive has taken it")
    assert sent < taken < sent + 3 * MS
    labels = [event.label for event in events(out.observed)]
    assert "Z.torque_limit = 300: the drive has taken it" in labels


@pytest.mark.long
def test_a_motion_behind_the_function_begins_when_the_drive_has_its_value(run_nc: RunNc) -> None:
    """The answer comes 20 ms late; without it the path would move in the cycle of M50."""
    out = run_nc(
        "N10 G4 0.1\nN20 M50\nN30 G1 Z129 F600",
        "",
        "plc:Z.6072=300 at=M50",
        "fault:slow_sdo=Z by=20ms at=start",
        base=BASE,
    )
    (taken,) = at_ns(out, "Z.torque_limit = 300: the drive has taken it")
    (answer,) = at_ns(out, "M50 to the PLC")
    assert taken - answer > 20 * MS
    times, set_mm = out.column("time_ns"), out.column("Z.set_mm")
    begin_ns = int(times[(set_mm != set_mm[0]).argmax()])
    assert taken < begin_ns < taken + 3 * out.machine.timing.period_ns


def test_a_run_goes_on_until_the_drive_has_taken_a_value_of_its_end(run_nc: RunNc) -> None:
    """Nothing else is left to do when the program has ended; the answer comes 50 ms late."""
    out = run_nc(
        "N10 G4 0.01",
        "",
        "plc:Z.6072=300 at=program_end",
        "fault:slow_sdo=Z by=50ms at=start",
        base=BASE,
    )
    (taken,) = at_ns(out, "Z.torque_limit = 300: the drive has taken it")
    (end_ns,) = out.machine.channel.program_ends_ns
    assert taken - end_ns > 50 * MS
    assert out.facts.end_ns >= taken


def test_times_and_the_second_of_a_moment(run_nc: RunNc) -> None:
    out = run_nc(
        "N10 M50\nN20 M50\nN30 M50\nN40 G4 0.1",
        "",
        "plc:Z.torque_limit=300 at=M50+20ms nth=2; 400 at=30ms",
        base=BASE,
    )
    start_ns, answer = out.machine.channel.start_ns, at_ns(out, "M50 to the PLC")
    assert at_ns(out, "Z.torque_limit = 300 from the PLC") == [answer[1] + 20 * MS]
    assert at_ns(out, "Z.torque_limit = 400 from the PLC") == [start_ns + 30 * MS]
    (taken,) = at_ns(out, "Z.torque_limit = 300: the drive has taken it")
    assert answer[2] > taken  # M50 is acknowledged when the drive has its value


@pytest.mark.long
def test_a_limit_holds_for_a_measurement_run_and_is_restored_behind_it(run_nc: RunNc) -> None:
    out = run_nc(
        f"N10 G100 Z90 F600\n{READ}N20 G1 Z110 F6000\n{READ}",
        "",
        "plc:Z.torque_limit=400 at=run; 5000 at=run_end+50ms",
        base=BASE,
    )
    (record,) = out.machine.channel.records
    (limited,) = at_ns(out, "Z.torque_limit = 400 from the PLC")
    assert limited == record.begin_ns + out.machine.timing.period_ns
    assert at_ns(out, "Z.torque_limit = 5000 from the PLC") == [record.end_ns + 50 * MS]
    assert out.printed("limit") == [40, 500]


def test_a_handshake_by_variables(run_nc: RunNc) -> None:
    out = run_nc(
        f"V.E.LIMIT = 1\n#WAIT FOR V.E.READY == 1\n{READ}V.E.LIMIT = 0\nG4 0.1\n{READ}",
        "",
        "plc:V.E.LIMIT=0",
        "plc:V.E.READY=0; 1 at=V.E.LIMIT=1+10ms",
        "plc:Z.torque_limit=300 at=V.E.Limit=1; 5000 at=V.E.LIMIT=0",
        base=BASE,
    )
    assert out.alarms == []
    assert out.printed("limit") == [30, 500]
    (asked,) = at_ns(out, "V.E.LIMIT = 1 to the PLC")
    assert at_ns(out, "V.E.READY = 1 from the PLC") == [asked + 10 * MS]


@pytest.mark.long
@pytest.mark.provokes(900270, 4, axis="Z", value="300", object="0x6072:0")
def test_900270_when_the_drive_does_not_take_the_value(run_nc: RunNc) -> None:
    """Two attempts of 300 ms get no answer."""
    out = run_nc(
        "N10 G1 Z129 F60\nN20 G4 2",
        "",
        "plc:Z.torque_limit=300 at=motion+1ms",
        "fault:drop=Z.SDO at=motion",
        base=BASE,
    )
    assert out.alarms == [900270]
    (alarm,) = out.machine.channel.alarms
    assert "plc:Z.torque_limit" in str(alarm)


def test_an_object_that_an_rpdo_carries_is_refused(run_nc: RunNc, tmp_path: Path) -> None:
    own = tmp_path / "map.csv"
    table = Path(mapping.__file__).with_name("pdo_map.csv").read_text(encoding="utf-8")
    own.write_text(f"{table}RPDO2,1,0,0x6072,0,16,no,,torque limit\n", encoding="utf-8")
    with pytest.raises(UserError, match="RPDO of axis Z carries torque_limit"):
        run_nc("", f'[drive.servo]\npdo_map = "{own}"', "plc:Z.torque_limit=300", base=BASE)


def test_what_has_not_come_is_told(run_nc: RunNc) -> None:
    out = run_nc("N10 M50", "", "plc:Z.torque_limit=300 at=M50; 400 at=M77", base=BASE)
    assert said(out)[-1] == "plc:Z.torque_limit: 400 at=M77 has not come"
    assert not [line for line in said(out) if re.search("300.*not come", line)]


@pytest.mark.long
@pytest.mark.parametrize("key", ["override", "Z.override"])
def test_an_override_that_is_led_begins_where_it_is(run_nc: RunNc, key: str) -> None:
    """20 % to 100 % within 200 ms, then down to 50 % within 100 ms: half way 60 % and 75 %."""
    out = run_nc(
        "N10 G1 Z120 F1200",
        "",
        f"plc:{key}=20; 100 at=motion+200ms over=200ms; 50 at=motion+500ms over=100ms",
        base="probe-z.toml",
    )
    set_mm = out.column("Z.set_mm")
    speed = [abs(b - a) * 1e3 for a, b in pairwise(set_mm.tolist())]
    begin = next(row for row, value in enumerate(speed) if value > 0.0)
    found = [speed[begin + ms] / 20.0 for ms in (150, 300, 450, 550, 700)]
    assert found == pytest.approx([0.2, 0.6, 1.0, 0.75, 0.5], abs=0.03)
