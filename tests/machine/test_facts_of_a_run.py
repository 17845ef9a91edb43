"""Facts of a run, each field from its own source: runs, kinematics, alarms, PLC, probes, notes.

Values that differ everywhere: one that comes from a neighbour shows.
"""

import math
from dataclasses import fields
from itertools import count
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine import facts
from axisrig.bench.record.measuring import Criteria, FixedStop, MeasurementRun
from axisrig.bench.rig.reading.plc_sensors import PlcSensorTable
from axisrig.bench.rig.reading.plc_task import PlcTaskTable
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcAction, PlcEvent
from axisrig.kernel.time.clock import MS, US


def test_a_measurement_run_keeps_every_field_of_its_own() -> None:
    number = count(1)
    of_stop: dict[str, Any] = {one.name: next(number) for one in fields(FixedStop)}
    one = SimpleNamespace(lag_limit_mm=0.5, window_mm=0.25, min_time_ns=7)
    of_stop |= {name: {"Z": next(number)} for name in ("beyond_ns", "window_ns", "set_mm",
                                                       "actual_mm")}  # fmt: skip
    of_stop |= {"criteria": {"Z": one}, "axes": ["Z", "Y"], "detected_by": "Y"}
    of_run: dict[str, Any] = {one.name: next(number) for one in fields(MeasurementRun)}
    of_run |= {"axes": ("Z",), "block": "N30", "goes_on": True,
               "fixed_stop": SimpleNamespace(**of_stop)}  # fmt: skip
    of_run |= {name: {"Z": next(number)} for name in ("inputs", "sources", "latched_mm",
                                                      "doubt_mm")}  # fmt: skip
    machine: Any = SimpleNamespace(measuring_targets={"N30": {"Z": 5.0}, "N40": {"Z": 6.0}})
    found = facts._run(machine, SimpleNamespace(**of_run))  # type: ignore[arg-type]
    assert found.target_mm == {"Z": 5.0}
    for field in fields(MeasurementRun):
        if field.name not in ("target_mm", "fixed_stop"):
            assert getattr(found, field.name) == of_run[field.name], field.name
    assert found.fixed_stop is not None
    for field in fields(FixedStop):
        value = getattr(found.fixed_stop, field.name)
        if field.name == "criteria":
            assert value == {"Z": Criteria(0.5, 0.25, 7)}
        else:
            own = of_stop[field.name]
            assert value == (tuple(own) if isinstance(own, list) else own), field.name
    other = facts._run(machine, SimpleNamespace(**{**of_run, "block": "N50", "fixed_stop": None}))  # type: ignore[arg-type]
    assert (other.target_mm, other.fixed_stop) == (None, None)


def test_a_kinematic_is_on_until_the_next_choice() -> None:
    def chosen(tool_mm: float) -> Any:
        return SimpleNamespace(
            axes=("X", "Y"), ids=(9, 98), tool_mm=tool_mm, written={(1, 98, 2): 6e5}
        )

    choices = [(5, chosen(80.0)), (8, None), (11, chosen(90.0)), (13, chosen(95.0))]
    path = SimpleNamespace(transformation=SimpleNamespace(choices=choices))
    machine: Any = SimpleNamespace(channel=SimpleNamespace(path=path))
    found = list(facts._kinematics(machine))
    spans = [(one.begin_ns, one.end_ns, one.tool_mm) for one in found]
    assert spans == [(5, 8, 80.0), (11, 13, 90.0), (13, None, 95.0)]
    assert found[0].program == (((1, 98, 2), 6e5),)
    assert (found[0].axes, found[0].ids) == (("X", "Y"), (9, 98))
    path.transformation.choices = []
    assert list(facts._kinematics(machine)) == []


