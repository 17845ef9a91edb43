"""Values, states and offsets where the first of two axes, or of two controls, is another one.

Recordings made by hand, a row each millisecond, limits in round numbers.
"""

import random
from dataclasses import replace
from typing import Any

import pytest
from tests.faults.made_runs import CONTROLLER, LISTS, OF_CONTROL, found, left, run

from axisrig.bench.record.distance import DistanceChange, DistanceRecord
from axisrig.bench.record.facts import MessageRecord
from axisrig.bench.tools.scenarios.drawing import draw_inputs
from axisrig.bench.tools.scenarios.invariants import values_of
from axisrig.bench.tools.scenarios.left import Left
from axisrig.bench.tools.scenarios.machines import machines


def beside(made: Left, axis: str, *, is_first: bool, **changed: Any) -> Left:
    """The recording with a second axis, before or after Z in the rig."""
    other = {axis: replace(made.facts.axes["Z"], **changed)}
    axes = {**other, **made.facts.axes} if is_first else {**made.facts.axes, **other}
    return replace(made, facts=replace(made.facts, axes=axes))


def test_a_printed_value_is_of_the_axis_of_its_own_run() -> None:
    """N30 prints the value of the first run, of X; N60 that of the second, of Z."""
    prints = machines()["one-axis"].prints
    first = replace(run(20, 30, None), axes=("X",), latched_mm={"X": 7.0})
    second = replace(run(40, 60, 11.0), axes=("Z", "Y"), latched_mm={"Z": 11.0, "Y": 12.0})
    messages = tuple(
        MessageRecord(block, values, "")
        for block, values in (
            (prints[1], (11.0, 3.0)), (prints[0], (7.0,)), (prints[0] + 1, (9.0,)), (prints[0], ()),
        )
    )  # fmt: skip
    made = left(runs=(first, second), messages=messages)
    assert list(values_of(made)) == [
        (1, "Z", 11.0), (0, "X", 7.0),
        (0, "X", 7.0), (1, "Z", 11.0), (1, "Y", 12.0),
    ]  # fmt: skip


@pytest.mark.parametrize("is_first", [True, False])
def test_states_are_looked_at_of_every_axis(is_first: bool) -> None:
    """Also of the one before an axis that has none, and beside a channel that is right."""
    made = left(drive=("SWITCH_ON_DISABLED", "OPERATION_ENABLED"))
    assert found(beside(made, "X", is_first=is_first, states=())) == ["states"]


@pytest.mark.parametrize("who", ["X", "Z", "channel"])
def test_states_are_looked_at_of_every_distance_control(who: str) -> None:
    """ACTIVE after ERROR has no edge in the table of distance control."""
    right, wrong = (
        DistanceRecord(
            changes=tuple(
                DistanceChange(at, name, "NC", "gap", False, CONTROLLER)
                for at, name in enumerate(names)
            )
        )
        for names in (("INACTIVE", "ACTIVE"), ("ERROR", "ACTIVE"))
    )
    made = beside(left(), "X", is_first=True)
    of = {name: wrong if name == who else right for name in ("X", "Z", "channel")}
    whole = of.pop("channel")
    facts = replace(made.facts, distance=of, distance_3d=whole)
    assert found(replace(made, facts=facts)) == ["states"]
    assert found(replace(made, facts=replace(facts, distance={}, distance_3d=right))) == []


def towards(speed_mm_s: float) -> list[float]:
    """An offset that goes towards the workpiece from row 50 to 60."""
    return [-speed_mm_s * 1e-3 * min(max(row - 50, 0), 10) for row in range(100)]


BLIND = [0.0 if 45 <= row <= 70 else -2.0 for row in range(100)]
"""The lists allow -7.9 to -0.1 mm."""


def test_a_control_without_a_sensor_column_hides_none_behind_it() -> None:
    """Of X nothing was recorded; Z goes 0.05 mm towards the workpiece while it is blind."""
    for speed_mm_s, wrong in ((0.0, []), (5.0, ["blind"])):
        course_mm = towards(speed_mm_s)
        columns = {"Z.offset_mm": course_mm, "Z.sensor_mm": BLIND,
                   "Z.distance_state": [4.0] * 100, "Z.distance_held": [0.0] * 100}  # fmt: skip
        made = left(
            "distance", [1.0 + each for each in course_mm], {**LISTS, **OF_CONTROL},
            columns=columns, control=("INACTIVE", "ACTIVE"),
        )  # fmt: skip
        made = beside(made, "X", is_first=True)
        distance = {"X": made.facts.distance["Z"], **made.facts.distance}
        assert found(replace(made, facts=replace(made.facts, distance=distance))) == wrong


def test_a_drawn_step_may_be_exactly_as_far_as_it_has_to_be() -> None:
    """`step 50 off 50` beside 50: 0 and 100, never 50 itself; both ends of a range are drawn."""
    cell = "plc:F={50..50} ;; g={0..100 step 50 off 50 F}"
    drawn = {draw_inputs(cell, random.Random(seed))[1] for seed in range(40)}
    assert drawn == {"g=0", "g=100"}
