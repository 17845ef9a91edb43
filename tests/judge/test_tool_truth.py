"""Truth of 3D distance control from a recording made of formulas (`reports/tilted.py`).

The tool leans by A -35 and C 20 degrees while the control is on, rows 300 to 689; at row 400 the
offset of 1.5 mm is sent, at row 402 the axes are there.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import MS, kept
from tests.reports import tilted
from tests.reports.tilted import AXES, KINEMATIC, OFF, ON, ROWS, STEP, TILTED, direction, left

from axisrig.bench.judge.distance.tool import (
    ToolTruth,
    _first_step,
    choices,
    distance_truth,
    distance_truths,
    first_row,
)
from axisrig.bench.judge.distance.truth import ACTIVE
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.distance.cycles import NotMeasurableError
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.record.distance import PlcSensor
from axisrig.bench.record.facts import Timing
from axisrig.bench.record.kinematics import GuideChange, KinematicRecord

U = direction(np.array([tilted.C_DEG]), np.array([tilted.A_DEG]))[0]
SLOPE_DEG = 20.0
INCLINED = (0.0, math.sin(math.radians(SLOPE_DEG)), math.cos(math.radians(SLOPE_DEG)))


def truth(
    mode: str = "ECS",
    guides: Sequence[GuideChange] | None = None,
    sensor: PlcSensor | None = None,
    columns: dict[str, Any] | None = None,
    without: Sequence[str] = (),
    **changes: Any,
) -> ToolTruth:
    table = tilted.trace(mode=mode)
    for name, values in (columns or {}).items():
        table = table.set_column(table.column_names.index(name), name, pa.array(values))
    of = left(mode)
    assert of.distance_3d is not None
    control = replace(of.distance_3d, guides=tuple(guides or of.distance_3d.guides))
    sensors = {} if sensor is None else {"V.E.SENSOR": sensor}
    of = replace(of, distance_3d=control, plc_sensors=sensors, **changes)
    return ToolTruth(CHANNEL, Observed(of, kept(table.drop_columns(list(without)))))


def test_rows_of_an_instant_and_of_a_kinematic() -> None:
    def on(begin_ns: int, end_ns: int | None) -> KinematicRecord:
        return KinematicRecord(begin_ns, end_ns, AXES[:4], (9,), 80.0)

    # Cycles begin 0.6 ms after their SYNC: the next row is the first one with it
    times = [(50 * MS + 1, 60 * MS), (70 * MS, 70 * MS), (80 * MS, None), (900 * MS, None)]
    observed = truth(kinematics=tuple(on(*each) for each in times)).observed
    assert [first_row(observed, ns) for ns in (0, 5 * MS - 1, 5 * MS, 5 * MS + 1)] == [0, 5, 5, 6]
    found = [(one.begin, one.end, one.count) for one in choices(observed)]
    assert found == [(51, 60, 4), (80, ROWS, 4)]


def test_a_variable_that_nobody_has_written_comes_as_late_as_one_without_delay() -> None:
    """It is in no telegram of a drive: carriers add nothing."""
    assert truth().dead == truth(sensor=PlcSensor("gap", 1, 0)).dead
    assert truth(sensor=PlcSensor("gap", 1, 3)).dead.dead == truth().dead.dead + 3


def test_where_an_offset_acts_holds_until_the_next_choice() -> None:
    guides = [
        GuideChange(0),  # nothing says it yet
        GuideChange(100 * MS, "ACS", "Y"),
        GuideChange(200 * MS, "MCS"),
        GuideChange(200 * MS, "ECS"),  # the later one of a cycle counts
        GuideChange(300 * MS, "ACS", "A"),
    ]
    seen = truth(guides=guides)
    ways = [(since_ns // MS, way.mode, way.axis) for since_ns, way in seen.ways]
    assert ways == [(100, "ACS", 1), (200, "MCS", 0), (200, "ECS", 0), (300, "ACS", 4)]
    for ms, mode in ((0, "ACS"), (199, "ACS"), (200, "ECS"), (299, "ECS"), (300, "ACS")):
        way = seen.way_at(ms * MS)
        assert way is not None
        assert way.mode == mode
    rows = [(way.mode, part.start, part.stop) for way, part in seen.way_rows()]
    assert rows == [("ACS", 0, 200), ("ECS", 200, 300), ("ACS", 300, ROWS)]
    some = [(way.mode, part.start, part.stop) for way, part in seen.way_rows(slice(250, 350))]
    assert some == [("ECS", 0, 50), ("ACS", 50, 100)]
    assert truth(guides=[GuideChange(0)]).way_at(5 * MS) is None


def test_a_way_has_the_kinematic_that_was_on_in_its_cycle() -> None:
    """#TRAFO ON and the choice of the mode may come in one cycle, each at its NC instant."""
    first = KinematicRecord(50 * MS + 600_000, 80 * MS + 600_000, AXES, (9,), 80.0)
    second = KinematicRecord(80 * MS + 600_000, None, AXES[:4], (9, 98), 120.0)
    guides = [GuideChange(50 * MS, "MCS"), GuideChange(79 * MS, "ECS"), GuideChange(80 * MS, "ECS")]
    ways = [way for _, way in truth(guides=guides, kinematics=(first, second)).ways]
    assert [(way.count, way.until_ns) for way in ways] == [(5, 80 * MS), (5, 80 * MS), (4, None)]
    lengths = [way.chain.tool_mm for way in ways if way.chain is not None]
    assert lengths == [80.0, 80.0, 120.0]