def test_what_passed_the_plc_is_in_its_order_until_the_end() -> None:
    block: Any = SimpleNamespace(place="part.nc:5")
    stop, optional = (canon.ProgramStop(block, optional=is_it) for is_it in (False, True))
    events = [
        PlcEvent(5, stop),
        PlcEvent(9, stop, starts_again=True),  # noted with its stop
        PlcEvent(7, canon.ExternalWrite(block, "FEED", 0.1 + 0.2)),
        PlcEvent(7, canon.ExternalWrite(block, "COUNT", 123456789.125)),
        PlcEvent(7, canon.TechnologyFunction(block, "M", 50)),
        PlcEvent(10, optional),
        PlcEvent(11, PlcAction("feedhold", "p.csv:2:4")),
        PlcEvent(6, PlcAction("an override of 50 %", "p.csv:2:3")),
    ]
    found = [(note.time_ns, note.words, note.place) for note in facts._plc_notes(events, 10)]
    here = "part.nc:5"
    assert found == [
        (5, "M0: stop", here),
        (6, "an override of 50 %", "p.csv:2:3"),
        (7, "V.E.FEED = 0.3 to the PLC", here),
        (7, "V.E.COUNT = 123456789.125 to the PLC", here),
        (7, "M50 to the PLC", here),
        (9, "M0: started again", here),
        (10, "M1: stop", here),
    ]


@pytest.mark.parametrize(
    ("more", "word"),
    [({}, "#DRIVE WR"), ({"length_bytes": 4}, "#IDENT WR"), ({"is_command": True}, "#COMMAND WR")],
)
def test_a_value_that_a_drive_gets_is_shown_with_all_its_digits(
    more: dict[str, Any], word: str
) -> None:
    """32 bits have ten digits."""
    block: Any = SimpleNamespace(place="part.nc:5")
    write = canon.DriveWrite(block, "Y", "S-0-0092", 2147483647.0, waits=True, **more)
    found = facts._drive_write(7, write)
    assert (found.time_ns, found.axis) == (7, "Y")
    assert found.words == f"{word} Y S-0-0092 = 2147483647"


def test_alarms_are_those_that_came_up_and_then_the_further_ones() -> None:
    first, second = (Alarm(50059, place=place, axis="Z") for place in ("a.nc:1", None))
    channel = SimpleNamespace(
        alarm_ns=[3], alarms=[first], reactions=SimpleNamespace(further_ns=[4], further=[second])
    )
    machine: Any = SimpleNamespace(channel=channel)
    found = list(facts._alarms(machine))
    assert [(one.time_ns, one.place, one.is_further) for one in found] == [
        (3, "a.nc:1", False), (4, "", True),
    ]  # fmt: skip
    assert {(one.id, one.reaction_class, one.values["axis"]) for one in found} == {(50059, 4, "Z")}
    assert found[0].text == str(first)
    assert found[0].ends_program


@pytest.mark.parametrize(("value", "text"), [(0, "0"), (0.0, "0.0"), (-1.5, "-1.5"), ("", "")])
def test_a_value_of_an_alarm_stays_whatever_it_is(value: object, text: str) -> None:
    alarm = Alarm(50059, axis=value)
    channel = SimpleNamespace(
        alarm_ns=[3], alarms=[alarm], reactions=SimpleNamespace(further_ns=[], further=[])
    )
    (found,) = facts._alarms(SimpleNamespace(channel=channel))  # type: ignore[arg-type]
    assert found.values == {"axis": text}


def test_an_unproved_latch_is_a_note_of_its_axis() -> None:
    links: Any = {
        name: SimpleNamespace(unproved_latches=n, interpolated_latches=at_plc, doubt_mm=0.02)
        for name, n, at_plc in (("X", 0, 0), ("Y", 0, 1), ("Z", 2, 0))
    }
    of_drive, at_plc = facts.unproved_notes(links)
    assert of_drive.startswith("axis Z: unproved latches: 2; no SDO has confirmed them, and ")
    assert at_plc.startswith("axis Y: unproved positions at the signal of the PLC: 1; ")
    assert at_plc.endswith(" the last one by 0.02 mm")


