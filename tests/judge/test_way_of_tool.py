"""The way of a straight block under a kinematic: of the tool, or of what else moves, in degrees.

Source: FCT-M3 12.4.2.1, `G01 A90 F10` takes 540 s; docs/kinematics.md, "The path".
"""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.kinematics.machines import MACHINES, values

from axisrig.bench.judge.observed.tool import way_of_tool
from axisrig.bench.record.kinematics import KinematicRecord
from axisrig.kernel.motion.curves import Line
from axisrig.kernel.motion.tool_path import ToolCurve

# Upper arm 500 mm, forearm 600 mm, nothing behind the wrist: its centre is the tool centre point
WRIST = {f"trafo[0].param[{k}]": 1e4 * mm for k, mm in {6: 400, 7: 500, 8: 600}.items()}
WRIST |= {"trafo[0].id": 45}


def observed(channel: dict[str, Any], axes: str) -> Any:
    """What `way_of_tool` reads of a run; an increment is 0.0001 mm or degrees."""
    drive = SimpleNamespace(increments_per_mm=1e4)
    return SimpleNamespace(facts=SimpleNamespace(channel=channel), axes=dict.fromkeys(axes, drive))


def record(ids: tuple[int, ...], axes: str, tool_mm: float = 0.0) -> KinematicRecord:
    return KinematicRecord(0, None, tuple(axes), ids, tool_mm)


def wrist_way(
    begin: tuple[float, ...], end: tuple[float, ...], target: dict[str, float]
) -> tuple[list[float], float]:
    """The hand goes from one pose to the next in four rows; joints A1, B3, A2."""
    rows = np.linspace((0.0, 0.0, 0.0, *begin), (0.0, 0.0, 0.0, *end), 5)
    gone, length = way_of_tool(observed(WRIST, "XYZABC"), record((45,), "XYZABC"), rows, 0, target)
    return list(gone), length


@pytest.mark.parametrize(
    ("begin", "end", "target", "length_deg"),
    [
        # B3 leans the tool about Y: 90 degrees of the joint are B = 0
        ((0.0, 90.0, 0.0), (0.0, 120.0, 0.0), {"B": 30.0}, 30.0),
        # A2 turns it about its own axis, which points down: C goes the other way
        ((0.0, 90.0, -10.0), (0.0, 90.0, -50.0), {"C": 50.0}, 40.0),
        ((0.0, 90.0, 170.0), (0.0, 90.0, 190.0), {"C": -190.0}, 20.0),  # past a half turn
        # The tool centre point is named, and does not move by more than increments
        ((0.0, 90.0, 0.0), (0.0, 60.0, 0.0), {"X": 600.0006, "Z": 900.0, "B": -30.0}, 30.0),
    ],
)
def test_where_the_tool_of_a_robot_only_turns_its_angles_count_and_not_the_joints(
    begin: tuple[float, ...], end: tuple[float, ...], target: dict[str, float], length_deg: float
) -> None:
    gone, length = wrist_way(begin, end, target)
    assert length == pytest.approx(length_deg, abs=1e-9)
    assert gone == pytest.approx(np.linspace(0.0, length_deg, 5), abs=1e-9)


def test_where_the_tool_moves_its_way_counts_alone() -> None:
    """Joint 1 takes the wrist at 600 mm out by 10 degrees; C10 goes with it."""
    rows = np.linspace((0.0, 0.0, 0.0, 0.0, 90.0, 0.0), (10.0, 0.0, 0.0, 0.0, 90.0, 0.0), 3)
    x, y = 600.0 * math.cos(math.radians(10.0)), 600.0 * math.sin(math.radians(10.0))
    target = {"X": x, "Y": y, "C": 10.0}
    recording, on = observed(WRIST, "XYZABC"), record((45,), "XYZABC")
    gone, length = way_of_tool(recording, on, rows, 0, target)
    chord_mm = 1200.0 * math.sin(math.radians(5.0))
    assert [length, gone[-1]] == pytest.approx([chord_mm, chord_mm], abs=1e-9)


def test_an_axis_beside_the_kinematic_counts_where_the_tool_stays() -> None:
    rows = np.linspace((0.0, 0.0, 0.0, 0.0, 90.0, 0.0, 5.0), (0.0, 0.0, 0.0, 0.0, 120.0, 0.0, 45.0))
    recording, on = observed(WRIST, "XYZABCU"), record((45,), "XYZABC")
    gone, length = way_of_tool(recording, on, rows, 0, {"B": 30.0, "U": 45.0})
    assert [length, gone[-1]] == pytest.approx([50.0, 50.0], abs=1e-9)


