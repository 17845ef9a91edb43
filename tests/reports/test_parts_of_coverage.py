"""Coverage on a page: which part is there, requirements in their order, tables of transitions."""

import csv
import re
from importlib import resources
from typing import Any

import pytest

from axisrig.bench.campaign.results.stored import RUNS, StoredRun
from axisrig.bench.record.axes import AxisRecord, DriveState
from axisrig.bench.record.distance import (
    ChannelDistanceRecord,
    Controller,
    DistanceChange,
    DistanceRecord,
)
from axisrig.bench.record.facts import AlarmRecord, Facts, RunFile, Timing
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.kernel.errors import catalogue
from axisrig.reports.coverage import section as coverage_section
from axisrig.reports.coverage.section import (
    ANY,
    Coverage,
    distance_transitions,
    drive_transitions,
)

CONTROLLER = Controller(0.2, 0.0, 0.0, "MOVING_AVERAGE", 1, 0.0, 1, 0.0, 0.0, False)
RAISED = [number for number, entry in catalogue().items() if entry.is_raised]
LATER = [number for number, entry in catalogue().items() if not entry.is_raised]


def run(verdict: str = "pass", requirement: str = "", **facts: Any) -> StoredRun:
    row = {"run": "r", "verdict": verdict, "alarms": "", "requirement": requirement}
    made = StoredRun(row, [], None, None)
    made.__dict__["recording"] = RunFile(1, Facts(Timing(1, 0, 0), 1, None, 1, "", **facts))
    return made


def row(verdict: str = "pass", **cells: str) -> StoredRun:
    """A run without a recording, or a row about several runs."""
    return StoredRun({"run": "r", "verdict": verdict, "alarms": "", **cells}, [], None, None)


def section(*runs: StoredRun) -> str:
    coverage = Coverage()
    for one in runs:
        coverage.add(one)
    return coverage.section()


def heads(text: str) -> list[str]:
    return re.findall(r"<h3>(.*?)(?:: \d+ of \d+)?</h3>", text)


def axis(*states: str) -> AxisRecord:
    return AxisRecord("c", 1, 1.0, states=tuple(DriveState(n, s) for n, s in enumerate(states)))


AXES: dict[str, Any] = {"axes": {"Z": axis("SWITCH_ON_DISABLED", "READY_TO_SWITCH_ON")}}
ALARM: dict[str, Any] = {"alarms": (AlarmRecord(1, RAISED[0], 4, True, ""),)}
DRIVES = "Transitions of the drives (DS402)"


@pytest.mark.parametrize(
    ("runs", "expected"),
    [
        ([], []),
        ([run()], []),
        ([run(runs=(MeasurementRun(("Z",)),))], []),  # nothing of it can lack
        ([run(requirement="R-1")], ["Requirements", "Alarm IDs"]),
        ([run(**ALARM)], ["Alarm IDs"]),
        ([run(**AXES)], ["Alarm IDs", DRIVES]),
        ([run(requirement="R-1", **ALARM, **AXES, runs=(MeasurementRun(("Z",)),))],
         ["Requirements", "Alarm IDs", DRIVES, "Steps of measurement runs"]),
        ([row(requirement="R-1")], ["Requirements", "Alarm IDs"]),
        ([row(alarms=str(RAISED[0]))], ["Alarm IDs"]),
    ],
)  # fmt: skip
def test_a_part_is_there_where_runs_have_something_of_it(
    runs: list[StoredRun], expected: list[str]
) -> None:
    text = section(*runs)
    assert heads(text) == expected
    assert ('<h2 id="coverage_title">Coverage</h2>' in text) is bool(expected)


def test_requirements_are_in_their_order_with_all_of_their_runs() -> None:
    """However often the same verdict came; a run may have several, in one cell."""
    runs = [run("pass", "R-3 R-1"), run("pass", "R-1"), run("pass", "R-2"), run("fail", "R-3"),
            run("pass", "R-1"), run("fail", " R-3 ")]  # fmt: skip
    text = section(*runs)
    cells = re.findall(
        r'<th scope="row">([^<]*)</th><td><span class="word v-(\w+)">.*?</td>'
        r'<td class="right">(\d+)</td>',
        text,
    )
    assert cells == [("R-1", "pass", "3"), ("R-2", "pass", "1"), ("R-3", "fail", "3")]


def test_a_requirement_is_text() -> None:
    text = section(run(requirement="<b>&"))
    assert "<b>" not in text
    assert '<th scope="row">&lt;b&gt;&amp;</th>' in text


def transitions(text: str) -> tuple[list[str], list[str]]:
    """Visited and not visited ones of the drives."""
    part = text.partition(f"<h3>{DRIVES}")[2].partition("<h3>")[0]
    lists = dict(re.findall(r"<summary>([a-z ]+): \d+</summary>(.*?)</details>", part))
    visited, left = (re.findall(r"<li>([^<]*)</li>", lists.get(name, ""))
                     for name in ("visited", "not visited"))  # fmt: skip
    return visited, left