@pytest.mark.parametrize(
    ("doubt_mm", "words"),
    [(None, "0 mm"), (0.0, "0 mm"), (0.012345, "0.012345 mm"), (1.25, "1.25 mm"),
     (1234.56, "1234.56 mm")],
)  # fmt: skip
def test_what_the_last_position_may_be_off_by_is_said_to_six_digits(
    doubt_mm: float | None, words: str
) -> None:
    """Also of an axis whose drive left latches unproved, behind the notes of all drives."""
    one = SimpleNamespace(unproved_latches=1, interpolated_latches=3, doubt_mm=doubt_mm)
    links: Any = {"X": one, "Y": one}
    notes = facts.unproved_notes(links)
    assert [note[:25] for note in notes] == [
        f"axis {name}: unproved {what}" for what in ("latches:", "position") for name in "XY"
    ]
    assert [note.rpartition(" by ")[2] for note in notes[2:]] == [words] * 2


TASK: dict[str, Any] = {
    "period_us": 4000, "offset_us": 100, "busy_us": 50, "program": "p.py",
    "clock_offset_ns": 11, "clock_drift_ppm": 1.5, "assumed_offset_ns": 12,
    "assumed_drift_ppm": 2.5,
}  # fmt: skip
TERMINAL = {"cycle_us": 1000, "offset_us": 300, "input_1": "a", "input_2": "b", "filter_us": 0.5,
            "stamp_resolution_ns": 10, "stamp_jitter_ns": 20, "stamp_edge": "last"}  # fmt: skip


