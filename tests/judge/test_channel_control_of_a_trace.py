"""3D distance control of a recording: what it reads, is to hold, how old it is, what it answers."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import MS, kept
from tests.reports import tilted
from tests.reports.tilted import AXES, OFF, ON, ROWS, STEP, left

from axisrig.bench.judge.distance.tool import ToolTruth, axes_of
from axisrig.bench.judge.distance.truth import ACTIVE, ACTIVE_CONST_DIST, TURNING_OFF
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.oracles.distance.cycles import NotMeasurableError
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.axes import PlantRecord, PlantValue
from axisrig.bench.record.distance import PlcSensor
from axisrig.bench.record.facts import Facts

AT = np.arange(ROWS)
SHOWN_MM = {"sensor_mm": 0.0 * AT, "set_dist_mm": 60.0 + 0 * AT}


def truth(columns: dict[str, Any] | None = None, of: Facts | None = None) -> ToolTruth:
    """columns: of the channel; those that the recording has are replaced."""
    table = tilted.trace()
    for name, values in {**SHOWN_MM, **(columns or {})}.items():
        column = name if "." in name else f"{CHANNEL}.{name}"
        if column in table.column_names:
            table = table.drop_columns([column])
        table = table.append_column(column, pa.array(values))
    return ToolTruth(CHANNEL, Observed(of or left(), kept(table)))


def with_axes(**changes: dict[str, Any]) -> Facts:
    of = left()
    axes = {name: replace(axis, **changes.get(name, {})) for name, axis in of.axes.items()}
    return replace(of, axes=axes)


# What it is to hold


def test_the_gap_that_is_wanted_is_over_the_tool_or_over_the_surface() -> None:
    """SET_DIST cos 35, which an inclined tool is nearer; or where the program was, less SET_POS."""
    constant = truth().wanted_gap_mm
    assert constant[ON + 2 : OFF] == pytest.approx(60.0 * math.cos(math.radians(35.0)))
    state = np.where((AT >= ON) & (AT < OFF), float(ACTIVE), 0.0)
    surface = truth({"distance_state": state, "set_pos_mm": 12.0 + 0.01 * AT})
    program_mm = surface.program_mm
    rows = slice(ON + 2, OFF)
    wanted = program_mm[ON : OFF - 2] - (12.0 + 0.01 * AT[rows])
    assert surface.wanted_gap_mm[rows] == pytest.approx(wanted)
    # Before the first cycle of the demand the program stood where it began
    assert surface.wanted_gap_mm[0] == pytest.approx(program_mm[0] - 12.0)


@pytest.mark.parametrize("offset", [0, 25_000, -5000])
def test_without_ref_the_sensor_value_is_0_at_the_offset_of_the_list(offset: int) -> None:
    """Of the channel it counts as the distance does: upwards (P-CHAN-00805, in 0.1 um)."""
    of = left()
    of = replace(of, channel={**of.channel, "dist_ctrl[0].ref_offset": offset})
    tool, plain = truth(of=of), truth()
    assert tool.zero_mm == pytest.approx(offset / 1e4)
    assert tool.wanted_gap_mm[ON:OFF] == pytest.approx(plain.wanted_gap_mm[ON:OFF] + offset / 1e4)


# How old its values are


@pytest.mark.parametrize(
    ("late", "fresh", "delay", "late_cycles", "age"),
    [
        ({}, {}, 0, 0, 0),
        ({}, {}, 2, 0, 2),
        ({"X": 1, "Z": 3, "A": 2}, {}, 0, 3, -3),  # 6064 of the latest axis is older
        ({"X": 1, "Z": 3, "A": 2}, {"X": 1, "Z": 1}, 0, 3, -2),
        ({"Y": 2}, {"Y": 2}, 1, 2, 1),
    ],
)
def test_the_latest_axis_says_how_old_a_value_of_the_plc_is_beside_the_positions(
    late: dict[str, int], fresh: dict[str, int], delay: int, late_cycles: int, age: int
) -> None:
    changes = {
        name: {"late_cycles": late.get(name, 0), "fresh_late_cycles": fresh.get(name, 0)}
        for name in AXES
    }
    of = with_axes(**changes)
    of = replace(of, plc_sensors={"V.E.SENSOR": PlcSensor("gap", 1, delay)})
    tool = truth(of=of)
    assert (tool.late_cycles, tool.sensor_age_cycles) == (late_cycles, age)
    assert (tool.every, tool.sensor_name) == (1, "gap")


@pytest.mark.parametrize(("sign", "is_right"), [(1, True), (-1, False)])
def test_a_value_of_the_channel_grows_when_the_tool_lifts(sign: int, is_right: bool) -> None:
    of = replace(left(), plc_sensors={"V.E.SENSOR": PlcSensor("gap", sign, 0)})
    assert truth(of=of).counts_right is is_right
    bare = truth(of=replace(left(), plc_sensors={}))
    assert (bare.counts_right, bare.sensor_name) == (True, "")


@pytest.mark.parametrize("first", ["x", "z"])
def test_the_loops_of_the_first_drive_that_has_some_are_those_of_the_control(first: str) -> None:
    """Of two plants with values one follows its set position at once: it has no gain."""
    plants = {
        "x": PlantRecord({"mass": PlantValue(5.0)}),
        "y": PlantRecord(),
        "z": PlantRecord({"mass": PlantValue(7.0), "kv": PlantValue(40.0)}),
    }
    names = [first, *(name for name in plants if name != first)]
    tool = truth(of=replace(left(), plants={name: plants[name] for name in names})).values
    assert tool is not None
    assert tool.get("mass") == 7.0
    bare = truth(of=replace(left(), plants={name: plants[name] for name in "yx"})).values
    assert bare is not None
    assert bare.get("mass") == 5.0
    assert truth(of=replace(left(), plants={"y": plants["y"]})).values is None


# Its answer to a step


def stepped(seen_row: int, shown_row: int, size_mm: float = 1.5) -> dict[str, Any]:
    """The sensor value steps, and back when the axes are there; 0.5 um of noise beside it."""
    sensor = np.where((seen_row <= AT) & (shown_row > AT), size_mm, 0.0) + 0.0005 * (AT % 2)
    return {"sensor_mm": sensor}


@pytest.mark.parametrize(("reaction", "way"), [(0, 2), (1, 2), (3, 4)])
@pytest.mark.parametrize("size_mm", [1.5, -1.5])
def test_dead_cycles_are_from_the_value_that_steps_to_the_one_that_shows_the_answer(
    reaction: int, way: int, size_mm: float
) -> None:
    """The offset is sent with the set positions of row 400."""
    found = truth(stepped(STEP - reaction, STEP + way, size_mm)).measured_dead()
    assert (found.cycles.reaction, found.cycles.way) == (reaction, way)
    assert found.seen_ns == (STEP - reaction) * MS
    assert found.shown_ns == (STEP + way) * MS


@pytest.mark.parametrize("size_mm", [0.003, -0.003])
@pytest.mark.parametrize("way_mm", [1.5, -1.5])
def test_a_step_just_above_the_noise_and_an_answer_either_way_have_dead_cycles(
    size_mm: float, way_mm: float
) -> None:
    """2 um are noise. The offset moves Z alone, up or down."""
    moved = {f"{name}.superposed_mm": np.zeros(ROWS) for name in "XY"}
    moved["Z.superposed_mm"] = np.where((AT >= STEP) & (AT < OFF), way_mm, 0.0)
    found = truth({**stepped(STEP - 1, STEP + 2, size_mm), **moved}).measured_dead()
    assert (found.cycles.reaction, found.cycles.way) == (1, 2)


def test_a_value_that_is_not_there_yet_is_no_step() -> None:
    """The PLC gives none for 21 cycles after ON; it counts as 0, as the first one that comes."""
    late = stepped(STEP - 1, STEP + 2)["sensor_mm"]
    late[ON - 5 : ON + 21] = np.nan
    found = truth({"sensor_mm": late}).measured_dead()
    assert (found.cycles.reaction, found.cycles.way) == (1, 2)


def metric(name: str, tool: ToolTruth) -> Observation:
    return observe(tool.observed, parse_check(name, "> -1e9", ""))


@pytest.mark.parametrize(("reaction", "way"), [(0, 2), (1, 2), (3, 4), (2, 1), (0, 1)])
def test_measured_dead_cycles_have_a_note_of_their_own_parts(reaction: int, way: int) -> None:
    """n = reaction + way - 1; the rig expects the parts of its own scheduling beside them."""
    tool = truth(stepped(STEP - reaction, STEP + way))
    found = metric("distance_dead_cycles", tool)
    assert (found.value, found.note) == (
        reaction + way - 1, f"reaction {reaction}, way {way} cycles",
    )  # fmt: skip
    # From the SYNC that shows the step to that which shows the answer; cycles of 1 ms
    dead_ms = metric("distance_dead_time_ms", tool)
    assert (dead_ms.value, dead_ms.note) == (reaction + way, "ends of frames on the bus")


@pytest.mark.parametrize(("reaction", "way"), [(0, 2), (3, 4)])
@pytest.mark.parametrize("delay", [0, 1, 3])
def test_expected_dead_cycles_have_the_parts_of_the_rig_whatever_is_measured(
    reaction: int, way: int, delay: int
) -> None:
    """A value that is older by some cycles shows the answer by so many later."""
    of = replace(left(), plc_sensors={"V.E.SENSOR": PlcSensor("gap", 1, delay)})
    plain = truth().dead
    tool = truth(stepped(STEP - reaction, STEP + way), of)
    found = metric("distance_dead_cycles_expected", tool)
    assert (found.value, found.note) == (
        plain.dead + delay, f"reaction {plain.reaction}, way {plain.way + delay} cycles",
    )  # fmt: skip
    assert metric("distance_dead_cycles", tool).value == reaction + way - 1


def test_a_step_before_the_control_is_on_or_without_it_shows_nothing() -> None:
    with pytest.raises(NotMeasurableError, match="never stepped"):
        truth(stepped(ON - 20, ON - 10)).measured_dead()
    off = {**stepped(STEP - 1, STEP + 2), "distance_state": np.zeros(ROWS)}
    with pytest.raises(NotMeasurableError, match="never on"):
        truth(off).measured_dead()
    small = truth(stepped(STEP - 1, STEP + 2, 0.0015))
    with pytest.raises(NotMeasurableError, match="never stepped"):
        small.measured_dead()


# Rows


def test_columns_are_of_every_axis_in_the_order_of_the_rig() -> None:
    tool = truth()
    table = tilted.trace()
    units = {name: "deg" if name in "CA" else "mm" for name in AXES}
    for column in ("set_mm", "truth_mm"):
        whole = np.stack(
            [table[f"{n}.{column.replace('mm', units[n])}"].to_numpy() for n in AXES], axis=1
        )
        assert np.array_equal(axes_of(tool.observed, column), whole)
        some = axes_of(tool.observed, column, slice(60, 63))
        assert np.array_equal(some, whole[60:63])
    superposed = axes_of(tool.observed, "superposed_mm")
    assert tool.base == pytest.approx(axes_of(tool.observed, "set_mm") - superposed)
    # The clamping point of the program is without the offset, where it was sent is with it
    rise = tool["set_mm"] - tool.program_mm
    assert rise[STEP:OFF] == pytest.approx(1.5)
    assert rise[ON:STEP] == pytest.approx(0.0)
    assert tool.state[ON] == ACTIVE_CONST_DIST


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("row", "speed_mm_s", "acceleration_mm_s2"),
    [
        (ON - 2, 0.0, 0.0),
        (ON - 1, 0.0, 0.5e6),  # the next row, which is on, has the speed 0 again
        (ON, 500.0, 0.5e6),
        (OFF - 1, 500.0, 0.5e6),
        (OFF, 500.0, 0.5e6),  # it runs out
        (OFF + 5, 500.0, 0.0),  # its last step comes in the row that is off
        (OFF + 6, 0.0, 0.0),
    ],
)
def test_what_is_superposed_has_its_speed_in_every_row_with_the_control_on(
    row: int, speed_mm_s: float, acceleration_mm_s2: float, sign: float
) -> None:
    """0.5 mm in one cycle, of Y alone; the offset runs out in five rows."""
    state = np.where((AT >= ON) & (AT < OFF), ACTIVE_CONST_DIST, 0.0)
    state[OFF : OFF + 5] = TURNING_OFF
    flat = {f"{name}.superposed_mm": np.zeros(ROWS) for name in "XZ"}
    columns = {"Y.superposed_mm": np.where(row <= AT, 0.5 * sign, 0.0), **flat}
    observed = truth({"distance_state": state, **columns}).observed
    names = ("mm", "speed_mm_s", "acceleration_mm_s2")
    for axis, share in (("Y", 1.0), ("X", 0.0)):
        checks = [parse_check(f"superposed_{name}_max:{axis}", "> -1", "") for name in names]
        found = [observe(observed, check).value for check in checks]
        assert found == pytest.approx([share * 0.5, share * speed_mm_s, share * acceleration_mm_s2])