@pytest.mark.parametrize("mode", ["ECS", "MCS", "ACS"])
@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), INCLINED])
@pytest.mark.parametrize(
    ("is_along", "is_normalised"), [(False, False), (True, False), (True, True), (False, True)]
)
def test_what_a_control_sees_of_its_offset(
    mode: str, normal: tuple[float, float, float], is_along: bool, is_normalised: bool
) -> None:
    """ECS moves by u/u_z, the others along Z; seen is m w, along the tool m w/m u, times u_z."""
    way = U / U[2] if mode == "ECS" else np.array([0.0, 0.0, 1.0])
    gain = way @ normal / (U @ normal if is_along else 1.0)
    gain *= U[2] if is_along and is_normalised else 1.0
    guides = [GuideChange(KINEMATIC * MS, mode, "Z" if mode == "ACS" else "")]
    sensor = PlcSensor("gap", 1, 0, is_along, is_normalised, normal)
    assert truth(mode, guides, sensor).surface_gain == pytest.approx(gain, rel=1e-6)


def test_without_a_surface_or_a_tool_an_offset_is_seen_as_it_is() -> None:
    along = PlcSensor("gap", 1, 0, True, False, INCLINED)
    acs = [GuideChange(0, "ACS", "Z")]
    never = {"channel.distance_state": np.zeros(ROWS)}
    assert truth(sensor=along).surface_gain != 1.0
    assert truth(sensor=replace(along, normal=None)).surface_gain == 1.0
    assert truth(sensor=None).surface_gain == 1.0
    assert truth(sensor=along, columns=never).surface_gain == 1.0
    # One axis moves, and no kinematic is on in the last row of the control
    for end_ns, is_known in (((OFF - 1) * MS, False), (OFF * MS, True), (None, True)):
        on = (replace(left().kinematics[0], end_ns=end_ns),)
        found = truth("ACS", acs, along, kinematics=on).surface_gain
        assert (found != 1.0) is is_known


def test_how_the_true_distance_grows_is_taken_from_the_plant_while_the_control_is_on() -> None:
    """The axes rise by 1.5 mm at row 402: the gap grows by less where a plant yields."""
    gap_mm = tilted.trace(mode="MCS")["gap.distance_true_mm"].to_numpy().copy()
    gap_mm[STEP + 2 :] -= 0.3
    sensor = PlcSensor("gap", 1, 0, False, False, INCLINED)
    columns = {"gap.distance_true_mm": gap_mm}
    seen = truth("MCS", sensor=sensor, columns=columns)
    assert seen.gap_gain == pytest.approx((1.5 - 0.3) / 1.5)
    # Nothing moves while it is on, or no plant gives the distance: by the surface
    at = np.arange(ROWS)
    late = np.where((at >= STEP + 3) & (at < OFF), 4.0, 0.0)
    for other in (
        truth("MCS", sensor=sensor, columns={**columns, "channel.distance_state": late}),
        truth("MCS", sensor=sensor, without=["gap.distance_true_mm"]),
    ):
        assert other.gap_gain == pytest.approx(INCLINED[2])


def test_how_the_true_distance_grows_is_the_usual_share_of_its_moves_up_and_down() -> None:
    """Of three moves two show 0.8; the third one is a workpiece that has moved meanwhile."""
    at = np.arange(ROWS)
    for steps in ((1.0, -0.5, 2.0), (-1.0, -2.0, 0.7)):
        rows = (STEP + 50, STEP + 100, STEP + 150)
        moves_mm = sum(mm * (at >= row) for mm, row in zip(steps, rows, strict=True))
        still_mm = {f"{name}.truth_mm": 0.0 * at for name in "XY"}
        columns = {**still_mm, "Z.truth_mm": 500.0 + moves_mm,
                   "gap.distance_true_mm": 0.8 * moves_mm + 9.0 * (at >= rows[2])}  # fmt: skip
        found = truth("MCS", sensor=PlcSensor("gap", 1, 0), columns=columns)
        assert found.gap_gain == pytest.approx(0.8)
    down = {**columns, "gap.distance_true_mm": 0.6 * moves_mm}
    assert truth("MCS", sensor=PlcSensor("gap", 1, 0), columns=down).gap_gain == pytest.approx(0.6)


