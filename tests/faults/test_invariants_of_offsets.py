"""Invariants of distance control, of one axis and of the channel, and of states.

Recordings made by hand, a row each millisecond, limits in round numbers.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.faults.made_runs import (
    BRAKES,
    CONTROLLER,
    LISTS,
    OF_CONTROL,
    alarm,
    braked,
    found,
    left,
)

from axisrig.bench.record.distance import DistanceChange, DistanceRecord
from axisrig.bench.tools.scenarios.left import Left
from axisrig.bench.tools.scenarios.limits import lists_of, offset_lists_of
from axisrig.bench.tools.scenarios.states import channel_edges, distance_edges, drive_edges
from axisrig.kernel.time.clock import MS


def offset(
    course_mm: Sequence[float],
    sensor_mm: Sequence[float] = (-2.0,) * 100,
    state: Sequence[float] = (4.0,) * 100,
    lists: Any = OF_CONTROL,
    **more: Any,
) -> Left:
    columns = {"Z.offset_mm": course_mm, "Z.sensor_mm": sensor_mm, "Z.distance_state": state,
               "Z.distance_held": [0.0] * 100}  # fmt: skip
    return left(
        "distance",
        more.pop("set_mm", [1.0 + each for each in course_mm]),
        {**LISTS, **lists},
        columns=columns,
        control=("INACTIVE", "ACTIVE"),
        **more,
    )


STOPS_MM = [min(row, 50) * 9e-3 for row in range(100)]
"""Stands from row 50 on: 9000 mm/s2 where 5000 are allowed."""


@pytest.mark.parametrize(
    ("alarm_ms", "may_stop"), [(47, False), (48, True), (52, True), (53, False), (80, False)]
)
def test_what_runs_out_is_held_by_an_alarm_within_two_cycles(alarm_ms: int, may_stop: bool) -> None:
    """TURNING_OFF to INACTIVE at row 50."""
    made = offset(STOPS_MM, state=[3.0] * 50 + [0.0] * 50, alarms=(alarm(alarm_ms),))
    assert set(found(made)) - {"stop"} == (set() if may_stop else {"acceleration"})


def test_an_offset_in_freeze_for_long_may_not_stop_at_once_again() -> None:
    """It is held from the row on in which FREEZE begins, and stands."""
    assert found(offset(STOPS_MM, state=[2.0] * 100)) == ["acceleration"]
    assert found(offset(STOPS_MM, state=[5.0] * 100)) == ["acceleration"]


@pytest.mark.parametrize("state", [2.0, 5.0])
def test_3d_control_may_stop_an_axis_at_once_too(state: float) -> None:
    """FREEZE and ERROR of the channel, P-CHAN-00415 = 50 mm/s on each axis."""
    columns = {"channel.distance_state": [4.0] * 49 + [state] * 51}
    lists = {"v_max": 50_000, "a_max": 1000}
    held = left(set_mm=[1.0 + each for each in STOPS_MM], channel_lists=lists, columns=columns)
    assert found(held) == []
    columns = {"channel.distance_state": [4.0] * 100}
    going = left(set_mm=[1.0 + each for each in STOPS_MM], channel_lists=lists, columns=columns)
    assert found(going) == ["acceleration"]


@pytest.mark.parametrize("who", ["own", "channel"])
def test_an_offset_against_the_path_hides_no_speed_of_the_path(who: str) -> None:
    """A path at 60 mm/s under an offset of -20 mm/s until the alarm at row 30, then both brake.

    The set position loses 40 mm/s, the path 60: 30 ms at 2000 mm/s2 and 3 cycles. Row by row: own
    control is in the set position one row later, what is superposed at once.
    """
    path_mm = np.array(braked(2000.0))
    speeds = np.where(np.arange(100) <= 32, -20.0, 0.0)
    offset_mm = np.cumsum(speeds) * 1e-3
    in_set_mm = np.concatenate((offset_mm[:1], offset_mm[:-1])) if who == "own" else offset_mm
    column = "Z.offset_mm" if who == "own" else "Z.superposed_mm"
    lists = {**BRAKES, "kenngr.dist_ctrl[0].v_max": 50_000}
    made = left(
        set_mm=[float(each) for each in path_mm + in_set_mm],
        lists=lists,
        columns={column: [float(each) for each in offset_mm]},
        alarms=(alarm(30),),
    )
    assert "stop" not in found(made)
    # The same speeds without an offset: they began with 40 mm/s and took 30 ms for it
    alone = replace(made, series=left(set_mm=[float(each) for each in path_mm + in_set_mm]).series)
    assert "stop" in found(alone)


def towards(begin: int, end: int, speed_mm_s: float = 5.0) -> list[float]:
    """An offset that goes towards the workpiece between two rows."""
    return [-speed_mm_s * 1e-3 * min(max(row - begin, 0), end - begin) for row in range(100)]


def blind(first: int, last: int) -> list[float]:
    """Values that the lists allow (-7.9 to -0.1), and none from a row to another."""
    return [0.0 if first <= row <= last else -2.0 for row in range(100)]


@pytest.mark.parametrize(
    ("course_mm", "sensor_mm", "wrong"),
    [
        (towards(50, 60), blind(45, 70), ["blind"]),  # from rest towards it
        (towards(50, 60), blind(61, 99), []),  # before it was blind
        (towards(50, 60), blind(0, 49), []),  # after it
        ([-each for each in towards(50, 60)], blind(45, 70), []),  # away from it
        (towards(0, 10), blind(0, 70), ["blind"]),  # blind from the first row on
    ],
)
def test_without_a_value_the_offset_does_not_go_towards_the_workpiece(
    course_mm: list[float], sensor_mm: list[float], wrong: list[str]
) -> None:
    assert found(offset(course_mm, sensor_mm)) == wrong


def test_there_and_back_while_blind_counts_as_there() -> None:
    course_mm = [a - b for a, b in zip(towards(50, 60, 2.4), towards(60, 70, 2.4), strict=True)]
    assert course_mm[-1] == pytest.approx(0.0)
    assert found(offset(course_mm, blind(45, 80))) == ["blind"]


def test_without_an_acceleration_in_the_list_two_cycles_of_its_speed_are_left() -> None:
    """5 mm/s: 10 um in two cycles."""
    lists = {name: each for name, each in OF_CONTROL.items() if not name.endswith("a_max")}
    for rows, wrong in ((50, []), (60, ["blind"])):
        made = offset(towards(20, rows), blind(50, 99), lists=lists)
        assert [name for name in found(made) if name == "blind"] == wrong


@pytest.mark.parametrize(
    ("lists", "allowed"),
    [
        ({}, [True, True, True, True, True]),
        ({"min_pos": -80_000, "max_pos": 0}, [True, True, True, True, False]),
        ({"min_pos": -80_000, "max_pos": 0, "tolerance": 1000}, [True, False, True, False, False]),
        ({"min_pos": 0}, [True, False, False, True, True]),
        ({"max_pos": 0}, [True, True, True, True, False]),
    ],
)
def test_a_range_of_the_sensor_is_smaller_by_its_tolerance(
    lists: dict[str, int], allowed: list[bool]
) -> None:
    """0.1 um: -8 mm to 0, or -7.9 to -0.1; a missing value is none that is out of range."""
    made = left(
        control=("INACTIVE",), lists={f"kenngr.dist_ctrl[0].{n}": v for n, v in lists.items()}
    )
    values = np.array([np.nan, -8.0, -7.9, 0.0, 0.1])
    assert offset_lists_of(made.facts)["Z"].allows(values).tolist() == allowed


def test_limits_are_those_that_a_list_writes() -> None:
    made = left(lists={**LISTS, **OF_CONTROL}, control=("INACTIVE",), channel_lists={"v_max": 7000,
                "a_max": 30, "max_deviation": 40, "min_pos": -50, "max_pos": 60})  # fmt: skip
    own = lists_of(made.facts.axes["Z"])
    assert (own.rate(1), own.rate(2), own.stroke_mm) == pytest.approx((100.0, 4000.0, 1.0))
    of = offset_lists_of(made.facts)
    assert set(of) == {"Z", "channel"}
    assert (of["Z"].rate(1), of["Z"].rate(2), of["Z"].deviation_mm) == pytest.approx(
        (50, 1000, 0.5)
    )
    channel = of["channel"]
    assert (channel.rate(1), channel.rate(2)) == pytest.approx((7.0, 30.0))
    numbers = (channel.deviation_mm, channel.lowest_mm, channel.highest_mm)
    assert numbers == pytest.approx((0.004, -0.005, 0.006))
    nothing = lists_of(left(lists={}).facts.axes["Z"])
    assert (nothing.rate(1), nothing.rate(2), nothing.stroke_mm) == (None, None, None)


# States


def changes(*states: tuple[str, int]) -> tuple[DistanceChange, ...]:
    return tuple(
        DistanceChange(at_ms * MS, name, "NC", "gap", False, CONTROLLER) for name, at_ms in states
    )


@pytest.mark.parametrize(
    ("last_ms", "alarms", "wrong"),
    [
        (99, (), []),  # the program ends at 100 ms: what it leaves is left
        (97, (), ["states"]),
        (58, (alarm(60),), []),  # an alarm leaves it too
        (57, (alarm(60),), ["states"]),
        (99, (alarm(60),), []),
    ],
)
@pytest.mark.parametrize("who", ["Z", "channel"])
def test_an_offset_is_left_as_the_program_ends(
    who: str, last_ms: int, alarms: Any, wrong: list[str]
) -> None:
    """Else ACTIVE comes to INACTIVE by way of TURNING_OFF alone."""
    record = DistanceRecord(changes=changes(("INACTIVE", 1), ("ACTIVE", 5), ("INACTIVE", last_ms)))
    made = left(alarms=alarms)
    of = {"distance": {"Z": record}} if who == "Z" else {"distance_3d": record}
    made = replace(made, facts=replace(made.facts, **of))
    assert found(made) == wrong


def test_a_state_may_come_again_without_an_edge() -> None:
    record = DistanceRecord(changes=changes(("INACTIVE", 1), ("ACTIVE", 5), ("ACTIVE", 9)))
    made = left()
    assert found(replace(made, facts=replace(made.facts, distance={"Z": record}))) == []


def test_the_second_axis_is_looked_at_as_the_first() -> None:
    made = left(drive=("SWITCH_ON_DISABLED", "OPERATION_ENABLED"))
    good = replace(made.facts.axes["Z"], states=())
    axes = {"X": good, "Z": made.facts.axes["Z"]}
    assert found(replace(made, facts=replace(made.facts, axes=axes))) == ["states"]


def test_the_edges_of_the_tables() -> None:
    """CiA 402-2: 0 has no state before it; docs/distance-control.md: an error from any state."""
    drives = drive_edges.__wrapped__()
    assert {("*", "NOT_READY_TO_SWITCH_ON"), ("FAULT", "SWITCH_ON_DISABLED")} <= drives
    assert ("SWITCH_ON_DISABLED", "OPERATION_ENABLED") not in drives
    distance = distance_edges.__wrapped__()
    assert {("*", "ERROR"), ("TURNING_OFF", "INACTIVE"), ("INACTIVE", "ACTIVE")} <= distance
    assert not {("INACTIVE", "FREEZE"), ("ACTIVE", "")} & distance
    channel = channel_edges.__wrapped__()
    assert channel
    assert all(all(pair) for pair in (*drives, *distance, *channel))
