"""Where a measured value is proved by SDO, where it is not, and that nobody can overlook that.

The latch at 30.000 mm is 3145728 increments, 0x300000; with bit 5 of its second byte turned in
every telegram it reads 30.078125 mm.
"""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.reports.pages import whole

from axisrig.bench.campaign.campaign import Choice, run_campaign
from axisrig.bench.campaign.checking import check_file
from axisrig.bench.campaign.runner import no_stopwatch
from axisrig.bench.campaign.single_program import run_program
from axisrig.bench.judge.topics import observe
from axisrig.bench.machine.facts import unproved_notes
from axisrig.bench.plan.checks import judge, parse_check
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.rig.canopen.latches import SdoRoom, describe_latches, sdo_room
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, read_settings
from axisrig.reports.build import build_report

RunNc = Callable[..., Any]
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
SURFACE = "plant:probe.surface_mm=30"
ALTERED = "fault:alter=Z.TPDO2 byte=2 xor=0x20"
SHARED = '[axis.X]\nsegment = "can1"\n[axis.Z]\nsegment = "can1"\n'
FULL = SHARED + "[drive.servo]\nmissing_cycles = 1\n"  # no patience for telegrams that SDO delays
PROGRAM = 'N10 G0 G90 Z40\nN20 G100 Z20 F600\nN30 #MSG SYN["Z=%f", V.A.MESS.Z]'
TRUE_MM, WRONG_MM = 30.0, 30.078125


def judged(outcome: Any, metric: str, condition: str) -> Any:
    check = parse_check(metric, condition, "test")
    seen = observe(outcome.observed, check)
    return judge(check, seen.value, seen.uncertainty, seen.note)


@pytest.mark.long
def test_a_shared_segment_is_proved_at_standstill(run_nc: RunNc) -> None:
    outcome = run_nc(PROGRAM, SHARED, SURFACE)
    assert sdo_room(outcome.machine.settings, "Z") is SdoRoom.STANDSTILL
    assert (outcome.alarms, outcome.printed("Z")) == ([], [TRUE_MM])
    assert unproved_notes(outcome.machine.links) == []
    found = judged(outcome, "latch_mm:Z", "30 +- 0.001")
    assert (found.verdict, found.uncertainty) == (Verdict.PASS, 0.0)


@pytest.mark.provokes(900083, 4, axis="Z")
@pytest.mark.parametrize("rig", [SHARED, pytest.param("", marks=pytest.mark.long)])
@pytest.mark.long
def test_a_latch_that_is_altered_alike_in_every_telegram_is_not_published(
    run_nc: RunNc, rig: str
) -> None:
    outcome = run_nc(PROGRAM, rig, SURFACE, ALTERED)
    assert (outcome.alarms, outcome.printed("Z")) == ([900083], [])


@pytest.mark.long
def test_where_nothing_proves_it_everything_says_so(run_nc: RunNc) -> None:
    """The uncertainty is where a latch would have been believed: it holds the truth."""
    outcome = run_nc(PROGRAM, FULL, SURFACE, ALTERED)
    assert outcome.alarms == []
    assert outcome.printed("Z") == [WRONG_MM]
    (note,) = unproved_notes(outcome.machine.links)
    assert note.startswith("axis Z: unproved latches: 1; no SDO has confirmed them")
    found = judged(outcome, "latch_mm:Z", "30.078125 +- 0.001")
    assert found.verdict is Verdict.INCONCLUSIVE
    assert "latch of axis Z unproved" in found.note
    assert WRONG_MM - TRUE_MM <= found.uncertainty < 1.0
    error = judged(outcome, "latch_error_um:Z", "0 +- 1")
    assert error.verdict is Verdict.INCONCLUSIVE
    assert "latch of axis Z unproved" in error.note
    printed = judged(outcome, "msg:N30", "== 30.078125")
    assert printed.note == "the program has measured with unproved latches of Z"


@pytest.mark.long
def test_an_axis_that_moves_beside_takes_the_proof_and_that_is_told(run_nc: RunNc) -> None:
    """X and Y share a segment; X moves on while Z measures on it, and while it does not."""
    beside = "N05 X[INDP_ASYN G90 G01 POS=200 FEED=600 ]\n"
    moving = run_nc(beside + PROGRAM, SHARED, SURFACE)
    (note,) = unproved_notes(moving.machine.links)
    assert note.startswith("axis Z: unproved latches: 1;")
    assert moving.printed("Z") == [TRUE_MM]


def settings_of(folder: Path, rig: str) -> Settings:
    path = folder / "rig.toml"
    path.write_text(f'base = "{(RIGS / "probe-xyz.toml").as_posix()}"\n{rig}\n', encoding="utf-8")
    return read_settings(*read_rig(path), [])


@pytest.mark.parametrize(
    ("rig", "words"),
    [
        ("", "axis Z: SDO proves its latches; room for that in every cycle"),
        (
            SHARED,
            "axis Z: SDO proves its latches; room for that while no axis of the segment moves",
        ),
        (FULL, "warning: axis Z: its latches are unproved: segment can1 has no room for SDO"),
        (
            "[drive.servo]\nlatch_check = false",
            "warning: axis Z: its latches are unproved: latch_check of drive servo is false",
        ),
    ],
)
def test_check_says_how_latches_are_proved(tmp_path: Path, rig: str, words: str) -> None:
    lines = describe_latches(settings_of(tmp_path, rig))
    assert [line for line in lines if line.startswith(words)]
    assert words in check_file(tmp_path / "rig.toml")


@pytest.mark.parametrize("rig", sorted(path.name for path in RIGS.glob("*.toml")))
def test_no_shipped_rig_measures_without_a_proof(rig: str) -> None:
    answer = describe_latches(read_settings(*read_rig(RIGS / rig), []))
    assert [line for line in answer if line.startswith("warning")] == []


@pytest.mark.long
def test_results_report_and_command_line_name_the_axes(tmp_path: Path) -> None:
    settings_of(tmp_path, FULL)
    (tmp_path / "z.nc").write_text(f"%z\n{PROGRAM}\nN99 M30\n")
    plan = tmp_path / "unproved.csv"
    plan.write_text(
        "case,program,rig,plant:probe.surface_mm,check:latch_mm:Z\n"
        "touch,z.nc,rig.toml,30,30 +- 0.0001\n"
    )
    campaign = run_campaign(
        [plan], out=tmp_path / "out", select=Choice(), jobs=1, timeout_s=None, assignments=[],
        command=["axisrig"], started="", stopwatch=no_stopwatch,
    )  # fmt: skip
    with (tmp_path / "out" / "cases.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["unproved_latches"], row["verdict"]) == ("Z", "inconclusive")
    assert campaign.exit_code == 3
    page = whole(build_report(tmp_path / "out"))
    assert "<dt>unproved latches</dt><dd>Z " in page
    answer = run_program(
        tmp_path / "z.nc", tmp_path / "rig.toml", [SURFACE], [], lambda _text: None
    )
    assert [note.text for note in answer if note.text.startswith("axis Z: unproved latches: 1")]
