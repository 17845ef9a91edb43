"""What the judge finds of a tool: every kinematic, each of its limits, the right sensor."""

from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import MS, facts, kept
from tests.reports.tilted import CONTROLLER

from axisrig.bench.judge.kinematics.findings import tool_findings
from axisrig.bench.judge.kinematics.tool_findings import ToolFindings
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.distance import (
    ChannelDistanceRecord,
    Diagnosis,
    DistanceChange,
    PlcSensor,
)
from axisrig.bench.record.kinematics import GuideChange, KinematicRecord

ROWS = 40
AXES = ("Z", "C", "X", "A")
LIMITS = {"HD2": 50.0, "HD3": 70.0, "HD4": 85.0}
EXTENSION = "kin_step[1].trafo[2]."


def kinematic(
    begin_ms: int = 5, end_ms: int | None = 30, ids: tuple[int, ...] = (9, 98), **more: Any
) -> KinematicRecord:
    end_ns = None if end_ms is None else end_ms * MS
    return KinematicRecord(begin_ms * MS, end_ns, AXES, ids, 80.0, **more)


def extension(**degrees: float) -> dict[str, int | float | str]:
    """Entries of a list for kinematic 98: HD2 is param[1], in 0.0001 degrees."""
    numbers = {f"param[{int(name[2:]) - 1}]": value * 1e4 for name, value in degrees.items()}
    return {f"{EXTENSION}{name}": value for name, value in {"id": 98, **numbers}.items()}


def found(
    *on: KinematicRecord, rows: int = ROWS, outputs: tuple[str, ...] = (), **of_facts: Any
) -> ToolFindings:
    """Findings of a run of `rows` ms; outputs: columns of plants."""
    axes = {name: AxisRecord("can1", 1, 1e4, is_rotary=name in "CA") for name in AXES}
    columns = dict.fromkeys(outputs, np.zeros(rows))
    table = pa.table({"time_ns": np.arange(rows, dtype=np.int64) * MS, **columns})
    own = {"axes": axes, "channel": extension(**LIMITS), **of_facts}
    (tool,) = tool_findings(Observed(facts(kinematics=on, **own), kept(table)))
    return tool


def control(
    changes: dict[int, str], guides: tuple[GuideChange, ...] = (), dumps: tuple[int, ...] = ()
) -> ChannelDistanceRecord:
    """Changes: state by the ms at which it begins. dumps: instants of diagnosis data, ms."""
    made = [DistanceChange(t * MS, s, "NC", "", False, CONTROLLER) for t, s in changes.items()]
    diagnosis = tuple(Diagnosis(t * MS, {"kp": str(t)}) for t in dumps)
    return ChannelDistanceRecord("V.E.B", False, tuple(made), diagnosis, guides)


# Kinematics


