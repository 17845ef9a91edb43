"""Columns of the PLC side that act on one axis."""

import pytest

from axisrig.bench.plan.assignment import parse_column
from axisrig.bench.rig.plc.axis_words import (
    AxisFeedhold,
    ObjectChange,
    ProbingWrite,
    SetCourse,
    UnitWrite,
    axis_columns,
)
from axisrig.bench.rig.plc.channel_words import Feedhold
from axisrig.bench.rig.plc.override import OverrideCourse
from axisrig.bench.rig.plc.words import Moment, Rule, read_rules
from axisrig.kernel.distance import DistanceCommand
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS


def rules(column: str, cell: str) -> list[Rule]:
    _, found = read_rules(parse_column(f"plc:{column}", cell), ["X", "Z"])
    return found


def test_every_column_of_the_table_is_read_as_its_example_is_written() -> None:
    names = {name: name.replace("<name>", "DIST_CTRL::kp") for name in axis_columns()}
    for name, row in axis_columns().items():
        found = rules(f"Z.{names[name]}", row.cell)
        assert len(found) == row.cell.count(";") + 1


def test_commands_of_distance_control_have_their_set_values() -> None:
    on, off = rules("Z.dist_ctrl", "ON set_pos=30 at=200ms; OFF at=M51 nth=2")
    assert on.action == UnitWrite("Z", DistanceCommand.ON, set_pos_mm=30.0)
    assert on.moment == Moment("start", None, 200 * MS)
    assert off.action == UnitWrite("Z", DistanceCommand.OFF)
    assert (off.moment, off.nth) == (Moment("M51"), 2)


def test_a_probing_signal_goes_up_and_down_and_a_position_is_a_number() -> None:
    up, down = rules("Z.probing_signal", "1 at=M50; 0 at=M51+2ms")
    assert (up.action, down.action) == (
        ProbingWrite("Z", level=True),
        ProbingWrite("Z", level=False),
    )
    assert (up.moment, down.moment) == (Moment("M50"), Moment("M51", None, 2 * MS))
    (place,) = rules("X.probing_position", "-12.5")
    assert place.action == ProbingWrite("X", position_mm=-12.5)


@pytest.mark.parametrize("cell", ["2", "-1", "true", "ON", "1.0", "01", "0x1", "0;2 at=M50"])
def test_a_probing_signal_has_two_levels(cell: str) -> None:
    with pytest.raises(UserError, match="a signal has two levels") as caught:
        rules("Z.probing_signal", cell)
    assert caught.value.allowed == "0, 1"
    assert caught.value.value == cell.rsplit(";", maxsplit=1)[-1].split(maxsplit=1)[0]


@pytest.mark.parametrize("column", ["probing_signal", "probing_position", "set_pos", "set_dist"])
@pytest.mark.parametrize(("cell", "found"), [("at=M50", "nothing"), ("1 0 at=M50", "1 0")])
def test_a_cell_has_one_value(column: str, cell: str, found: str) -> None:
    with pytest.raises(UserError, match="one value and its keys") as caught:
        rules(f"Z.{column}", cell)
    assert caught.value.value == found


def test_a_set_value_moves_over_a_time_or_is_there_at_once() -> None:
    first, second = rules("X.set_dist", "1; 2.5 at=400ms over=200ms")
    assert first.action == SetCourse("X", "set_dist_mm", 1.0)
    assert second.action == SetCourse("X", "set_dist_mm", 2.5, 200 * MS)


def test_a_feedhold_lasts_for_a_time_or_until_a_moment() -> None:
    (path,) = rules("feedhold", "at=M50 until=M51+5ms")
    assert (path.action, path.until) == (Feedhold(None), Moment("M51", None, 5 * MS))
    first, second = rules("Z.feedhold", "at=1ms for=2ms; at=4ms until=9ms")
    assert (first.action, first.until) == (AxisFeedhold("Z", 2 * MS), None)
    assert second.action == AxisFeedhold("Z", None)
    assert second.until == Moment("start", None, 9 * MS)


def test_override_and_object() -> None:
    assert [r.action for r in rules("Z.override", "0 at=1ms; 99.9 at=2ms over=30ms")] == [
        OverrideCourse("Z", 0),
        OverrideCourse("Z", 999, 30 * MS),
    ]
    (change,) = rules("Z.object.DIST_CTRL::kp", "0.3 at=4ms")
    assert change.action == ObjectChange("Z", "DIST_CTRL::kp", 0.3)


@pytest.mark.parametrize(
    ("column", "cell", "says"),
    [
        ("Z.dist_ctrl", "ONN", "no such command"),
        ("Z.dist_ctrl", "at=M50", "one value and its keys"),
        ("Z.dist_ctrl", "ON set_pos=high", "set_pos"),
        ("Z.dist_ctrl", "ON over=2ms", "no such key"),
        ("Z.set_dist", "1 over=2", "over: how long it lasts"),
        ("Z.override", "101", "override: percent in steps of 0.1"),
        ("Z.override", "-1", "override: percent"),
        ("Z.override", "0.05", "override: percent"),
        ("Z.override", "half", "not a number"),
        ("Z.override", "50 over=0ms", "over: how long it lasts"),
        ("Z.feedhold", "1 at=2ms", "a feedhold has no value"),
        ("Z.feedhold", "at=2ms", "for: how long it lasts"),
        ("Z.feedhold", "at=2ms for=1ms until=M50", "`for` or `until`"),
        ("Z.feedhold", "at=2ms until=M5O", "until: no moment of a run"),
        ("Z.object.DIST_CTRL::kq", "0.3", "no CNC object"),
        ("Z.object.DIST_CTRL::m_actual_offset", "1", "can only be read"),
        ("Z.object.DIST_CTRL::kp", "3", "kp"),
        ("Y.dist_ctrl", "ON", "no such axis"),
        ("Z.distctrl", "ON", "no such object"),
    ],
)
def test_what_cannot_be_is_refused_in_words(column: str, cell: str, says: str) -> None:
    with pytest.raises(UserError) as caught:
        rules(column, cell)
    assert says in str(caught.value)


@pytest.mark.parametrize("name", axis_columns())
@pytest.mark.parametrize("cell", ["1 2 at=M50", "at=M50"])
def test_a_cell_of_two_values_or_of_none_is_shown_the_example_of_its_own_column(
    name: str, cell: str
) -> None:
    column = f"Z.{name.replace('<name>', 'DIST_CTRL::kp')}"
    if name == "feedhold":  # which has no value and a time
        cell = "1 at=M50 for=2ms"
    with pytest.raises(UserError) as caught:
        rules(column, cell)
    example = "at=400ms for=300ms" if name == "feedhold" else axis_columns()[name].cell
    assert caught.value.allowed == example
    assert axis_columns()[name].cell.startswith(example)