LIMITS = {"X": (50.0, 4000.0), "Y": (80.0, 900.0), "Z": (200.0, 5000.0), "C": (1.0, 1.0),
          "A": (1.0, 1.0)}  # fmt: skip


def limited(mode: str, guides: Sequence[GuideChange] | None = None) -> ToolTruth:
    """vb_eilgang in um/s, a_max in mm/s2."""
    axes = {
        name: replace(
            axis,
            written={
                "getriebe[0].vb_eilgang": round(1e3 * LIMITS[name][0]),
                "getriebe[0].dynamik.a_max": round(LIMITS[name][1]),
            },
        )
        for name, axis in left().axes.items()
    }
    return truth(mode, guides, axes=axes)


def test_an_offset_may_be_as_fast_as_the_slowest_of_the_axes_that_it_moves() -> None:
    """Along u by 1/u_z for each mm; axes that do not move with it do not count."""
    rates = np.abs(U / U[2])
    speed, acceleration = (
        min(LIMITS[axis][k] / rate for axis, rate in zip("XYZ", rates, strict=True)) for k in (0, 1)
    )
    found = limited("ECS").axes_allow(ON, ON + 50)
    assert found is not None
    assert found.shape == (50, 2)
    assert found == pytest.approx(np.tile([speed, acceleration], (50, 1)), rel=1e-4)
    along_z = limited("MCS").axes_allow(ON, ON + 5)
    assert along_z == pytest.approx(np.tile(LIMITS["Z"], (5, 1)), rel=1e-4)
    one = [GuideChange(0, "ACS", "Z")]
    assert limited("ACS", one).axes_allow(ON, ON + 5) is None


@pytest.mark.long
def test_the_pose_of_the_cycle_before_says_how_the_axes_go() -> None:
    """While the tool tilts from row 51 on; the first row of a run has its own pose."""
    guides = [GuideChange(0, "ECS")]
    kinematic = replace(left().kinematics[0], begin_ns=0)
    seen = limited("ECS", guides)
    seen = ToolTruth(
        CHANNEL,
        Observed(replace(seen.observed.facts, kinematics=(kinematic,)), seen.observed.series),
    )
    begin, end = KINEMATIC, TILTED
    found = seen.axes_allow(begin, end)
    assert found is not None
    share = np.clip((np.arange(begin - 1, end - 1) - KINEMATIC) / (TILTED - KINEMATIC), 0, 1)
    u = direction(share * tilted.C_DEG, share * tilted.A_DEG)
    with np.errstate(divide="ignore"):
        speeds = np.array([LIMITS[axis][0] for axis in "XYZ"]) / np.abs(u / u[:, 2:])
    assert found[:, 0] == pytest.approx(np.min(speeds, axis=1), rel=1e-3)
    start = seen.axes_allow(0, end)
    assert start is not None
    assert start[: begin + 1] == pytest.approx(np.tile(LIMITS["Z"], (begin + 1, 1)), rel=1e-4)
    assert start[begin:, 0] == pytest.approx(np.min(speeds, axis=1), rel=1e-3)


@pytest.mark.parametrize(
    ("sensor", "shifts", "row"),
    [
        ([0, 0, 0, 0, 100, 100], [], 4),
        ([0, 0, 0, 21, 21, 21], [], 3),
        ([0, 0, 0, 20, 20, 20], [], None),  # as small as noise
        ([0, 0, 50, 50, 50, 50, 100], [], 6),  # not quiet for 3 cycles before the first one
        ([0, 0, 0, 50, 50, 50, 50, 99], [(1, 0.1)], 7),  # the offset moved shortly before
        ([0, 0, 0, 50, 50, 50, 50, 99], [(1, 0.0009)], 3),
        ([0, 0, 0, -50], [], 3),
        ([0, 15, -15, 50, 50], [], None),  # restless
        ([0, 20, 0, 50, 50], [], 3),  # within noise
        ([0, 21, 0, 50, 50], [], None),
        ([0, 0, 0, 0, 50, 0, 0, 0, -50], [(2, -0.1)], 8),  # of any axis, either way
    ],
)
def test_dead_cycles_are_counted_from_a_step_that_comes_out_of_quiet(
    sensor: list[int], shifts: list[tuple[int, float]], row: int | None
) -> None:
    superposed = np.zeros((len(sensor), 2))
    for since, mm in shifts:
        superposed[since:, 1] = mm
    if row is None:
        with pytest.raises(NotMeasurableError, match="never stepped"):
            _first_step(np.array(sensor), superposed)
    else:
        assert _first_step(np.array(sensor), superposed) == row


