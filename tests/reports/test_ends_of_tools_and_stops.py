"""Tools and stops at their ends: a second stretch, states, readings that are none, the last row."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.reports import tilted
from tests.reports.short_stops import at, stop, trace
from tests.reports.test_scene_of_a_tool import along
from tests.reports.test_scene_of_a_tool import motion as made
from tests.reports.test_words_of_a_stop import answers_of

from axisrig.bench.judge.run_findings import RunFindings
from axisrig.reports.distance.signals import STATES
from axisrig.reports.fixed_stop.signals import shortfall, value_at
from axisrig.reports.kinematics.motion import Motion, motion_of
from axisrig.reports.kinematics.scene import at_work, path_direction
from axisrig.reports.kinematics.signals import plots

MS = tilted.MS
ECS = tilted.trace()
TOOL = tilted.tool(ECS, tilted.left())


def motion(table: pa.Table = ECS, tool: Any = TOOL) -> Motion:
    found = motion_of(table, tool)
    assert found is not None
    return found


def with_column(name: str, values: Sequence[float] | Any) -> pa.Table:
    place = ECS.column_names.index(name)
    return ECS.set_column(place, name, pa.array(np.asarray(values, np.float64)))


# The tool of a kinematic


def stretches(*ends_ms: tuple[int, int]) -> Any:
    (one,) = TOOL.kinematics
    return replace(TOOL, kinematics=[
        replace(one, end_ns=end * MS,
                record=replace(one.record, begin_ns=begin * MS, end_ns=end * MS),
                limits={f"HD{number}": 10.0 * number})
        for number, (begin, end) in enumerate(ends_ms, 1)
    ])  # fmt: skip


def test_a_kinematic_that_was_on_twice_has_the_motion_of_both_times() -> None:
    """A row at the end of a stretch is none of it."""
    found = motion(tool=stretches((100, 120), (300, 330)))
    assert found.times_ns.tolist() == [ms * MS for ms in (*range(100, 120), *range(300, 330))]
    whole = motion()
    rows = np.isin(whole.times_ns, found.times_ns)
    for name in ("clamp_mm", "tcp_mm", "tilt_deg", "length_mm", "is_on", "offset_mm", "moved_mm"):
        assert np.array_equal(getattr(found, name), getattr(whole, name)[rows], equal_nan=True)


def test_limits_of_every_time_that_a_kinematic_was_on_are_drawn() -> None:
    found = plots(ECS, RunFindings(of_topics=[stretches((100, 120), (300, 330))])).limits
    assert [(each["label"], each["value"]) for each in found] == [("HD1", 10.0), ("HD2", 20.0)]


@pytest.mark.parametrize("state", STATES)
def test_a_control_is_on_in_every_state_but_one(state: str) -> None:
    """FCT-M3 figure 54: INACTIVE is the one in which nothing is controlled."""
    found = motion(with_column("channel.distance_state", [STATES.index(state)] * tilted.ROWS))
    assert set(found.is_on.tolist()) == {state != "INACTIVE"}


def test_the_programmed_path_has_no_offset() -> None:
    """The tip is sent along Y alone; with the offset it would rise by 1.5 mm and more."""
    found = motion()
    assert np.abs(found.programmed_mm[:, [0, 2]]).max() < 1e-9
    assert np.abs(found.offset_mm).max() == pytest.approx(tilted.OFFSET_MM)


@pytest.mark.parametrize("name", ["A.superposed_deg", "A.superposed_mm"])
def test_what_turns_the_tool_beside_the_program_moves_its_tip(name: str) -> None:
    """5 degrees around a pivot that is 180 mm away: a chord of 2 * 180 sin 2.5; -35 to -30 degrees.

    Older recordings have it under the name of a length. The programmed path is without it.
    """
    still, on = tilted.trace(offset_mm=0.0), np.arange(tilted.ROWS) >= tilted.STEP
    columns = {one: np.asarray(still[one]) for one in still.column_names if one[:6] != "A.supe"}
    columns |= {name: 5.0 * on, "A.set_deg": columns["A.set_deg"] + 5.0 * on}
    for offset_mm in (1.5, -1.5):
        columns["channel.offset_mm"] = offset_mm * on
        found = motion(pa.table(columns))
        is_later = found.times_ns >= tilted.STEP * MS
        way = 2 * (tilted.LEVER_MM + tilted.TOOL_MM) * math.sin(math.radians(2.5))
        assert found.moved_mm[is_later] == pytest.approx(math.copysign(way, offset_mm))
        assert (found.moved_mm[~is_later] == 0.0).all()
        assert found.programmed_mm == pytest.approx(motion(still).programmed_mm, abs=1e-9)


def test_a_reading_that_is_not_valid_meets_nothing() -> None:
    """Neither a place of the beam nor a distance; where the tool is, is known all the same."""
    valid = np.ones(tilted.ROWS)
    valid[400:410] = 0.0
    found, all_valid = motion(with_column("gap.valid", valid)), motion()
    missed = (found.times_ns >= 400 * MS) & (found.times_ns < 410 * MS)
    for name in ("distance_mm", "along_mm", "depth_mm"):
        assert np.isnan(getattr(found, name)[missed]).all(), name
        assert np.isfinite(getattr(found, name)[~missed]).all(), name
    assert np.isnan(found.hit_mm[missed]).all()
    assert np.isfinite(found.hit_mm[~missed]).all()
    assert np.array_equal(found.clamp_mm, all_valid.clamp_mm)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_approach_does_not_change_how_near_a_beam_usually_is(sign: float) -> None:
    """It takes most of the rows, 50 mm away; 0.1 mm is usual then, and three times it still near.

    Where 2 mm are usual, 5 mm are far all the same.
    """
    depth = np.full(100, -50.0)
    depth[60:95], depth[95:97], depth[97:] = 0.1, 0.29, 1.0
    assert np.flatnonzero(at_work(made(depth_mm=sign * depth))).tolist() == [*range(60, 97)]
    depth[60:95], depth[95:97], depth[97:] = 2.0, 4.9, 5.5
    assert np.flatnonzero(at_work(made(depth_mm=sign * depth))).tolist() == [*range(60, 97)]


@pytest.mark.parametrize("begin", [0, 99])
def test_one_place_beside_the_path_does_not_turn_the_view(begin: int) -> None:
    """100 mm along X, and one place that is 30 mm beside it, at the begin or at the end."""
    way = along(100, 100.0, 0.0, 0.0)
    way[begin, 1] = 30.0
    found = path_direction(made(programmed_mm=way))
    assert found is not None
    assert found[0] == pytest.approx(1.0, abs=1e-3)
    far = way + np.array([-500.0, 700.0, 20.0])  # wherever the path is
    assert path_direction(made(programmed_mm=far)) == pytest.approx(found, abs=1e-6)


# Runs to a fixed stop


def test_a_way_that_is_not_known_yet_is_not_the_smallest_one() -> None:
    way = [np.nan if row < 130 else 70.0 - 0.1 * row for row in range(300)]
    lead = [float(row) for row in range(300)]
    found = shortfall(trace(Z__change_um=way, Z__set_mm=lead), stop(), "Z")
    assert found.change_um == pytest.approx(50.0)  # in row 200, the end of the run
    never = shortfall(trace(Z__change_um=[np.nan] * 300, Z__set_mm=lead), stop(), "Z")
    assert never.change_um is None


@pytest.mark.parametrize(
    ("instant_ns", "value"),
    [(-1, None), (0, 7.0), (299_000_000, 306.0), (299_000_001, None), (10**12, None)],
)
def test_a_signal_has_no_value_before_its_first_row_or_after_its_last_one(
    instant_ns: int, value: float | None
) -> None:
    table = trace(Z__truth_mm=[7.0 + row for row in range(300)])
    assert value_at(table, "Z.truth_mm", instant_ns) == value


@pytest.mark.parametrize(
    ("is_found", "touched_ms", "answer"),
    [
        (True, 150, "yes: in contact for 10.0 ms when detected"),
        (True, None, "no: nothing was touched"),
        (False, 150, "yes: in contact for 10.0 ms when detected"),
        (False, None, None),
    ],
)
def test_whether_a_stop_was_there_is_answered_where_one_was_found_or_touched(
    is_found: bool, touched_ms: int | None, answer: str | None
) -> None:
    touched = [] if touched_ms is None else [at("contact", touched_ms, "Z")]
    found = answers_of(stop(*touched, at("detected", 160), is_found=is_found))
    assert found.get("real stop") == answer
