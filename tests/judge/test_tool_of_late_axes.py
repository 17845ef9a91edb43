"""Metrics of a tool whose axes are not where they were sent, reported, or looked for.

The recording is that of `reports/tilted.py`, with the kinematic on until row 600.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.judge.test_channel_control_of_a_trace import stepped, truth
from tests.judge.test_tilts_of_a_tool import LATE
from tests.judge.test_tool_metrics import (
    AT,
    FOLLOWING,
    INACTIVE,
    INCLINED,
    UNTIL,
    U,
    changed,
    seen,
    superposed,
    value,
    way_of,
)
from tests.judge.test_tool_truth import limited
from tests.recordings import MS, kept
from tests.reports import tilted
from tests.reports.tilted import KINEMATIC, LEVER_MM, OFF, ON, ROWS, STEP, TILTED, TOOL_MM

from axisrig.bench.judge.distance import tool_metrics
from axisrig.bench.judge.distance.expected_offset import walk
from axisrig.bench.judge.distance.findings import control_findings
from axisrig.bench.judge.distance.tilting import tilts
from axisrig.bench.judge.distance.truth import ACTIVE
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.distance import DistanceChange, DistanceOrder, PlcSensor
from axisrig.bench.record.kinematics import GuideChange
from axisrig.bench.record.series import SeriesWriter

REACH_MM = LEVER_MM + TOOL_MM


# What a PLC shows


@pytest.mark.parametrize("tilt_deg", [0.0, 3.0])
def test_the_tilt_at_the_end_is_that_of_the_last_row_also_of_an_upright_tool(
    tilt_deg: float,
) -> None:
    tilt = np.where((AT < KINEMATIC) | (AT > 650), np.nan, 35.0)
    tilt[640:651] = tilt_deg
    of = seen(columns={"channel.tilt_deg": tilt, "channel.tool_length_mm": 0.0 * AT})
    assert value(of, "tool_tilt_end_deg") == tilt_deg
    assert value(of, "tool_tilt_deg_max") == 35.0
    assert value(of, "tool_length_end_mm") == 0.0
    upright = seen(columns={"channel.tilt_deg": np.where(AT < KINEMATIC, np.nan, 0.0)})
    assert value(upright, "tool_tilt_deg_max") == 0.0


def leaning(**columns: Any) -> Observed:
    """At 60 degrees the tool is extended: another degree is another length."""
    table = tilted.trace(a_deg=-60.0)
    for name, values in columns.items():
        place = name.replace("__", ".")
        table = table.set_column(table.column_names.index(place), place, pa.array(values))
    return Observed(tilted.left(), kept(table))


def test_the_length_of_a_tool_is_compared_at_the_reported_places_of_the_axes() -> None:
    """80 cos 50/cos 60 mm; what the plant does beside its reports is nothing that a PLC knows."""
    a_deg = tilted.trace(a_deg=-60.0)["A.truth_deg"].to_numpy()
    off = np.where(AT >= 400, a_deg - 1.0, a_deg)
    assert value(leaning(), "tool_length_error_um") == pytest.approx(0.0, abs=1e-6)
    assert value(leaning(A__truth_deg=off), "tool_length_error_um") == pytest.approx(0.0, abs=1e-6)
    longer = (
        TOOL_MM
        * np.cos(np.radians(50.0))
        * (1.0 / np.cos(np.radians(61.0)) - 1.0 / np.cos(np.radians(60.0)))
    )
    found = value(leaning(A__actual_deg=off), "tool_length_error_um")
    assert found == pytest.approx(longer * 1e3, rel=1e-6)


@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
@pytest.mark.parametrize(("column", "error_mm"), [("actual_mm", 0.0), ("truth_mm", 0.25)])
def test_a_plant_is_compared_with_the_chains_at_its_own_places(
    axis: str, column: str, error_mm: float
) -> None:
    found = value(seen(columns=changed(f"{axis}.{column}", r400=0.25)), "kinematic_error_nm")
    assert found == pytest.approx(error_mm * 1e6, abs=1e-3)


# How an offset has moved it


def test_a_tool_that_leans_by_other_than_wanted_is_elsewhere_with_its_tip() -> None:
    """A is 1 degree behind in the last row: the tip is (L + 100) (u(wanted) - u(real)) off."""
    last = UNTIL - 1
    of = seen(mode="MCS", columns=changed("A.truth_deg", **{f"r{last}": 1.0}))
    real = tilted.direction(np.array([tilted.C_DEG]), np.array([tilted.A_DEG + 1.0]))[0]
    shift = REACH_MM * (U - real) + (0.0, -0.1, 1.5)  # two cycles late, and the offset
    found = [value(of, f"tool_offset_{letter}_mm") for letter in "xyz"]
    assert found == pytest.approx(shift.tolist(), abs=1e-9)
    assert value(of, "tool_offset_path_mm") == pytest.approx(float(np.linalg.norm(shift)))


def test_what_goes_sideways_at_the_end_is_across_the_last_normal() -> None:
    """First the normal leans by 20 degrees, from row 500 on it is Z; 1.5 mm went along Z."""
    base = seen(mode="MCS")
    control = base.facts.distance_3d
    assert control is not None
    guides = (
        GuideChange(KINEMATIC * MS, "MCS", normal=INCLINED),
        GuideChange(500 * MS, "MCS", normal=(0.0, 0.0, 1.0)),
    )
    for chosen, sideways in ((guides, 0.1), (guides[:1], None), (guides[1:], 0.1)):
        of = replace(base.facts, distance_3d=replace(control, guides=chosen))
        found = value(Observed(of, base.series), "tool_offset_sideways_mm")
        late = np.array([0.0, -0.1, 1.5])
        across = late - (late @ np.array(INCLINED)) * np.array(INCLINED)
        expected = float(np.linalg.norm(across)) if sideways is None else sideways
        assert found == pytest.approx(expected)


def test_where_the_control_does_not_follow_its_own_offset_counts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The model has the cycle of an alarm as well, in which the control is off already."""
    nan = float("nan")
    found = superposed(
        monkeypatch,
        [INACTIVE, FOLLOWING, FOLLOWING, INACTIVE, INACTIVE],
        [nan, 1.0, 2.0, 3.0, nan],
        kernel_mm=[0.0, 9.0, 9.0, 2.5, 2.0],
    )
    assert found == pytest.approx([0.0, 1.0, 2.0, 2.5, 2.0])