def test_the_control_of_the_channel_counts_where_it_was_on() -> None:
    def observed(is_on: bool, states: dict[str, float]) -> Observed:
        table = tilted.trace()
        for axis, state in states.items():
            table = table.append_column(f"{axis}.offset_mm", pa.array(np.zeros(ROWS)))
            table = table.append_column(f"{axis}.distance_state", pa.array(np.full(ROWS, state)))
        if not is_on:
            name = "channel.distance_state"
            zeros = pa.array(np.zeros(ROWS))
            table = table.set_column(table.column_names.index(name), name, zeros)
        return Observed(replace(left(), timing=Timing(MS, 600_000, 0)), kept(table))

    def found(seen: Observed) -> tuple[str, list[str]]:
        chosen = distance_truth(seen, None)
        assert chosen is not None
        return chosen.axis, [truth.axis for truth in distance_truths(seen)]

    assert found(observed(True, {"Z": 4.0})) == (CHANNEL, ["Z", CHANNEL])
    assert found(observed(True, {"X": 0.0, "Z": 4.0})) == (CHANNEL, ["Z", CHANNEL])
    assert found(observed(False, {"X": 0.0, "Z": 4.0})) == ("X", ["Z"])
    assert found(observed(False, {})) == (CHANNEL, [])
    both = observed(True, {"Z": 4.0})
    named = [distance_truth(both, axis) for axis in ("Z", "X", CHANNEL)]
    assert [None if one is None else one.axis for one in named] == ["Z", None, CHANNEL]


def test_of_an_inclined_tool_a_constant_distance_is_shorter() -> None:
    """A tool of 80 mm on the surface is 80 cos 35 above it: SET_DIST (1 - cos 35) less."""
    at = np.arange(ROWS)
    table = tilted.trace()
    own = {"set_dist_mm": 60.0 + 0 * at, "sensor_mm": 5.0 + 0 * at, "distance_cnc_mm": 7.0 + 0 * at}
    for name, values in own.items():
        table = table.append_column(f"channel.{name}", pa.array(values))
    seen = ToolTruth(CHANNEL, Observed(left(), kept(table)))
    less_mm = 60.0 * (1.0 - math.cos(math.radians(35.0)))
    rows = slice(ON, OFF)
    assert seen.shorter_mm[rows] == pytest.approx(less_mm)
    assert seen.read_mm("SET_POS")[rows] == pytest.approx(-5.0)
    assert seen.read_mm("CONST_DIST")[rows] == pytest.approx(-5.0 - less_mm)
    assert seen["distance_cnc_mm"][rows] == pytest.approx(7.0 + less_mm)
    state = np.where((at >= ON) & (at < OFF), float(ACTIVE), 0.0)
    name = "channel.distance_state"
    by_surface = table.set_column(table.column_names.index(name), name, pa.array(state))
    other = ToolTruth(CHANNEL, Observed(left(), kept(by_surface)))
    assert other.shorter_mm[rows] == pytest.approx(0.0)


def test_before_a_mode_is_chosen_no_tool_is_inclined() -> None:
    """The whole SET_DIST counts, and the clamping point has no place along a normal."""
    columns = {"channel.distance_state": np.zeros(ROWS)}
    seen = truth(guides=[GuideChange(0)], columns=columns)
    assert seen.ways == []
    assert seen.share.tolist() == [1.0] * ROWS
    assert seen.program_mm.tolist() == [0.0] * ROWS


def test_after_ref_the_sensor_has_its_zero_at_the_gap_that_the_plant_has_there() -> None:
    """Twice on, and each time with another zero: 3.25 mm, then 1.5 mm the other way."""
    at = np.arange(ROWS)
    is_on = (at >= ON) & (at < OFF) & ((at < 500) | (at >= 520))
    table = tilted.trace()
    gap_mm = table["gap.distance_true_mm"].to_numpy()
    given = pa.array(gap_mm - np.where(at < 510, 3.25, -1.5))
    name = "channel.distance_state"
    table = table.set_column(table.column_names.index(name), name, pa.array(np.where(is_on, 4, 0)))
    table = table.append_column("channel.sensor_mm", given)
    of = left()
    assert of.distance_3d is not None
    ref = replace(of, distance_3d=replace(of.distance_3d, is_referenced=True))
    seen = ToolTruth(CHANNEL, Observed(ref, kept(table)))
    assert seen.zeros == [(ON, pytest.approx(3.25)), (520, pytest.approx(-1.5))]
    assert seen.zero_mm == pytest.approx(-1.5)
    assert ToolTruth(CHANNEL, Observed(of, kept(table))).zeros == []  # no REF
