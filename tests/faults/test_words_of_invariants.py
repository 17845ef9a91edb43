"""Invariants of scenarios: what they say, exactly at their bounds, and where several are broken.

Recordings made by hand, a row each millisecond, limits in round numbers (`made_runs.py`).
"""

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.faults.made_runs import (
    BRAKES,
    CONTROLLER,
    OF_CONTROL,
    alarm,
    edge,
    found,
    left,
    ramp,
    run,
)

from axisrig.bench.record.distance import DistanceChange, DistanceRecord
from axisrig.bench.record.facts import MessageRecord
from axisrig.bench.record.measuring import FixedStop
from axisrig.bench.tools.scenarios.invariants import broken, values_of
from axisrig.bench.tools.scenarios.left import Left, StatesSeen, crept_mm, thrown
from axisrig.bench.tools.scenarios.machines import machines
from axisrig.bench.tools.scenarios.states import drive_edges, wrong_steps
from axisrig.kernel.time.clock import MS


def words_of(made: Left) -> dict[str, str]:
    return dict(broken(made))


# Values that are printed, and published


def test_each_block_that_prints_is_of_its_own_run() -> None:
    """N30 prints the value of the first run, N60 that of the second; other blocks print others."""
    first, second = machines()["one-axis"].prints
    messages = tuple(
        MessageRecord(block, values, "")
        for block, values in ((second, (20.0,)), (10, (7.0,)), (first, (10.0, 99.0)), (second, ()))
    )
    runs = (run(25, 40, 10.0), run(45, 60, 20.0))
    made = left(runs=runs, edges=(edge(30, 10.0), edge(50, 20.0)), messages=messages)
    assert list(values_of(made)) == [
        (1, "Z", 20.0), (0, "Z", 10.0), (0, "Z", 10.0), (1, "Z", 20.0)
    ]  # fmt: skip
    assert found(made) == []
    for block, run_number in ((first, 1), (second, 2)):
        wrong = (MessageRecord(block, (15.0,), ""),)
        words = words_of(replace(made, facts=replace(made.facts, messages=wrong)))["value"]
        assert words.startswith(f"run {run_number}: axis Z 15.000000 mm where {10 * run_number}")


@pytest.mark.parametrize("off", [3.0, -3.0])
def test_a_wrong_value_has_how_far_it_is_off_in_increments_with_its_sign(off: float) -> None:
    made = left(runs=(run(25, 40, 10.0 + off * 1e-5),), edges=(edge(30, 10.0),))
    assert words_of(made)["value"].endswith(
        f"mm where 10.000000 mm are true: off by {off} increments"
    )


def test_the_first_wrong_run_is_named_and_one_at_a_stop_under_its_own_name() -> None:
    at_stop = run(65, 80, 30.0, fixed_stop=FixedStop({}, detected_ns=70 * MS))
    runs = (run(25, 40, 10.0), run(45, 60, 25.0), at_stop)
    made = left(
        "fixed-stop", runs=runs, edges=(edge(30, 10.0), edge(50, 20.0)),
        columns={"Z.stop_force_n": [0.0] * 100},
    )  # fmt: skip
    words = words_of(made)
    assert words["value"].startswith("run 2: axis Z 25.000000 mm where 20.000000 mm are true")
    assert words["found-stop"] == "run 3: axis Z 30.000000 mm without a stop"
    without = left(runs=runs[:1], edges=(edge(41, 10.0),))
    assert words_of(without)["value"] == "run 1: axis Z 10.000000 mm without an edge of the probe"


# Bounds and their words


def test_a_load_may_move_by_just_so_much_to_count_as_at_rest() -> None:
    """10 um in 50 ms; every axis that moves more is named, with its way."""
    assert found(left(crept_mm={"Z": 0.01, "X": 0.0})) == []
    words = words_of(left(crept_mm={"Z": 0.0101, "X": 0.01, "Y": 2.0}))["rest"]
    assert words == "Z 0.0101 mm in 50 ms, Y 2.0000 mm in 50 ms"


def test_a_set_position_beyond_its_limit_has_its_worst_instant() -> None:
    """4000 mm/s2 to 140 mm/s in 35 ms, of which 100 are allowed; then a step of 0.2 mm in 80."""
    fast = ramp(140.0, 4000.0)
    fast = [mm + (0.06 if row >= 81 else 0.0) for row, mm in enumerate(fast)]
    words = words_of(left(set_mm=fast))
    assert words["speed"] == "axis Z: speed 200 mm/s at 80.000 ms, 100"
    steep = words_of(left(set_mm=ramp(50.0, 5000.0)))["acceleration"]
    assert steep.startswith("axis Z: acceleration 5000 mm/s2 at ")
    assert steep.endswith(" ms, 4000")