@pytest.mark.parametrize("until_ms", [1, 2, 3])
def test_an_offset_stays_as_it_was_behind_a_kinematic_that_went_before_the_next_way(
    until_ms: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The third way, from row 3 on, has the kinematic that is off since an earlier row."""
    found = superposed(
        monkeypatch,
        [FOLLOWING] * 6,
        [1.0, 1.0, 1.0, 1.0, 0.5, 0.0],
        kernel_mm=[0.0] * 6,
        ways=[
            (way_of(2.0), slice(0, 1)),
            (way_of(3.0), slice(1, 3)),
            (way_of(5.0, until_ms * MS), slice(3, 6)),
        ],
    )
    assert found == pytest.approx([2.0, 3.0, 3.0, 3.0, 1.5, 0.0])


# What the control of the channel follows


@pytest.mark.parametrize("ref_mm", [0.25, -0.4])
@pytest.mark.parametrize("is_surface", [False, True])
def test_the_gap_that_is_wanted_has_the_zero_of_the_sensor(ref_mm: float, is_surface: bool) -> None:
    """Without REF that is ref_offset (0.1 um): so much more, over the tool and over the surface."""
    state = np.where((AT >= ON) & (AT < OFF), float(ACTIVE), 0.0)
    columns = {"distance_state": state, "set_pos_mm": 12.0 + 0.0 * AT} if is_surface else {}
    of = tilted.left()
    listed = replace(of, channel={**of.channel, "dist_ctrl[0].ref_offset": round(ref_mm * 1e4)})
    plain, found = truth(columns).wanted_gap_mm, truth(columns, listed).wanted_gap_mm
    assert found[ON:OFF] - plain[ON:OFF] == pytest.approx(ref_mm)


@pytest.mark.parametrize("mode", ["ECS", "MCS"])
def test_dead_cycles_are_counted_whichever_axis_has_moved(mode: str) -> None:
    """In MCS an offset moves Z alone. The value steps in row 398, and back in row 403."""
    sensor = np.where((AT >= STEP - 2) & (AT < STEP + 3), 1.5, 0.0)
    table = tilted.trace(mode=mode).append_column("channel.sensor_mm", pa.array(sensor))
    of = Observed(tilted.left(mode), kept(table))
    found = observe(of, parse_check("distance_dead_cycles", "> -1", ""))
    assert (found.value, found.note) == (2 + 3 - 1, "reaction 2, way 3 cycles")


def test_the_gain_of_a_gap_is_that_of_the_true_places() -> None:
    """The axes report another way than they go: 1.5 mm up, of which 1.2 mm open the gap."""
    table = tilted.trace(mode="MCS")
    gap_mm = table["gap.distance_true_mm"].to_numpy().copy()
    gap_mm[STEP + LATE :] -= 0.3
    reported = table["Z.actual_mm"].to_numpy().copy()
    reported[STEP + LATE :] += 1.5
    for name, values in (("gap.distance_true_mm", gap_mm), ("Z.actual_mm", reported)):
        table = table.set_column(table.column_names.index(name), name, pa.array(values))
    of = replace(
        tilted.left("MCS"),
        plc_sensors={"V.E.SENSOR": PlcSensor("gap", 1, 0, False, False, (0.0, 0.0, 1.0))},
    )
    found = tool_metrics._control(Observed(of, kept(table)))
    assert found.gap_gain == pytest.approx(0.8)


@pytest.mark.parametrize(("reaction", "way"), [(0, 2), (3, 4)])
@pytest.mark.parametrize("delay", [0, 2])
def test_the_report_has_the_dead_cycles_of_the_rig_beside_the_measured_ones(
    reaction: int, way: int, delay: int
) -> None:
    of = replace(tilted.left(), plc_sensors={"V.E.SENSOR": PlcSensor("gap", 1, delay)})
    columns = {
        **stepped(STEP - reaction, STEP + way),
        **dict.fromkeys(("step_mm", "delta_mm", "distance_held", "error_mm"), 0.0 * AT),
    }
    found = truth(columns, of)
    (block,) = control_findings(found.observed)
    assert (block.dead.predicted, block.dead.measured) == (found.dead.dead, reaction + way - 1)
    assert block.dead.note == ""


@pytest.mark.parametrize("sizes", [(), (200,), (60, 130, 7)])
def test_what_the_axes_allow_an_offset_is_of_their_own_rows_in_each_block(
    sizes: tuple[int, ...], tmp_path: Path
) -> None:
    """While the tool tilts, from row 51 on, Y allows less from cycle to cycle."""
    table = tilted.trace()
    state = np.where((AT >= KINEMATIC) & (AT < OFF), 4.0, 0.0)
    columns = {
        "channel.distance_state": state, "channel.sensor_mm": np.full(ROWS, -50.0),
        "channel.set_dist_mm": np.full(ROWS, 60.0), "channel.offset_mm": np.zeros(ROWS),
        "channel.distance_held": np.zeros(ROWS), "channel.distance_override_pct": AT * 0.0 + 100.0,
    }  # fmt: skip
    for name, values in columns.items():
        table = table.drop_columns([name]) if name in table.column_names else table
        table = table.append_column(name, pa.array(values))
    of = limited("ECS", [GuideChange(0, "ECS")]).observed.facts
    assert of.distance_3d is not None
    orders = (DistanceOrder(KINEMATIC * MS, "PLC", "ON_CONST_DIST"),)
    listed = {"dist_ctrl[0].kp": 0.2, "dist_ctrl[0].v_max": 10**9, "dist_ctrl[0].a_max": 10**9,
              "dist_ctrl[0].max_deviation": 10**9}  # fmt: skip
    of = replace(
        of,
        kinematics=(replace(of.kinematics[0], begin_ns=0),),
        distance_3d=replace(of.distance_3d, orders=orders),
        channel={**of.channel, **listed},
    )
    writer, begin = SeriesWriter(tmp_path / "a.parquet"), 0
    for size in (*sizes, ROWS - sum(sizes)):
        part = table.slice(begin, size)
        writer.add({name: part[name].combine_chunks() for name in part.column_names})
        begin += size
    parts = Observed(of, writer.close())
    assert len(parts.series.blocks) == len(sizes) + 1
    whole = walk(tool_metrics._control(Observed(of, kept(table)))).offset_mm
    found = walk(tool_metrics._control(parts)).offset_mm
    assert found[KINEMATIC:OFF] == pytest.approx(whole[KINEMATIC:OFF], abs=1e-12)
    steps = np.abs(np.diff(whole[KINEMATIC : KINEMATIC + 40]))
    assert len(set(np.round(steps, 9))) > 10  # the limits of the axes act
    # Z leaves 200 mm/s and 5000 mm/s2 at most: 5 um more in each cycle of 1 ms
    assert np.max(steps) <= 0.2 + 1e-9
    assert np.max(np.diff(steps)) <= 0.005 + 1e-9


# Tilts


def tilting(columns: dict[str, Any], offset: range = range(0)) -> Any:
    table = tilted.trace()
    superposed_mm = table["Z.superposed_mm"].to_numpy().copy()
    superposed_mm[[*offset]] += 0.5
    for name, values in {"Z.superposed_mm": superposed_mm, **columns}.items():
        table = table.set_column(table.column_names.index(name), name, pa.array(values))
    return tilts(Observed(tilted.left(), kept(table)))


@pytest.mark.parametrize("row", [120, 200])
@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
def test_the_largest_error_counts_in_whichever_time_it_is(axis: str, row: int) -> None:
    """Two times, with an offset between them; one axis is 0.2 mm off in one row of one of them."""
    values = tilted.trace()[f"{axis}.truth_mm"].to_numpy().copy()
    values[row] += 0.2
    found = tilting({f"{axis}.truth_mm": values}, range(150, 160))
    assert found.error_mm == pytest.approx(0.2, abs=1e-9)
    # In the middle of two rows half of it, less what the tip is off there itself
    assert found.between_mm == pytest.approx(0.1, abs=2.0 * found.chord_mm)


@pytest.mark.parametrize("row", [KINEMATIC, TILTED - 1])
def test_a_tip_that_moves_in_the_first_or_last_turn_does_not_rest(row: int) -> None:
    """X goes on by 1 mm with the first turn, or with the last one, and stays there."""
    values = tilted.trace()["X.set_mm"].to_numpy().copy()
    values[row + 1 :] += 1.0
    with pytest.raises(NoClosedFormError, match="never at rest while the tool tilted"):
        tilting({"X.set_mm": values})


def test_a_control_of_a_channel_that_was_never_on_has_no_end_of_its_offset() -> None:
    of = tilted.left()
    control = of.distance_3d
    assert control is not None
    off = (DistanceChange(0, "INACTIVE", "NC", "V.E.SENSOR", False, tilted.CONTROLLER),)
    never = replace(of, distance_3d=replace(control, changes=off))
    columns = {"channel.distance_state": np.zeros(ROWS), "channel.axes_share_pct": np.ones(ROWS)}
    base = seen(columns=columns)
    found = observe(
        Observed(never, base.series), parse_check("superposed_share_pct_min", "> 0", "")
    )
    assert (found.value, found.note) == (None, "distance control was never on")