def test_every_time_with_a_kinematic_is_found_in_its_order() -> None:
    times = [kinematic(2, 8), kinematic(12, 20, (57,)), kinematic(25, 30)]
    for many in (1, 2, 3):
        tool = found(*times[:many])
        assert [stretch.record for stretch in tool.kinematics] == times[:many]
        assert [stretch.end_ns // MS for stretch in tool.kinematics] == [8, 20, 30][:many]


@pytest.mark.parametrize("rows", [1, 20, ROWS])
def test_a_kinematic_that_was_never_off_ends_behind_the_last_row(rows: int) -> None:
    """So that the last row is in it: rows before the end belong to a stretch."""
    (stretch,) = found(kinematic(0, None), rows=rows).kinematics
    assert stretch.end_ns == (rows - 1) * MS + 1
    (early,) = found(kinematic(0, 3), rows=rows).kinematics
    assert early.end_ns == 3 * MS


def test_a_run_without_a_row_has_a_kinematic_without_length() -> None:
    (stretch,) = found(kinematic(5, None), rows=0).kinematics
    assert stretch.end_ns == stretch.record.begin_ns == 5 * MS


def test_axes_are_those_of_the_rig_in_its_order_with_those_that_turn() -> None:
    tool = found(kinematic())
    assert list(zip(tool.axes, tool.rotary, strict=True)) == [
        ("Z", False), ("C", True), ("X", False), ("A", True),
    ]  # fmt: skip


def test_of_the_list_only_entries_of_kinematics_are_kept() -> None:
    made = {"kin_step[0].trafo[0].id": 9, "trafo[1].id": 57, "kinematik[9].param[0]": 5}
    others = {"kinematic_count": 1, "sensor.kp": 2, "a.trafo[0].id": 3, "tool_trafo[0]": 4}
    assert found(kinematic(), channel={**others, **made}).written == made


# Limits of the extension


def test_limits_are_those_of_the_second_kinematic_if_it_extends_the_tool() -> None:
    """98 is found by its ID or by its type, and only in the second step."""
    assert found(kinematic()).kinematics[0].limits == LIMITS
    assert found(kinematic(ids=(98,))).kinematics[0].limits == {}
    named = {**extension(**LIMITS), f"{EXTENSION}id": 5, f"{EXTENSION}type": 98}
    for second, limits in ((5, LIMITS), (9, {})):
        (stretch,) = found(kinematic(ids=(9, second)), channel=named).kinematics
        assert stretch.limits == limits
    first = {name.replace("[1]", "[0]", 1): value for name, value in extension(HD2=50.0).items()}
    (stretch,) = found(kinematic(), channel=first).kinematics
    assert stretch.limits == {"HD2": 0.0}, "the first step has parameters of its own"


@pytest.mark.parametrize(
    ("written", "acting"),
    [
        ((50.0, 70.0, 85.0), {"HD2": 50.0, "HD3": 70.0, "HD4": 85.0}),
        ((0.0, 70.0, 85.0), {"HD2": 0.0, "HD3": 70.0, "HD4": 85.0}),  # from the beginning
        ((50.0, 0.0, 85.0), {"HD2": 50.0, "HD4": 85.0}),  # up to HD4
        ((0.0, 0.0, 85.0), {"HD2": 0.0, "HD4": 85.0}),
        ((89.9, 0.0, 89.95), {"HD2": 89.9, "HD4": 89.95}),
        ((90.0, 0.0, 85.0), {"HD4": 85.0}),  # never extended: HD3 is not used
        ((90.0, 70.0, 85.0), {"HD4": 85.0}),
        ((120.0, 95.0, 100.0), {"HD4": 100.0}),
    ],
)
def test_limits_are_those_that_act(
    written: tuple[float, float, float], acting: dict[str, float]
) -> None:
    """[0; -] and [90; -] of FCT-M3 12.9, as docs/ambiguities.md reads them."""
    by_list = dict(zip(LIMITS, written, strict=True))
    assert found(kinematic(), channel=extension(**by_list)).kinematics[0].limits == acting


def test_each_time_has_the_limits_that_the_program_had_written_by_then() -> None:
    programs = [(), (((1, 98, 1), 45e4),), (((1, 98, 1), 45e4), ((1, 98, 2), 60e4))]
    on = [kinematic(5 * n, 5 * n + 3, program=program) for n, program in enumerate(programs)]
    assert [stretch.limits for stretch in found(*on).kinematics] == [
        LIMITS, {**LIMITS, "HD2": 45.0}, {**LIMITS, "HD2": 45.0, "HD3": 60.0},
    ]  # fmt: skip


# The sensor


B_AND_A = ("b.tcp_x_mm", "b.tcp_y_mm", "a.tcp_x_mm", "c.clamping_x_mm", "c.distance_true_mm")


@pytest.mark.parametrize(
    ("of_variable", "sensor"),
    [
        ({"V.E.A": "b", "V.E.B": "a"}, "a"),  # the variable of the control
        ({"V.E.B": "b", "V.E.A": "a"}, "b"),
        ({"V.E.A": "a"}, "b"),  # the control has another one: the first that sees a tool
        ({"V.E.B": "c"}, "b"),  # its plant does not see the tool
        ({}, "b"),
    ],
)
def test_the_sensor_is_that_of_the_control_if_it_sees_the_tool(
    of_variable: dict[str, str], sensor: str
) -> None:
    sensors = {name: PlcSensor(plant, 1, 0) for name, plant in of_variable.items()}
    of = {"outputs": B_AND_A, "plc_sensors": sensors}
    assert found(kinematic(), distance_3d=control({0: "INACTIVE"}), **of).sensor == sensor
    assert found(kinematic(), **of).sensor == "b", "without a control any that sees it"


def test_without_a_plant_that_sees_the_tool_there_is_no_sensor() -> None:
    of = {"outputs": B_AND_A[3:], "plc_sensors": {"V.E.B": PlcSensor("c", 1, 0)}}
    assert found(kinematic(), distance_3d=control({0: "INACTIVE"}), **of).sensor is None
    assert found(kinematic()).sensor is None


# Where the offset acted


def used(changes: dict[int, str], *guides_ms: int) -> list[bool]:
    """Whether the control was on in the time of each guide."""
    guides = tuple(GuideChange(at * MS, "ECS", normal=(0.0, 0.6, 0.8)) for at in guides_ms)
    tool = found(kinematic(), distance_3d=control(changes, guides))
    assert [guide.change for guide in tool.guides] == list(guides)
    return [guide.is_used for guide in tool.guides]


OFF, ON, DIST = "INACTIVE", "ACTIVE", "ACTIVE_CONST_DIST"


@pytest.mark.parametrize(
    ("changes", "guides_ms", "expected"),
    [
        ({0: OFF, 10: ON, 20: OFF}, (0, 10, 20), [False, True, False]),
        ({0: OFF, 10: ON, 20: OFF}, (0, 11, 19), [True, True, True]),
        ({0: OFF, 10: ON, 20: OFF}, (5,), [True]),  # it holds to the end
        ({0: OFF, 10: ON, 20: OFF}, (5, 9), [False, True]),
        ({0: OFF, 10: ON, 20: OFF}, (20,), [False]),
        ({0: OFF, 10: ON, 20: OFF, 30: DIST}, (0, 20, 25), [True, False, True]),
        ({0: OFF, 10: ON, 20: OFF, 30: DIST}, (12, 14, 25, 31), [True, True, True, True]),
        ({0: OFF, 10: DIST}, (0, 35), [True, True]),  # on to the end
        ({0: OFF}, (0, 10), [False, False]),
        ({0: OFF, 10: ON, 12: "FREEZE", 20: OFF}, (13, 20), [True, False]),
        ({0: OFF, 10: ON, 12: "TURNING_OFF", 20: OFF}, (13, 20), [True, False]),
        ({}, (0, 10), [False, False]),
        ({0: OFF, 10: ON}, (), []),
    ],
)
def test_a_guide_is_used_where_the_control_was_not_off_in_its_time(
    changes: dict[int, str], guides_ms: tuple[int, ...], expected: list[bool]
) -> None:
    assert used(changes, *guides_ms) == expected


def test_all_diagnosis_data_are_kept_and_none_without_a_control() -> None:
    of = control({0: OFF, 10: ON}, (GuideChange(0, "MCS"),), dumps=(0, 10, 39))
    tool = found(kinematic(), distance_3d=of)
    assert [(dump.time_ns // MS, dump.values) for dump in tool.diagnosis] == [
        (0, {"kp": "0"}), (10, {"kp": "10"}), (39, {"kp": "39"}),
    ]  # fmt: skip
    bare = found(kinematic())
    assert (list(bare.guides), list(bare.diagnosis)) == ([], [])
    without_length = replace(kinematic(), tool_mm=0.0)
    assert len(found(without_length, distance_3d=of).guides) == 1