def test_the_axis_that_moves_and_the_one_that_goes_too_far_are_named_with_their_way() -> None:
    moved = left("three-axes", [1.0] * 99 + [1.5], axis="Y", lists={})
    assert words_of(moved)["still"] == "axis Y moves by 0.5 mm"
    places = [0.0] * 31 + [min(0.1 * n, 1.25) for n in range(69)]
    stroke = left(
        "overrides", places, {"kenngr.hub_messtaster": 10_000},
        runs=(replace(run(5, 90, None), signal_ns=30 * MS),),
    )  # fmt: skip
    stroke = replace(stroke, facts=replace(stroke.facts, channel={"messtyp": 4}))
    assert words_of(stroke)["stroke"] == "axis Z: 1.2500 mm, stroke 1 mm"


# Distance control


def offset(
    course_mm: Sequence[float],
    sensor_mm: Sequence[float] = (-2.0,) * 100,
    state: Sequence[float] = (4.0,) * 100,
    **more: Any,
) -> Left:
    columns = {"Z.offset_mm": course_mm, "Z.sensor_mm": sensor_mm, "Z.distance_state": state,
               "Z.distance_held": [0.0] * 100}  # fmt: skip
    places = more.pop("set_mm", [1.0 + each for each in course_mm])
    return left(
        "distance", places, {**BRAKES, **OF_CONTROL}, columns=columns,
        control=("INACTIVE", "ACTIVE"), **more,
    )  # fmt: skip


STOPS_MM = [min(row, 50) * 9e-3 for row in range(100)]
"""An offset that runs until row 50, in which the control is off, and then stands."""


@pytest.mark.parametrize(("ends", "may_stop"), [(True, True), (False, False)])
def test_what_runs_out_is_held_by_an_alarm_that_ends_the_program_alone(
    ends: bool, may_stop: bool
) -> None:
    """A warning in the same cycle holds nothing."""
    made = offset(STOPS_MM, state=[3.0] * 50 + [0.0] * 50, alarms=(alarm(50, ends=ends),))
    assert ("acceleration" in found(made)) is not may_stop


@pytest.mark.parametrize(("before_mm_s", "wrong"), [(5.0, ["blind"]), (-5.0, [])])
def test_an_offset_that_has_lifted_has_no_speed_towards_the_workpiece_to_brake(
    before_mm_s: float, wrong: list[str]
) -> None:
    """Blind from row 50 on; 13 um towards it. With 5 mm/s it brakes for 22.5 um and two cycles."""
    course = [before_mm_s * 1e-3 * min(row, 49) for row in range(100)]
    course[50:] = [course[49] - 0.0013 * min(n, 10) for n in range(1, 51)]
    sensor = [-2.0] * 50 + [0.0] * 50
    assert [name for name in found(offset(course, sensor)) if name == "blind"] == wrong


def test_the_offset_of_an_axis_is_in_its_set_position_one_row_later() -> None:
    """The path is at rest; the offset turns from 20 mm/s to -20 mm/s, and stands 16 ms after it.

    20 mm/s come to rest in 10 ms at 2000 mm/s2 and 3 cycles; a path of 40 mm/s had 20 ms for it.
    """
    speeds = [20.0] * 31 + [-20.0] * 16 + [0.0] * 53
    course = np.cumsum(speeds) * 1e-3
    late = np.concatenate((course[:1], course[:-1]))
    made = offset(
        [float(mm) for mm in course], set_mm=[1.0 + float(mm) for mm in late], alarms=(alarm(31),)
    )
    assert words_of(made)["stop"].startswith("16.0 ms after alarm 1, 13.0 ms allowed")


# States of several


def changes(*names: str) -> DistanceRecord:
    return DistanceRecord(
        changes=tuple(
            DistanceChange(n, name, "NC", "gap", False, CONTROLLER) for n, name in enumerate(names)
        )
    )