def test_a_plc_task_keeps_its_own_numbers_and_those_of_its_terminal(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def left(terminal: Any) -> Any:
        table = PlcTaskTable.model_validate({**TASK, "terminal": terminal})
        rig = SimpleNamespace(plc_task=table)
        machine: Any = SimpleNamespace(
            settings=SimpleNamespace(rig=rig), plc_task=SimpleNamespace(left_out=3)
        )
        return facts._plc_task(machine)

    monkeypatch.setattr(facts, "rig_families", list)
    found = left(TERMINAL)
    assert (found.period_ns, found.offset_ns, found.busy_ns) == (4 * MS, 100 * US, 50 * US)
    assert (found.terminal_ns, found.terminal_offset_ns, found.filter_ns) == (MS, 300 * US, 500)
    assert (found.stamp_resolution_ns, found.stamp_jitter_ns, found.keeps_last_stamp) == (
        10, 20, True,
    )  # fmt: skip
    assert (found.clock_offset_ns, found.clock_drift_ppm) == (11, 1.5)
    assert (found.assumed_offset_ns, found.assumed_drift_ppm) == (12, 2.5)
    assert (found.left_out, found.probes, found.terminal_late_ns) == (3, ("a", "b"), 0)
    plain = left(None)  # the image is that of the task
    assert (plain.terminal_ns, plain.terminal_offset_ns, plain.probes) == (4 * MS, 100 * US, ())
    assert not plain.keeps_last_stamp
    grid = facts.TerminalGrid(7, 8, 9)
    families = [SimpleNamespace(terminal_grid=lambda _, each=each: each) for each in (None, grid)]
    monkeypatch.setattr(facts, "rig_families", lambda: families)
    on_segment = left(TERMINAL)
    assert (
        on_segment.terminal_ns, on_segment.terminal_offset_ns, on_segment.terminal_late_ns,
    ) == (7, 8, 9)  # fmt: skip


@pytest.mark.parametrize(
    ("values", "normalise", "normal", "is_along", "is_normalised"),
    [
        ({}, "none", None, False, False),
        ({"workpiece_tilt_x": 0.3}, "along", None, False, True),
        ({"workpiece_tilt_x": 0.3, "workpiece_tilt_y": 0.2}, "none",
         (math.sin(0.2), -math.sin(0.3) * math.cos(0.2), math.cos(0.3) * math.cos(0.2)), True,
         False),
        ({"workpiece_tilt_x": 0.0, "workpiece_tilt_y": 0.0, "quantity": 1}, "along",
         (0.0, 0.0, 1.0), False, True),
        ({"workpiece_tilt_x": 0.0, "workpiece_tilt_y": 0.0, "quantity": 2}, "electrode",
         (0.0, 0.0, 1.0), True, True),
    ],
)  # fmt: skip
def test_a_sensor_knows_the_normal_of_its_workpiece(
    values: dict[str, float], normalise: Any, normal: Any, is_along: bool, is_normalised: bool
) -> None:
    """A plane tilted about Y, then about X: Rx(x) Ry(y) e_z."""
    slave = SimpleNamespace(has=values.__contains__, get=values.__getitem__)
    table = PlcSensorTable(sensor="gap", sign=-1, delay_cycles=2, normalise=normalise)
    found = facts._plc_sensor(table, {"gap": SimpleNamespace(slave=slave)})  # type: ignore[dict-item]
    assert (found.sensor, found.sign, found.delay_cycles) == ("gap", -1, 2)
    assert (found.is_along, found.is_normalised) == (is_along, is_normalised)
    assert found.normal == (None if normal is None else pytest.approx(normal))
    assert facts._plc_sensor(table, {}).normal is None


@pytest.mark.interpreted
def test_a_probe_leaves_its_edges_contacts_and_what_its_wire_has_passed() -> None:
    def probe(has_contact: bool, uncertainty_ns: float, *edges: tuple[int, bool]) -> Any:
        contact = SimpleNamespace(time_ns=4, position_mm={"z": 1.5})
        return SimpleNamespace(
            roles=SimpleNamespace(has_group=lambda group: has_contact and group == "contact"),
            edge_uncertainty_ns=uncertainty_ns, contacts=[contact] * has_contact,
            signal=SimpleNamespace(edges=edges),
        )  # fmt: skip

    deflection = SimpleNamespace(mm=0.25, doubt_mm=0.125, beyond_ns=9)
    further = SimpleNamespace(mm=0.5, doubt_mm=0.0, beyond_ns=None)
    machine: Any = SimpleNamespace(
        plant=SimpleNamespace(
            probes={"p": probe(True, 1.0, (3, True), (5, False)), "s": probe(False, 250.0)}
        ),
        beside=SimpleNamespace(wires={"p": SimpleNamespace(edges=[(7, True)])}),
        deflections=SimpleNamespace(
            of=lambda name: [(deflection, f"words of {name}"), (further, "")]
        ),
    )
    found: Any = facts._probes(machine)
    p, s = found["p"], found["s"]
    assert [(e.time_ns, e.level) for e in p.edges] == [(3, True), (5, False)]
    assert [(e.time_ns, e.level) for e in p.passed] == [(7, True)]
    assert [(c.time_ns, c.position_mm) for c in p.contacts] == [(4, {"z": 1.5})]
    bent, second = p.deflections
    assert (second.mm, second.doubt_mm, second.beyond_ns, second.words) == (0.5, 0.0, None, "")
    assert (bent.mm, bent.doubt_mm, bent.beyond_ns) == (0.25, 0.125, 9)
    assert bent.words == "words of p"
    assert (p.has_contacts, p.edge_uncertainty_ns) == (True, 1.0)
    assert (s.has_contacts, s.edge_uncertainty_ns, s.edges, s.passed, s.deflections) == (
        False, 250.0, (), None, (),
    )  # fmt: skip


@pytest.mark.interpreted
def test_notes_have_their_topics_in_the_order_of_the_log(monkeypatch: pytest.MonkeyPatch) -> None:
    sources = {"distance_warnings": "warning", "unproved_notes": "latch", "lacking_notes": "lack",
               "plant_warnings": "of plant", "printed_log": "printed"}  # fmt: skip
    for name, text in sources.items():
        monkeypatch.setattr(facts, name, lambda _, text=text: [text])
    monkeypatch.setattr(facts, "_acting_warnings", lambda *_: ["acting"])
    machine: Any = SimpleNamespace(
        settings=SimpleNamespace(notes=["one", "two"]), distance_log=None, links=None, plant=None,
        plc_side=SimpleNamespace(not_come=lambda: ["not come"]),
    )  # fmt: skip
    assert [(note.source, note.text) for note in facts._notes(machine)] == [
        ("rig", "one"), ("rig", "two"), ("distance", "warning"), ("distance", "acting"),
        ("latch", "latch"), ("lacking", "lack"), ("plant", "of plant"), ("printed", "printed"),
        ("plc", "not come"),
    ]  # fmt: skip
