"""Every invariant of a scenario finds what breaks it, and nothing where it holds.

The recordings are made by hand: a row each millisecond, one axis, limits in round numbers.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.record.axes import AxisRecord, DriveState, Edge, ProbeRecord
from axisrig.bench.record.distance import Controller, DistanceChange, DistanceRecord
from axisrig.bench.record.edges import EdgeTruth
from axisrig.bench.record.facts import AlarmRecord, Facts, MessageRecord, Timing
from axisrig.bench.record.measuring import FixedStop, MeasurementRun, PlcTaskRecord
from axisrig.bench.record.series import Series
from axisrig.bench.tools.scenarios.invariants import broken, invariants
from axisrig.bench.tools.scenarios.left import Left
from axisrig.bench.tools.scenarios.limits import lists_of
from axisrig.bench.tools.scenarios.machines import machines
from axisrig.bench.tools.scenarios.oracle import Result, judge
from axisrig.bench.tools.scenarios.stopping import stop_ns
from axisrig.kernel.time.clock import MS

PER_MM = 100_000.0
STEP_MM = 1.0 / PER_MM
STEPS = ("stufe_1", "stufe_2", "grenz_stufe_1", "grenz_stufe_2")
LISTS = {
    "getriebe[0].dynamik.vb_max": 100_000,  # 100 mm/s
    "getriebe[0].lslope_profil.a_stufe_1": 2000,
    "getriebe[0].lslope_profil.a_feedh": 4000,
    "kenngr.hub_messtaster": 10_000,  # 1 mm
    "kenngr.measure.edge": "POS",
}
BRAKES = {
    **LISTS,
    **{f"getriebe[0].lslope_profil.a_{step}": 2000 for step in STEPS},
}
OF_CONTROL = {
    "kenngr.dist_ctrl[0].v_max": 50_000,  # 50 mm/s
    "kenngr.dist_ctrl[0].a_max": 1000,
    "kenngr.dist_ctrl[0].max_deviation": 5000,  # 0.5 mm
    "kenngr.dist_ctrl[0].min_pos": -80_000,
    "kenngr.dist_ctrl[0].max_pos": 0,
    "kenngr.dist_ctrl[0].tolerance": 1000,
}
CONTROLLER = Controller(0.2, 0.0, 0.0, "MOVING_AVERAGE", 1, 0.0, 1, 0.0, 0.0, False)


def edge(at_ms: int, place_mm: float | None, axis: str = "Z", level: bool = True) -> EdgeTruth:
    return EdgeTruth("probe", axis, level, at_ms * MS, 0.0, 0.0, at_ms * MS + 1, place_mm, place_mm)


def ramp(speed_mm_s: float, a_mm_s2: float, rows: int = 100) -> list[float]:
    """Set positions, a row each ms: up to the speed with the acceleration, then on."""
    speeds = np.minimum(np.arange(rows) * a_mm_s2 * 1e-3, speed_mm_s)
    return [float(place) for place in np.cumsum(speeds * 1e-3)]


def left(
    machine: str = "one-axis",
    set_mm: Sequence[float] = (1.0,) * 100,
    lists: Mapping[str, Any] = LISTS,
    *,
    columns: Mapping[str, Sequence[float]] | None = None,
    crept_mm: Mapping[str, float] | None = None,
    channel: Sequence[str] = ("STARTING", "POWERING", "RUNNING", "ENDED"),
    drive: Sequence[str] = (),
    control: Sequence[str] = (),
    hidden: Sequence[str] = (),
    axis: str = "Z",
    channel_lists: Mapping[str, Any] | None = None,
    **facts: Any,
) -> Left:
    times_ns = np.arange(len(set_mm)) * MS
    table = {
        "time_ns": pa.array(times_ns),
        f"{axis}.set_mm": pa.array(set_mm, pa.float64()),
        f"{axis}.truth_mm": pa.array(set_mm, pa.float64()),
        f"{axis}.velocity_mm_s": pa.array(np.gradient(np.array(set_mm)) * 1e3),
        **{name: pa.array(values, pa.float64()) for name, values in (columns or {}).items()},
    }
    record = AxisRecord(
        "can1", 3, PER_MM, plant="z", signals={"probe_1": "probe"}, written=dict(lists),
        states=tuple(DriveState(n, name) for n, name in enumerate(drive)),
    )  # fmt: skip
    changes = tuple(
        DistanceChange(n, name, "NC", "gap", False, CONTROLLER) for n, name in enumerate(control)
    )
    distance = {axis: DistanceRecord(changes=changes)} if control else {}
    if channel_lists is not None:
        facts["distance_3d"] = DistanceRecord(changes=())
        facts["channel"] = {f"dist_ctrl[0].{name}": it for name, it in channel_lists.items()}
    whole = {
        "timing": Timing(MS, 600_000, 0), "sim_ns": len(set_mm) * MS, "start_ns": 0,
        "end_ns": len(set_mm) * MS, "frame_log_sha256": "", "axes": {axis: record},
        "distance": distance, **facts,
    }  # fmt: skip
    return Left(
        machines()[machine],
        Facts(**whole),
        Series(pa.table(table)),
        crept_mm or {},
        channel,
        frozenset(hidden),
    )


def run(begin_ms: int, end_ms: int, value_mm: float | None, **more: Any) -> MeasurementRun:
    latched = {} if value_mm is None else {"Z": value_mm}
    return MeasurementRun(
        ("Z",), inputs={"Z": 1}, sources={"Z": "DRIVE"}, begin_ns=(begin_ms - 5) * MS,
        start_ns=begin_ms * MS, end_ns=end_ms * MS, latched_mm=latched, **more,
    )  # fmt: skip


def alarm(at_ms: int, ends: bool = True, number: int = 1) -> AlarmRecord:
    return AlarmRecord(at_ms * MS, number, 7 if ends else 1, ends, "")


def braked(a_mm_s2: float, dead: int = 2) -> list[float]:
    """Set positions with 60 mm/s until row 30 and `dead` more, then braked."""
    speeds = [60.0] * (31 + dead)
    speeds += [max(0.0, 60.0 - a_mm_s2 * 1e-3 * n) for n in range(1, 100 - len(speeds) + 1)]
    return [float(place) for place in np.cumsum(speeds) * 1e-3]


FEED_BRAKE = {"getriebe[0].lslope_profil.d_stufe_2": 1500}
EMERGENCY = {"getriebe[0].dynamik.a_emergency": 1000}


def stopped(
    a_mm_s2: float,
    dead: int = 2,
    lists: Mapping[str, Any] | None = None,
    beside: Mapping[str, Any] | None = None,
    beside_mm: Sequence[float] | None = None,
) -> Left:
    """Z brakes after an alarm at row 30; lists: added to its own.

    beside: of an X like it, with set positions of its own or the same.
    """
    course = braked(a_mm_s2, dead)
    made = left(
        "gantry",
        course,
        {**BRAKES, **(lists or {})},
        columns={} if beside is None else {"X.set_mm": beside_mm or course},
        alarms=(alarm(30),),
    )
    if beside is None:
        return made
    axes = dict(made.facts.axes)
    axes["X"] = replace(axes["Z"], written={**BRAKES, **beside})
    return replace(made, facts=replace(made.facts, axes=axes))


EDGES = (edge(30, 10.0), edge(50, 20.0), edge(30, -1.0, "X"), edge(29, -2.0, level=False))
BEHIND = {"edges": (*EDGES, edge(28, None))}


def values(first_mm: float | None, second_mm: float | None = None, **more: Any) -> Left:
    return left(runs=(run(25, 40, first_mm), run(45, 60, second_mm)), **{**BEHIND, **more})


def printed(block: int, value_mm: float) -> tuple[MessageRecord, ...]:
    return (MessageRecord(block, (value_mm,), ""),)


def at_stop(force_n: float) -> Left:
    stop = FixedStop({}, detected_ns=35 * MS)
    return left(
        "fixed-stop",
        runs=(run(25, 40, 10.0, fixed_stop=stop),),
        columns={"Z.stop_force_n": [force_n] * 100},
    )


def at_plc(value_mm: float, edge_ms: int = 30, passed_ms: int | None = None) -> Left:
    """A PLC of 1 ms at a terminal of 1 ms: the position of the SYNC before the cycle that sees.

    The axis is at 1 mm until row 32, then at 2 mm. passed_ms: of the edge that the wire has passed.
    """
    task = PlcTaskRecord(MS, 0, 0, MS, 0, probes=("probe",))
    passed = None if passed_ms is None else (Edge(passed_ms * MS + 7, True),)
    probe = ProbeRecord(True, 0.0, edges=(Edge(edge_ms * MS + 7, True),), passed=passed)
    return left(
        "source-plc",
        runs=(replace(run(25, 40, value_mm), sources={"Z": "PLC"}, signal_ns=32 * MS),),
        probes={"probe": probe},
        plc_task=task,
        columns={"Z.truth_mm": [1.0] * 33 + [2.0] * 67},
    )


def stopping(speed_mm_s: float = 9.0) -> list[float]:
    """Offset that stands from row 50 on; 9 mm/s are 9000 mm/s2 then, 5000 allowed."""
    return [min(row, 50) * speed_mm_s * 1e-3 for row in range(100)]


def offset(
    course_mm: Sequence[float],
    sensor_mm: Sequence[float] | float = -2.0,
    state: Sequence[float] = (4.0,) * 100,
    held: Sequence[float] = (0.0,) * 100,
    **facts: Any,
) -> Left:
    sensor = [sensor_mm] * len(course_mm) if isinstance(sensor_mm, float) else sensor_mm
    return left(
        "distance",
        [1.0 + each for each in course_mm],
        {**LISTS, **OF_CONTROL},
        columns={
            "Z.offset_mm": course_mm,
            "Z.sensor_mm": sensor,
            "Z.distance_state": state,
            "Z.distance_held": held,
        },
        control=("INACTIVE", "ACTIVE"),
        **facts,
    )


BLIND = [-2.0] * 50 + [0.0] * 50
"""Sensor values: none that the lists allow from row 50 on."""


def held_from(speed_mm_s: float) -> Left:
    """An offset with this speed that is held from row 8 on; 1 + 4 and 50 mm/s each ms allowed."""
    course = [(min(row, 8) - 8) * speed_mm_s * 1e-3 for row in range(100)]
    return offset(course, state=[4] * 8 + [2] * 92)


@pytest.mark.parametrize(
    ("before", "after", "held", "alarms_ms", "may_stop"),
    [
        (4, 2, 0, (), True),  # FREEZE
        (1, 5, 0, (), True),  # ERROR
        (4, 4, 1, (), True),  # feedhold of the axis
        (1, 0, 0, (), True),  # switched off where it is
        (3, 0, 0, (50,), True),  # the same while it ran out
        (3, 0, 0, (), False),  # it came to its end
        (4, 4, 0, (50,), False),  # an alarm of something else
        (4, 3, 0, (), False),  # OFF
        (0, 4, 0, (), False),  # ON
        (2, 1, 0, (), False),  # on again
    ],
)
def test_only_what_holds_an_offset_lets_it_stop_at_once(
    before: int, after: int, held: int, alarms_ms: tuple[int, ...], may_stop: bool
) -> None:
    """States as their numbers in `DistanceState`; the change is at row 50."""
    made = offset(
        stopping(),
        state=[before] * 50 + [after] * 50,
        held=[0] * 50 + [held] * 50,
        alarms=tuple(alarm(each) for each in alarms_ms),
    )
    broken_ones = {name for name, _ in broken(made)} - {"stop"}
    assert broken_ones == (set() if may_stop else {"acceleration"})


def braking(a_mm_s2: float) -> list[float]:
    """Offset towards the workpiece with 5 mm/s until row 50, then braked."""
    speeds = [5.0] * 50 + [max(0.0, 5.0 - a_mm_s2 * 1e-3 * n) for n in range(1, 51)]
    return [float(place) for place in -np.cumsum(speeds) * 1e-3]


HOLDS_AND_BREAKS: list[tuple[str, Left, Left]] = [
    ("value", values(10.0, 20.0), values(10.0, 20.0 + 1.01 * STEP_MM)),
    ("value", values(10.0 + 0.99 * STEP_MM, 20.0 - 0.99 * STEP_MM), values(10.0 - 1.01 * STEP_MM)),
    ("value", values(None), values(20.0)),  # that of the other run
    ("value", values(None, 20.0), values(None, 20.0, edges=(edge(30, 10.0), edge(61, 20.0)))),
    ("value", values(10.0, edges=(edge(25, 10.0),)), values(10.0, edges=(edge(24, 10.0),))),
    ("value", values(10.0, edges=(edge(40, 10.0),)), values(10.0, edges=None)),
    (
        "value",
        values(None, messages=printed(60, 20.0)),
        values(None, messages=printed(30, 20.0)),
    ),
    ("value", values(10.0, hidden=("value",)), values(11.0)),
    ("found-stop", at_stop(12.0), at_stop(0.0)),
    ("value", at_plc(1.0), at_plc(1.0 + 2 * STEP_MM)),
    ("value", at_plc(1.0), at_plc(1.0, edge_ms=45)),
    (
        "value",
        at_plc(2.0, passed_ms=33),
        at_plc(1.0, passed_ms=33),
    ),  # of the wire
    ("stop", stopped(2000.0), stopped(1850.0)),
    ("stop", stopped(2000.0, dead=4), stopped(2000.0, dead=5)),
    ("stop", stopped(1000.0, lists=EMERGENCY), stopped(950.0, lists=EMERGENCY)),
    ("stop", stopped(1500.0, lists=FEED_BRAKE), stopped(1400.0, lists=FEED_BRAKE)),
    (
        "stop",  # the slowest axis decides, by its own list
        stopped(1000.0, beside={"getriebe[0].lslope_profil.d_stufe_1": 1000}),
        stopped(950.0, beside={"getriebe[0].lslope_profil.d_stufe_1": 1000}),
    ),
    (
        "stop",  # the axis that stops last counts, wherever it is in the rig
        stopped(2000.0, beside={}, beside_mm=braked(4000.0)),
        stopped(1850.0, beside={}, beside_mm=braked(4000.0)),
    ),
    (
        "stop",
        stopped(4000.0, beside={}, beside_mm=braked(2000.0)),
        stopped(4000.0, beside={}, beside_mm=braked(1850.0)),
    ),
    (
        "stop",  # the first that ends the program counts, not a warning before it
        left(set_mm=braked(2000.0), lists=BRAKES, alarms=(alarm(10, ends=False), alarm(30))),
        left(set_mm=braked(2000.0), lists=BRAKES, alarms=(alarm(25), alarm(30))),
    ),
    ("rest", left(crept_mm={"Z": 0.0099}), left(crept_mm={"Z": 0.0101})),
    ("speed", left(set_mm=ramp(100.0, 4000.0)), left(set_mm=ramp(100.02, 4000.0))),
    ("acceleration", left(set_mm=ramp(50.0, 4000.0)), left(set_mm=ramp(50.0, 4100.0))),
    (
        "acceleration",  # what holds the offset holds it at once, the axis itself may not stop so
        offset(stopping(), state=[4] * 49 + [2] * 51),
        offset(stopping(), state=[4] * 100),
    ),
    (
        "acceleration",  # and takes its speed away, P-AXIS-00415 = 50 mm/s; 4000 and 1000 on top
        held_from(54.9),
        held_from(55.1),
    ),
    (
        "speed",  # of 3D control: its 50 mm/s come on top
        left(set_mm=ramp(150.0, 4000.0), channel_lists={"v_max": 50_000}),
        left(set_mm=ramp(150.02, 4000.0), channel_lists={"v_max": 50_000}),
    ),
    (
        "acceleration",
        left(set_mm=ramp(50.0, 5000.0), channel_lists={"a_max": 1000}),
        left(set_mm=ramp(50.0, 5100.0), channel_lists={"a_max": 1000}),
    ),
    ("deviation", offset([0.5] * 100), offset([0.501] * 100)),
    ("deviation", offset([-0.5] * 100), offset([-0.501] * 100)),
    ("blind", offset(braking(1000.0), BLIND), offset(braking(200.0), BLIND)),
    ("blind", offset(braking(0.0)), offset(braking(0.0), BLIND)),
    ("states", left(), left(channel=("STARTING", "RUNNING"))),
    (
        "states",
        left(drive=("SWITCH_ON_DISABLED", "READY_TO_SWITCH_ON", "FAULT_REACTION_ACTIVE", "FAULT")),
        left(drive=("SWITCH_ON_DISABLED", "OPERATION_ENABLED")),
    ),
    (
        "states",
        left(control=("INACTIVE", "ACTIVE", "FREEZE", "TURNING_OFF", "INACTIVE")),
        left(control=("INACTIVE", "FREEZE")),
    ),
    ("states", left(control=("INACTIVE", "ACTIVE", "ERROR")), left(control=("ERROR", "ACTIVE"))),
    (
        "still",
        left("three-axes", axis="Y", lists={}),
        left("three-axes", [1.0] * 99 + [1.0 + STEP_MM], axis="Y", lists={}),
    ),
]


@pytest.mark.parametrize(("name", "holds", "breaks"), HOLDS_AND_BREAKS)
def test_an_invariant_finds_what_breaks_it_and_nothing_else(
    name: str, holds: Left, breaks: Left
) -> None:
    assert [found for found, _ in broken(holds)] == []
    found = dict(broken(breaks))
    assert list(found) == [name], found
    assert found[name]


@pytest.mark.parametrize(
    ("kind", "way_mm", "found"), [(4, 1.0, []), (4, 1.01, ["stroke"]), (1, 1.01, [])]
)
def test_a_run_of_type_4_stops_within_its_stroke(
    kind: int, way_mm: float, found: list[str]
) -> None:
    places = [row * 0.05 for row in range(31)]
    places += [places[-1] + way_mm * min(n / 20, 1.0) for n in range(1, 70)]
    signalled = replace(run(5, 90, None), signal_ns=30 * MS)
    lists = {"kenngr.hub_messtaster": 10_000}
    made = left("overrides", places, lists, runs=(signalled,))
    made = replace(made, facts=replace(made.facts, channel={"messtyp": kind}))
    assert [name for name, _ in broken(made)] == found


RAMPED = {
    **LISTS,
    "getriebe[0].dynamik.tr_min": 0,
    "getriebe[0].slope_profil.a_beschl": 1000,
    "getriebe[0].slope_profil.a_brems": 2000,
    "getriebe[0].slope_profil.a_grenz": 4000,
    "getriebe[0].slope_profil.a_feedh": 500,
    **{f"getriebe[0].slope_profil.tr_{name}": 10_000 for name in ("grenz", "feedh")},
    **{f"getriebe[0].slope_profil.tr_beschl_{name}": 5000 for name in ("zu", "ab")},
    "getriebe[0].slope_profil.tr_brems_zu": 10_000,
    "getriebe[0].slope_profil.tr_brems_ab": 30_000,
}


@pytest.mark.parametrize(
    ("channel", "lists", "expected_ms"),
    [
        # 60 / 2000
        ({}, BRAKES, 30.0),
        # Under a kinematic its ramps have half of it: 60 / 1000
        ({"kinematic": True}, BRAKES, 60.0),
        # P-AXIS-00024 acts with P-CHAN-00097: 60 / 500
        ({}, {**BRAKES, "getriebe[0].lslope_profil.a_feedh": 500}, 30.0),
        (
            {"use_drive_curr_limit": 1},
            {**BRAKES, "getriebe[0].lslope_profil.a_feedh": 500},
            120.0,
        ),
        # G0 that builds up: 2 x 10 ms, in which 60 grow by 4000 x 0.02 / 2; feed that brakes:
        # 100 / 2000 and (10 + 30) / 2 ms
        ({"prog_start.slope.profile": 1}, RAMPED, 20.0 + 50.0 + 20.0),
        # and with P-AXIS-00053: 100 / 500 and 10 ms
        ({"prog_start.slope.profile": 2, "use_drive_curr_limit": 1}, RAMPED, 20.0 + 200.0 + 10.0),
        # P-AXIS-00008 limits G0 to 1000: 20 ms, 60 + 10; then by feed or by G0 70 / 1000
        (
            {"prog_start.slope.profile": 1},
            {**RAMPED, "getriebe[0].dynamik.a_max": 1000},
            20.0 + 70.0 + 20.0,
        ),
    ],
)
def test_how_long_a_speed_takes_by_the_lists(
    channel: dict[str, Any], lists: Mapping[str, Any], expected_ms: float
) -> None:
    """From 60 mm/s; three NC cycles of 1 ms are on top."""
    given = dict(channel)
    kinematics = (object(),) if given.pop("kinematic", False) else ()
    made = left(set_mm=braked(2000.0), lists=lists, alarms=(alarm(30),))
    facts = replace(made.facts, channel=given, kinematics=kinematics)
    places = {"Z": (np.arange(100.0) * MS, np.array(braked(2000.0)))}
    assert stop_ns(facts, 30 * MS, places) == pytest.approx((expected_ms + 3.0) * MS)


def test_every_invariant_of_the_table_is_broken_somewhere_here() -> None:
    here = {name for name, _, _ in HOLDS_AND_BREAKS} | {"stroke"}
    assert {invariant.name for invariant in invariants()} == here


def test_an_invariant_is_about_the_machines_of_its_row_alone() -> None:
    """Set positions follow the drive while that looks for its switch."""
    fast = ramp(150.0, 4000.0)
    assert [name for name, _ in broken(left("homing", fast))] == []
    assert [name for name, _ in broken(left("gantry", fast))] == ["speed"]


def test_the_largest_acceleration_of_the_lists_counts() -> None:
    assert lists_of(left().facts.axes["Z"]).a_mm_s2 == 4000.0


def test_a_judgement_names_what_is_broken_and_counts_what_is_right() -> None:
    both = judge(values(10.0, 21.0, crept_mm={"Z": 5.0}, alarms=(alarm(99),)))
    assert (both.result, both.broken, both.right) == (Result.BROKEN, ("value", "rest"), 1)
    assert both.note.startswith("value: run 2: axis Z 21.000000 mm where 20.000000 mm are true")
    ended = judge(values(10.0, alarms=(alarm(99, number=900006),)))
    assert (ended.result, ended.alarms, ended.right) == (Result.ALARM, [900006], 1)
    warned = judge(values(10.0, 20.0, alarms=(alarm(9, ends=False),)))
    assert (warned.result, warned.right) == (Result.GOOD, 2)