@pytest.mark.parametrize("name", ["45", "210 slide first", "210 two slides"])
def test_a_tool_that_turns_about_its_point_goes_as_far_as_its_angles(name: str) -> None:
    """The axes go as the kernel leads them; a slide that moves under the tool counts with them."""
    machine = MACHINES[name]
    kinematic = machine.kernel()
    near = (10.0, 5.0, 15.0, 20.0, 60.0, -10.0, 50.0, -30.0)[: kinematic.count]
    start = kinematic.forward(near)
    ways = (12.0, -9.0, 20.0, 15.0, 8.0)[: kinematic.count - 3]
    end = (*start[:3], *(at + way for at, way in zip(start[3:], ways, strict=True)))
    curve = ToolCurve(Line(start, end), kinematic, near)
    axes = "XYZABCUV"[: kinematic.count]
    target = dict(zip(axes[3:], end[3:], strict=True))
    recording, on = observed(values(machine.text), axes), record(machine.ids, axes, machine.tool_mm)
    gone, length = way_of_tool(recording, on, np.array(curve.places), 0, target)
    assert length == pytest.approx(math.hypot(*ways), abs=1e-6)
    assert gone == pytest.approx(np.linspace(0.0, length, len(gone)), abs=1e-6)


HEAD, TOOL_MM = {"trafo[0].id": 9}, 80.0
INCREMENTS_MM = {"X": 0.1, "Y": 0.2, "Z": 0.4, "C": 5.0, "A": 0.01}


def head_way(
    rows: np.ndarray, begin: int, target: dict[str, float], **increments_mm: float
) -> tuple[list[float], float]:
    """A head with C and A, whose tool points down from the axes."""
    found = {**INCREMENTS_MM, **increments_mm}
    axes = {a: SimpleNamespace(increments_per_mm=1.0 / mm) for a, mm in found.items()}
    recording: Any = SimpleNamespace(facts=SimpleNamespace(channel=HEAD), axes=axes)
    gone, length = way_of_tool(recording, record((9,), "XYZCA", TOOL_MM), rows, begin, target)
    return list(gone), length


@pytest.mark.parametrize(("x_mm", "moves"), [(0.3, False), (0.65, False), (0.7145, False),
                                             (0.7155, True), (5.0, True)])  # fmt: skip
def test_a_tool_stays_within_an_increment_of_every_axis(x_mm: float, moves: bool) -> None:
    """0.1 + 0.2 + 0.4 mm, nothing of C on its own axis, 0.01 degrees of A at the lever of 80 mm,
    and the micrometre that is none: 0.715 mm together.
    """
    assert 0.7 + TOOL_MM * math.radians(0.01) + 1e-3 == pytest.approx(0.71496, abs=1e-5)
    rows = np.linspace((0.0, 0.0, 200.0, 0.0, 0.0), (x_mm, 0.0, 200.0, 0.0, 0.0), 3)
    _, length = head_way(rows, 0, {"X": x_mm, "C": 30.0})
    assert length == pytest.approx(x_mm if moves else 30.0, abs=1e-9)


def test_each_axis_counts_with_its_own_increment() -> None:
    """Fine ones leave the way to the tool, whichever axis alone is coarse."""
    rows = np.zeros((2, 5))
    fine = dict.fromkeys(INCREMENTS_MM, 1e-6)
    for coarse, stays in (("X", True), ("Y", True), ("Z", True), ("A", True), ("C", False)):
        _, length = head_way(rows, 0, {"X": 0.5, "C": 30.0}, **{**fine, coarse: 1.0})
        assert length == pytest.approx(30.0 if stays else 0.5, abs=1e-9), coarse
    assert head_way(rows, 0, {"X": 0.5, "C": 30.0}, **fine)[1] == pytest.approx(0.5)


@pytest.mark.parametrize("begin", [0, 1, 3])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_way_counts_from_the_row_in_which_its_block_begins(begin: int, sign: float) -> None:
    """X goes 2 mm a row and C 7 degrees; rows before it are so far away too."""
    rows = np.zeros((6, 5))
    rows[:, 0], rows[:, 2], rows[:, 3] = sign * 2.0 * np.arange(6), 200.0, sign * 7.0 * np.arange(6)
    place_mm, place_deg = sign * 2.0 * begin, sign * 7.0 * begin
    gone, length = head_way(rows, begin, {"X": place_mm + sign * 50.0, "C": 90.0})
    assert length == pytest.approx(50.0, abs=1e-9)
    assert gone == pytest.approx([2.0 * abs(row - begin) for row in range(6)], abs=1e-9)
    rows[:, 0] = 3.0
    gone, length = head_way(rows, begin, {"X": 3.0, "C": place_deg - 90.0})
    assert length == pytest.approx(90.0, abs=1e-9)
    assert gone == pytest.approx([7.0 * abs(row - begin) for row in range(6)], abs=1e-9)