def test_a_fault_may_come_in_any_state() -> None:
    """CiA 402-2, transition 13: it is in the table from whichever state a drive falls."""
    off, ready, enabled = "SWITCH_ON_DISABLED", "READY_TO_SWITCH_ON", "OPERATION_ENABLED"
    reaction, fault = "FAULT_REACTION_ACTIVE", "FAULT"
    _, left = transitions(section(run(axes={"X": axis(off, ready)})))
    assert f"* → {reaction}" in left
    axes = {"X": axis(off, reaction, fault), "Y": axis(off, reaction),
            "Z": axis(off, ready, enabled, reaction)}  # fmt: skip
    visited, left = transitions(section(run(axes=axes)))
    assert f"* → {reaction}: 3" in visited
    assert f"{reaction} → {fault}: 1" in visited
    assert f"* → {reaction}" not in left
    assert not any(reaction in each and "not in the table" in each for each in visited)
    assert f"{ready} → {enabled}: 1, not in the table" in visited
    # Every drive has left NOT_READY_TO_SWITCH_ON too: four of the table were visited
    assert len(left) + 4 == len(drive_transitions())


def test_a_row_about_several_runs_has_no_recording_that_lacks() -> None:
    """It counts for its requirement; its alarms are those of its runs."""
    about = row(requirement="R-1", alarms=str(RAISED[0]), **{RUNS: "2"})
    text = section(about, run(**AXES))
    assert "without a recording" not in text
    assert f"Alarm IDs: 0 of {len(RAISED)}" in text
    lone = section(about, row(alarms=str(RAISED[0])))
    assert "Runs without a recording: 1;" in lone
    assert f"Alarm IDs: 1 of {len(RAISED)}" in lone


def test_an_alarm_that_nothing_raises_is_in_no_list() -> None:
    """What is listed are the IDs that something raises, and each of them once."""
    text = section(row(alarms=f"{RAISED[0]} {LATER[0]}"))
    listed = [int(number) for number in re.findall(r"<li>(\d+) ", text)]
    assert sorted(listed) == sorted(RAISED)
    assert f"<summary>visited: 1</summary><ul class='plain'><li>{RAISED[0]} " in text
    assert f"<summary>not visited: {len(RAISED) - 1}</summary>" in text


def changed(*states: str) -> tuple[DistanceChange, ...]:
    return tuple(
        DistanceChange(n, state, "NC", "g", False, CONTROLLER) for n, state in enumerate(states)
    )


def control(*states: str) -> DistanceRecord:
    return DistanceRecord(changes=changed(*states))


def test_the_control_of_the_channel_counts_beside_those_of_axes() -> None:
    """3D distance control has the states of the same table."""
    of_channel = ChannelDistanceRecord(changes=changed("INACTIVE", "ACTIVE", "ACTIVE", "FREEZE"))
    alone = section(run(**AXES, distance_3d=of_channel))
    both = section(run(**AXES, distance={"Z": control("INACTIVE", "ACTIVE")},
                       distance_3d=of_channel))  # fmt: skip
    for text, count in ((alone, 1), (both, 2)):
        assert f"<h3>Transitions of distance control: 2 of {len(distance_transitions())}" in text
        assert f"<li>INACTIVE → ACTIVE: {count}</li>" in text
        assert "<li>ACTIVE → FREEZE: 1</li>" in text


def test_distance_control_that_stays_in_a_state_has_no_part() -> None:
    words = "Transitions of distance control"
    assert words not in heads(section(run(**AXES, distance={"Z": control("INACTIVE")})))
    assert words not in heads(section(run(**AXES, distance={"Z": control("ACTIVE", "ACTIVE")})))
    assert words in heads(section(run(**AXES, distance={"Z": control("INACTIVE", "ACTIVE")})))


def table(package: str, name: str) -> list[dict[str, str]]:
    text = resources.files(package).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def test_every_transition_goes_from_a_state_to_another_one() -> None:
    """A command that changes nothing, and one that is refused, has no transition."""
    rows = table("axisrig.kernel.distance", "states.csv")
    states = {row["state"] for row in rows}
    found = distance_transitions()
    assert all(one in states and other in states and one != other for one, other in found)
    assert len(found) == len(set(found))
    assert {row["state"] for row in rows if row["next"] not in ("", row["state"])} == {
        one for one, _ in found
    }


def test_transitions_of_drives_are_those_of_cia_402() -> None:
    """CiA 402-2, state machine: of each that can be gone through, both ends, and each once."""
    off, ready, on = "SWITCH_ON_DISABLED", "READY_TO_SWITCH_ON", "SWITCHED_ON"
    enabled, stop = "OPERATION_ENABLED", "QUICK_STOP_ACTIVE"
    reaction, fault = "FAULT_REACTION_ACTIVE", "FAULT"
    found = drive_transitions()
    assert len(found) == len(set(found))
    assert {
        ("NOT_READY_TO_SWITCH_ON", off), (off, ready), (ready, on), (on, enabled), (enabled, on),
        (on, ready), (ready, off), (enabled, ready), (enabled, off), (on, off), (enabled, stop),
        (stop, off), (reaction, fault), (fault, off),
    } <= set(found)  # fmt: skip
    assert all(one for one, _ in found)


def test_a_transition_of_the_table_counts_for_itself_and_another_one_for_any_state(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A table with A to FAULT by name, and FAULT from any other state."""
    known = [("A", "B"), ("A", "FAULT"), (ANY, "FAULT")]
    monkeypatch.setattr(coverage_section, "drive_transitions", lambda: known)
    coverage = Coverage()
    coverage.drives.update({("A", "FAULT"): 2, ("B", "FAULT"): 3, ("C", "FAULT"): 4, ("B", "A"): 1})
    text = coverage.section()
    assert f"<h3>{DRIVES}: 2 of 3</h3>" in text
    assert transitions(text) == (
        ["A → FAULT: 2", "* → FAULT: 7", "B → A: 1, not in the table"], ["A → B"],
    )  # fmt: skip
