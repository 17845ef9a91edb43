"""What coverage counts of a run, and its lists: visited, not visited, not in the table."""

import re
from typing import Any

import pytest

from axisrig.bench.campaign.results.stored import IN_PLAN, StoredRun
from axisrig.bench.record.axes import AxisRecord, DriveState
from axisrig.bench.record.distance import Controller, DistanceChange, DistanceRecord
from axisrig.bench.record.facts import AlarmRecord, Facts, RunFile, Timing
from axisrig.bench.record.measuring import FixedStop, MeasurementRun
from axisrig.kernel.errors import catalogue
from axisrig.reports.coverage.section import Coverage, distance_transitions, drive_transitions

CONTROLLER = Controller(0.2, 0.0, 0.0, "MOVING_AVERAGE", 1, 0.0, 1, 0.0, 0.0, False)


def run(is_recorded: bool = True, alarms: str = "", **facts: Any) -> StoredRun:
    row = {"run": "r", "verdict": "pass", "alarms": alarms, "requirement": "R"}
    made = StoredRun(row, [], None, None)
    whole = Facts(Timing(1, 0, 0), 1, None, 1, "", **facts)
    made.__dict__["recording"] = RunFile(1, whole if is_recorded else None)
    return made


def covered(*runs: StoredRun) -> str:
    coverage = Coverage()
    for one in runs:
        coverage.add(one)
    return coverage.section()


def lists(text: str, title: str) -> tuple[str, list[str], list[str]]:
    """Heading of a part with its lists of visited and not visited."""
    part = re.search(rf"<h3>({re.escape(title)}[^<]*)</h3>(.*?)(?=<h3>|</section>|<p )", text)
    assert part is not None
    head, body = part.groups()
    found = {
        name: re.findall(r"<li>([^<]*)</li>", items)
        for name, items in re.findall(r"<summary>([a-z ]+): \d+</summary>(.*?)</details>", body)
    }
    return head, found.get("visited", []), found.get("not visited", [])


def drive(*states: str) -> AxisRecord:
    return AxisRecord("c", 1, 1.0, states=tuple(DriveState(n, s) for n, s in enumerate(states)))


def control(*states: str) -> DistanceRecord:
    return DistanceRecord(
        changes=tuple(
            DistanceChange(n, state, "NC", "g", False, CONTROLLER) for n, state in enumerate(states)
        )
    )


RAISED = {number: entry.text for number, entry in catalogue().items() if entry.is_raised}
FIRST, SECOND = list(RAISED)[:2]


def test_alarms_are_counted_by_runs_with_or_without_a_recording() -> None:
    """A run counts an ID once; one without a recording by the column of `cases.csv`."""
    alarm = AlarmRecord(1, FIRST, 4, True, "")
    text = covered(
        run(),
        recorded(alarm, alarm),
        run(is_recorded=False, alarms=f"{FIRST} {FIRST} {SECOND} none"),
        run(is_recorded=False),
    )
    head, visited, left = lists(text, "Alarm IDs")
    assert head == f"Alarm IDs: 2 of {len(RAISED)}"
    assert [each.split(" ")[0] for each in visited] == [str(FIRST), str(SECOND)]
    assert [each.rpartition(": ")[2] for each in visited] == ["2 runs", "1 runs"]
    assert len(left) == len(RAISED) - 2
    assert "Runs without a recording: 2; of them only alarms count." in text
    assert "no recording" not in covered(recorded(alarm))


def recorded(*alarms: AlarmRecord) -> StoredRun:
    made = run()
    facts = Facts(Timing(1, 0, 0), 1, None, 1, "", alarms=alarms)
    made.__dict__["recording"] = RunFile(1, facts)
    return made


@pytest.mark.parametrize(
    ("one", "visited"),
    [
        (MeasurementRun(("Z",)), ["begun: 1"]),
        (MeasurementRun(("Z",), start_ns=0), ["begun: 1", "moving: 1"]),
        (MeasurementRun(("Z",), start_ns=1, signal_ns=2),
         ["begun: 1", "moving: 1", "signal seen: 1"]),
        (MeasurementRun(("Z",), start_ns=1, signal_ns=2, end_ns=3,
                        fixed_stop=FixedStop({}, detected_ns=2)),
         ["begun: 1", "moving: 1", "signal seen: 1", "ended: 1", "fixed stop found: 1"]),
        (MeasurementRun(("Z",), end_ns=3, fixed_stop=FixedStop({})), ["begun: 1", "ended: 1"]),
    ],
)  # fmt: skip
def test_steps_of_a_measurement_run(one: MeasurementRun, visited: list[str]) -> None:
    head, found, left = lists(covered(run(runs=(one,))), "Steps of measurement runs")
    assert head == f"Steps of measurement runs: {len(visited)} of 5"
    assert found == visited
    steps = ("begun", "moving", "signal seen", "ended", "fixed stop found")
    assert left == [step for step in steps if f"{step}: 1" not in visited]


