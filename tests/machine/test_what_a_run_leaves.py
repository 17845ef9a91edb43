"""What a machine leaves of its run, each field from its own source: with stand-ins for its parts.

Values that differ everywhere: one that comes from a neighbour shows.
"""

import math
from dataclasses import fields
from itertools import count
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.drive.axis.drive import NO_TICK
from axisrig.bench.machine import facts
from axisrig.bench.machine.recording import recorder
from axisrig.bench.machine.recording.lag import largest_lag
from axisrig.bench.machine.recording.limit_log import LimitLog
from axisrig.bench.machine.recording.recorder import RecordedAxis, Recorder
from axisrig.bench.record.measuring import Criteria, FixedStop, MeasurementRun
from axisrig.bench.record.series import SeriesWriter
from axisrig.bench.rig.reading.plc_sensors import PlcSensorTable
from axisrig.bench.rig.reading.plc_task import PlcTaskTable
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcAction, PlcEvent
from axisrig.kernel.time.clock import MS, US

# Facts


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
    of_run |= {name: {"Z": next(number)} for name in ("inputs", "sources", "latched_mm")}
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
        (7, "M50 to the PLC", here),
        (9, "M0: started again", here),
        (10, "M1: stop", here),
    ]


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


def test_an_unproved_latch_is_a_note_of_its_axis() -> None:
    links: Any = {name: SimpleNamespace(unproved_latches=n) for name, n in (("X", 0), ("Z", 2))}
    (note,) = facts.unproved_notes(links)
    assert note.startswith("axis Z: unproved latches: 2; no SDO has confirmed them, and ")


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


# Series


MOTION = {
    "X": [0.001, 0.002, 0.003, 0.004, 0.005, 6.0, 7.0, 0.008],
    "C": [0.011, 0.012, 0.013, 0.014, 0.015, 16.0, 17.0, 200.0],
}
"""Position, velocity, motor, its velocity, demand, force, force and face of the stop; m, N."""


class Plant:
    """An axis of the plant with the roles that it fills; moves by 1 mm/s."""

    def __init__(self, name: str, roles: str) -> None:
        self._start = MOTION[name]
        self.roles: Any = SimpleNamespace(has=roles.split().__contains__)
        self.asked: list[tuple[int, int]] = []

    def motion_at(self, time_ns: int) -> list[float]:
        moved = time_ns / MS * 1e-6
        return [value + moved * (place in (0, 2, 4)) for place, value in enumerate(self._start)]

    def stop_force_peak_n(self, since_ns: int, time_ns: int) -> float:
        self.asked.append((since_ns, time_ns))
        return 100.0 + time_ns / MS


class Cycle:
    """A channel in one of its cycles; links have other values than the plant."""

    def __init__(self, number: int) -> None:
        self.sync_ns = number * MS
        self.links = [
            SimpleNamespace(set_mm=10.0 * k + number, actual_mm=20.0 * k + number,
                            lag_mm=30.0 * k + number)
            for k in (1, 2, 3)
        ]  # fmt: skip
        self.distance = SimpleNamespace(axes={}, channel=None)


def written(rows: int, block_rows: int, late_ns: int, patch: pytest.MonkeyPatch) -> Any:
    """X with a stop, C that turns, and Z outside; C gets its SYNC later."""
    patch.setattr(recorder, "BLOCK_ROWS", block_rows)
    plants = {"X": Plant("X", "force stop_force stop_face"), "C": Plant("C", "stop_force stop_fac")}
    servos: Any = {
        name: SimpleNamespace(tick_ns=250 * US, sync_ns=0, lag_peak_m=NO_TICK) for name in plants
    }
    axes = [
        RecordedAxis("X", plants["X"], servos["X"]),  # type: ignore[arg-type]
        RecordedAxis("Z", None, None),
        RecordedAxis("C", plants["C"], servos["C"], is_rotary=True, torque_arm_m=0.5),  # type: ignore[arg-type]
    ]
    signal = SimpleNamespace(level=False)
    whole: Any = SimpleNamespace(distances={}, now_ns=0)
    made = Recorder(whole, axes, {"p": SimpleNamespace(signal=signal)}, (), SeriesWriter(None),  # type: ignore[dict-item]
                    segments=2 if late_ns else 1)  # fmt: skip
    for number in range(1, rows + 1):
        servos["X"].sync_ns = number * MS
        servos["C"].sync_ns = number * MS + late_ns
        whole.now_ns = number * MS + late_ns + 1
        signal.level = number % 2 == 0
        made(Cycle(number))  # type: ignore[arg-type]
    return made.table(), plants


