"""Every invariant of a scenario finds what breaks it, and nothing where it holds.

The recordings are made by hand: a row each millisecond, one axis, limits in round numbers.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.faults.made_runs import (
    BRAKES,
    LISTS,
    OF_CONTROL,
    STEP_MM,
    alarm,
    braked,
    edge,
    left,
    ramp,
    run,
)

from axisrig.bench.record.axes import Edge, ProbeRecord
from axisrig.bench.record.facts import MessageRecord
from axisrig.bench.record.measuring import FixedStop, PlcTaskRecord
from axisrig.bench.tools.scenarios.invariants import _machines, broken, invariants
from axisrig.bench.tools.scenarios.left import Left, thrown
from axisrig.bench.tools.scenarios.limits import lists_of
from axisrig.bench.tools.scenarios.machines import machines
from axisrig.bench.tools.scenarios.oracle import Result, judge
from axisrig.kernel.time.clock import MS

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
RUNS_OUT = [1.0] * 48 + [3.0] * 52
"""States: active, and switched off two rows before."""


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
        (4, 0, 0, (), True),
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
    (
        "blind",
        offset(braking(0.0), BLIND, RUNS_OUT),
        offset(braking(0.0), BLIND, [*RUNS_OUT[:75], *[1.0] * 25]),
    ),
    ("states", left(), left(channel=("STARTING", "RUNNING"))),
    (
        "states",
        left(drive=("SWITCH_ON_DISABLED", "READY_TO_SWITCH_ON", "FAULT_REACTION_ACTIVE", "FAULT")),
        left(drive=("SWITCH_ON_DISABLED", "OPERATION_ENABLED")),
    ),
    (
        "states",  # a power loss is the edges 0 and 1, whatever the state before
        left(drive=("FAULT_REACTION_ACTIVE", "NOT_READY_TO_SWITCH_ON", "SWITCH_ON_DISABLED")),
        left(drive=("FAULT_REACTION_ACTIVE", "SWITCH_ON_DISABLED")),
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
    ("kind", "way_mm", "found"),
    [(4, 1.0, []), (4, 1.01, ["stroke"]), *((kind, 1.01, []) for kind in (1, 2, 3, 5, 6, 7))],
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


def test_every_invariant_of_the_table_is_broken_somewhere_here() -> None:
    here = {name for name, _, _ in HOLDS_AND_BREAKS} | {"stroke"}
    assert {invariant.name for invariant in invariants()} == here


def test_a_row_names_its_machines_all_or_all_but_some() -> None:
    names = tuple(machines())
    assert _machines("every") == names
    assert _machines("gantry homing") == ("gantry", "homing")
    for left_out in (("homing",), ("homing", "gantry"), (names[0], names[1], names[-1])):
        found = _machines(f"every but {' '.join(left_out)}")
        assert found == tuple(name for name in names if name not in left_out)


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


@pytest.mark.parametrize(("gain_mm_s", "found"), [(499.0, set()), (501.0, {"Z"}), (-501.0, {"Z"})])
def test_an_axis_without_mass_is_known_by_the_speed_that_it_gains(
    gain_mm_s: float, found: set[str]
) -> None:
    """500 m/s2 are 500 mm/s in a cycle of 1 ms; no axis with a mass gains so much."""
    speeds = [0.0] * 50 + [gain_mm_s] * 50
    seen = left(columns={"Z.velocity_mm_s": speeds})
    assert thrown(seen.facts, seen.series) == found


def test_a_value_is_held_to_the_increment_of_what_the_drive_latches() -> None:
    """LATCH32 of a drive on Lightbus counts um, its position 9.5 nm."""
    made = values(10.0 + 5 * STEP_MM)
    assert [name for name, _ in broken(made)] == ["value"]
    axes = {
        name: replace(record, latch_per_mm=record.increments_per_mm / 10)
        for name, record in made.facts.axes.items()
    }
    assert not list(broken(replace(made, facts=replace(made.facts, axes=axes))))