def test_steps_are_counted_over_runs_and_measurement_runs() -> None:
    begun = MeasurementRun(("Z",))
    moving = MeasurementRun(("Z",), start_ns=1)
    _, found, _ = lists(covered(run(runs=(begun, moving)), run(runs=(moving,))), "Steps of measur")
    assert found == ["begun: 3", "moving: 2"]


def test_a_drive_has_been_through_its_first_two_states_before_the_recording() -> None:
    """CiA 402: transition 1 is automatic; it is not gone through twice where the first is known."""
    arrow = "NOT_READY_TO_SWITCH_ON → SWITCH_ON_DISABLED: 1"
    first = covered(run(axes={"Z": drive("SWITCH_ON_DISABLED", "READY_TO_SWITCH_ON")}))
    _, visited, _ = lists(first, "Transitions of the drives")
    assert visited == [arrow, "SWITCH_ON_DISABLED → READY_TO_SWITCH_ON: 1"]
    later = covered(run(axes={"Z": drive("READY_TO_SWITCH_ON", "SWITCHED_ON")}))
    _, visited, _ = lists(later, "Transitions of the drives")
    assert visited[:2] == [arrow, "SWITCH_ON_DISABLED → READY_TO_SWITCH_ON: 1"]
    assert "READY_TO_SWITCH_ON → SWITCHED_ON: 1" in visited
    whole = covered(run(axes={"Z": drive("NOT_READY_TO_SWITCH_ON", "SWITCH_ON_DISABLED")}))
    _, visited, _ = lists(whole, "Transitions of the drives")
    assert visited == [arrow]
    silent = covered(run(axes={"Z": drive()}))
    assert "Transitions of the drives" not in silent


def test_transitions_are_counted_by_axes_and_those_of_no_table_are_named() -> None:
    states = ("SWITCH_ON_DISABLED", "OPERATION_ENABLED")
    text = covered(run(axes={"Z": drive(*states), "X": drive(*states)}))
    head, visited, left = lists(text, "Transitions of the drives")
    known = drive_transitions()
    assert head == f"Transitions of the drives (DS402): 1 of {len(known)}"
    assert visited[0].endswith("SWITCH_ON_DISABLED: 2")
    assert visited[1] == "SWITCH_ON_DISABLED → OPERATION_ENABLED: 2, not in the table"
    assert len(left) == len(known) - 1
    assert visited[0].rpartition(":")[0] not in left


def test_transitions_of_distance_control_are_of_its_changes() -> None:
    """A change of parameters in the same state is none."""
    changes = control("INACTIVE", "ACTIVE", "ACTIVE", "FREEZE")
    axes = {"Z": drive("SWITCH_ON_DISABLED")}
    text = covered(run(axes=axes, distance={"Z": changes, "X": changes}))
    head, visited, _ = lists(text, "Transitions of distance control")
    assert head == f"Transitions of distance control: 2 of {len(distance_transitions())}"
    assert set(visited) == {"INACTIVE → ACTIVE: 2", "ACTIVE → FREEZE: 2"}


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0), (1, 0, 2)])
def test_a_requirement_has_its_worst_verdict_wherever_that_came(order: tuple[int, ...]) -> None:
    words = ("pass", "fail", "marginal")
    coverage = Coverage()
    for place in order:
        row = {"run": "r", "verdict": words[place], "alarms": "", "requirement": "R"}
        made = StoredRun(row, [], None, None)
        made.__dict__["recording"] = RunFile(1, None)
        coverage.add(made)
    text = coverage.section()
    assert re.findall(r"</span> (\w+)</span></td><td class=\"right\">(\d+)</td>", text) == [
        ("fail", "3")
    ]


def test_a_run_that_the_plan_has_no_more_counts_for_nothing() -> None:
    """Neither for requirements nor for alarms; beside it one that the plan has."""
    old, now = run(alarms=str(FIRST), is_recorded=False), run(is_recorded=False)
    old.case[IN_PLAN] = "no"
    coverage = Coverage()
    for one in (old, now):
        coverage.add(one)
    assert (dict(coverage.alarms), coverage.without_recording) == ({}, 1)
    assert {name: len(found) for name, found in coverage.requirements.items()} == {"R": 1}