@pytest.mark.interpreted
def test_a_row_has_what_belongs_together(monkeypatch: pytest.MonkeyPatch) -> None:
    table, plants = written(3, 100, 0, monkeypatch)
    at = np.array([1.0, 2.0, 3.0])
    columns = {name: table[name].to_numpy() for name in table.column_names}
    assert columns["time_ns"].tolist() == [MS, 2 * MS, 3 * MS]
    found = {name: values for name, values in columns.items() if name != "time_ns"}
    expected = {
        "X.set_mm": 10 + at, "X.actual_mm": 20 + at, "X.cnc_lag_mm": 30 + at,
        "Z.set_mm": 20 + at, "Z.actual_mm": 40 + at, "Z.cnc_lag_mm": 60 + at,
        "C.set_deg": 30 + at, "C.actual_deg": 60 + at, "C.cnc_lag_deg": 90 + at,
        "X.truth_mm": 1 + 1e-3 * at, "X.velocity_mm_s": 2 + 0 * at, "X.drive_lag_mm": 2 + 0 * at,
        "X.force_n": 6 + 0 * at, "X.stop_force_n": 7 + 0 * at, "X.stop_force_peak_n": 100 + at,
        "X.stop_mm": 8 + 0 * at,
        "C.truth_deg": 11 + 1e-3 * at, "C.velocity_deg_s": 12 + 0 * at,
        "C.drive_lag_deg": 2 + 0 * at, "C.stop_torque_nm": 8.5 + 0 * at,
        "C.stop_torque_peak_nm": 50 + at / 2,
        "p.signal": np.array([0, 1, 0]),
    }  # fmt: skip
    for name in ("X.drive_lag_peak_mm", "C.drive_lag_peak_deg"):
        assert np.all(found.pop(name) >= 2.0 - 1e-9)
    assert set(found) == set(expected)
    for name, values in expected.items():
        assert found[name] == pytest.approx(values), name
    # The largest force since the row before
    assert plants["X"].asked == [(MS, MS), (MS, 2 * MS), (2 * MS, 3 * MS)]


@pytest.mark.interpreted
def test_blocks_of_any_size_give_the_same_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    for late_ns in (0, 300 * US):
        whole, _ = written(7, 100, late_ns, monkeypatch)
        for block_rows in (1, 2, 3, 7):
            parts, _ = written(7, block_rows, late_ns, monkeypatch)
            assert parts.column_names == whole.column_names
            for name in whole.column_names:
                assert parts[name].to_numpy().tolist() == whole[name].to_numpy().tolist(), name


@pytest.mark.interpreted
def test_truth_is_of_the_first_sync_and_what_a_drive_has_sampled_of_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Demand and motor of C 0.3 ms later; both move by 1 mm/s."""
    table, _ = written(2, 100, 300 * US, monkeypatch)
    at = np.array([1.0, 2.0])
    columns = {name: table[name].to_numpy() for name in table.column_names}
    assert columns["time_ns"].tolist() == [MS, 2 * MS]
    assert columns["C.truth_deg"] == pytest.approx(11 + 1e-3 * at)
    assert columns["C.drive_lag_deg"] == pytest.approx(2.0 + 0 * at)
    late = {name: values for name, values in columns.items() if "after" in name}
    assert sorted(values.tolist() for values in late.values()) == [[0, 0], [300 * US] * 2]


@pytest.mark.interpreted
def test_a_stop_that_is_out_of_reach_when_the_program_begins_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    face = MOTION["X"][7]
    for face_m, has_stop in ((99.9, True), (-99.9, True), (100.0, False), (1e6, False)):
        monkeypatch.setitem(MOTION, "X", [*MOTION["X"][:7], face_m])
        table, _ = written(2, 1, 0, monkeypatch)
        assert ("X.stop_mm" in table.column_names) is has_stop
        assert ("X.stop_force_n" in table.column_names) is has_stop
        assert "X.force_n" in table.column_names
    assert face == 0.008


@pytest.mark.interpreted
def test_a_torque_limit_is_noted_when_it_changes() -> None:
    drive: Any = SimpleNamespace(torque_limits=None)
    log = LimitLog({"Z": drive})
    limits = [None, (1000, 500, 400), (1000, 500, 400), (1000, 500, 300), (1000, 500, 400)]
    for number, now in enumerate(limits):
        drive.torque_limits = now
        log(SimpleNamespace(sync_ns=number * MS))  # type: ignore[arg-type]
    found = [(one.since_ns // MS, one.most, one.negative, one.positive) for one in log.of("Z")]
    assert found == [(1, 1000, 500, 400), (3, 1000, 500, 300), (4, 1000, 500, 400)]
    assert log.of("X") == ()


def test_the_lag_is_looked_at_at_the_ticks_between_two_rows() -> None:
    """The demand jumps back: x = u (1 - u) has its top of 1/4 half way, at a tick or beside it."""
    times = np.array([0, MS], dtype=np.int64)
    demand, motor = np.zeros(2), np.zeros(2)
    velocity = np.array([1.0, -1.0]) / 1e-3  # of the cubic u (1 - u), which is a parabola
    for tick_ns, top in ((500 * US, 0.25), (250 * US, 0.25), (400 * US, 0.24), (MS, 0.0)):
        found = largest_lag(times, (demand, motor, velocity), tick_ns)
        assert found.tolist() == pytest.approx([0.0, top])