def test_every_wrong_step_is_named_with_whose_it_is() -> None:
    made = left(
        channel=("STARTING", "RUNNING"), drive=("SWITCH_ON_DISABLED", "OPERATION_ENABLED"),
    )  # fmt: skip
    of = {"distance": {"Z": changes("INACTIVE", "FREEZE")},
          "distance_3d": changes("FREEZE", "TURNING_OFF", "FREEZE")}  # fmt: skip
    assert wrong_steps(replace(made, facts=replace(made.facts, **of))) == (
        "channel: STARTING to RUNNING; drive of Z: SWITCH_ON_DISABLED to OPERATION_ENABLED;"
        " distance control of Z: INACTIVE to FREEZE;"
        " distance control of channel: TURNING_OFF to FREEZE"
    )
    good = changes("INACTIVE", "ACTIVE")
    of = {"distance": {"Z": changes("INACTIVE", "FREEZE")}, "distance_3d": good}
    assert wrong_steps(replace(left(), facts=replace(left().facts, **of))) == (
        "distance control of Z: INACTIVE to FREEZE"
    )
    assert wrong_steps(left()) == ""


def test_a_drive_that_reports_its_state_again_has_made_no_step() -> None:
    names = ("SWITCH_ON_DISABLED", "READY_TO_SWITCH_ON", "READY_TO_SWITCH_ON", "SWITCHED_ON")
    assert ("READY_TO_SWITCH_ON",) * 2 not in drive_edges()
    assert wrong_steps(left(drive=names)) == ""


def test_the_states_of_a_channel_are_kept_where_they_change() -> None:
    """One that comes again after another one as well."""
    kept = StatesSeen()
    for name in ("READY", "READY", "RUNNING", "READY", "READY", "RUNNING"):
        channel: Any = SimpleNamespace(state=SimpleNamespace(name=name))
        kept(channel)
    assert kept.names == ["READY", "RUNNING", "READY", "RUNNING"]


# Loads after the end


@pytest.mark.parametrize(("plant_ms", "scheduler_ms"), [(100, 70), (70, 100), (100, 100)])
def test_a_load_is_looked_at_from_the_later_end_of_plant_and_bus_on(
    plant_ms: int, scheduler_ms: int
) -> None:
    """300 ms after it, for 50 ms: 0.25 mm/s are 12.5 um, whichever way it goes."""
    looked: list[tuple[str, int]] = []
    now = {"plant": plant_ms * MS}

    def go(who: str, until_ns: int) -> None:
        looked.append((who, until_ns))
        if who == "plant":
            now["plant"] = until_ns

    loads = {"z": 0.25e-3, "x": -0.5e-3, "y": 0.0}
    plant = SimpleNamespace(
        now_ns=plant_ms * MS, advance_to=lambda ns: go("plant", ns),
        axes={name: SimpleNamespace(position_m=lambda v=v: v * now["plant"] * 1e-9)
              for name, v in loads.items()},
    )  # fmt: skip
    machine: Any = SimpleNamespace(
        plant=plant,
        scheduler=SimpleNamespace(now_ns=scheduler_ms * MS, run_until=lambda ns: go("bus", ns)),
        settings=SimpleNamespace(
            rig=SimpleNamespace(axis={n.upper(): SimpleNamespace(plant=n) for n in loads})
        ),
    )
    ways = crept_mm(machine)
    assert ways == {"Z": pytest.approx(0.0125), "X": pytest.approx(0.025), "Y": 0.0}
    ends = [(100 + after_ms) * MS for after_ms in (300, 350)]
    assert looked == [(who, end) for end in ends for who in ("bus", "plant")]


def test_only_axes_that_gain_speed_as_nothing_with_a_mass_are_thrown() -> None:
    """Each by its own speed; 500 mm/s in a cycle of 1 ms, and twice as much in one of 2 ms."""
    speeds = {"Z": 400.0, "X": -900.0, "Y": 1001.0}
    columns = {f"{name}.velocity_mm_s": [0.0] * 50 + [v] * 50 for name, v in speeds.items()}
    made = left(columns=columns)
    axes = dict.fromkeys(("Z", "X", "Y", "W"), made.facts.axes["Z"])
    facts = replace(made.facts, axes=axes)
    assert thrown(facts, made.series) == {"X", "Y"}
    slow = replace(facts, timing=replace(facts.timing, period_ns=2 * MS))
    assert thrown(slow, made.series) == {"Y"}
    assert thrown(replace(facts, axes={"Z": axes["Z"]}), made.series) == frozenset()
