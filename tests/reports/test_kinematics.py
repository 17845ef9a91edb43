"""What the report shows of an inclined tool, on runs made of formulas."""

import base64
import gzip
import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import MS, kept
from tests.reports import distances, tilted
from tests.reports.formulas import write_runs
from tests.reports.pages import opened, whole
from tests.reports.test_report import Page

from axisrig.bench.judge.kinematics.findings import tool_findings
from axisrig.bench.judge.kinematics.tool_findings import ToolFindings
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.run_findings import RunFindings
from axisrig.bench.record.distance import Diagnosis
from axisrig.bench.record.kinematics import KinematicRecord
from axisrig.reports.build import build_report
from axisrig.reports.kinematics.motion import Motion, motion_of, moved_mm
from axisrig.reports.kinematics.scene import (
    INSTANTS,
    at_work,
    ideal,
    instants,
    planes,
    projections,
    scene,
)
from axisrig.reports.kinematics.section import dumps, sections
from axisrig.reports.kinematics.signals import plots, with_signals
from axisrig.reports.parts.encode import encode_signal
from axisrig.reports.signals import chart, signals

ECS, MCS = tilted.trace(mode="ECS"), tilted.trace(mode="MCS")
LEFT = tilted.left()
TOOL = tilted.tool(ECS, LEFT)
STEADY = slice(tilted.STEP - tilted.KINEMATIC + 5, tilted.OFF - tilted.KINEMATIC)


def motion(trace: pa.Table = ECS, tool: ToolFindings = TOOL) -> Motion:
    found = motion_of(trace, tool)
    assert found is not None
    return found


# The block of the judge


def test_the_block_names_limits_sensor_and_where_the_offset_acted() -> None:
    (stretch,) = TOOL.kinematics
    assert stretch.limits == {"HD2": 50.0, "HD3": 70.0, "HD4": 85.0}
    assert (stretch.record.ids, stretch.record.tool_mm) == ((9, 98), 80.0)
    assert TOOL.sensor == "gap"
    assert [(g.change.mode, g.is_used) for g in TOOL.guides] == [("MCS", False), ("ECS", True)]


def test_what_a_program_writes_wins_and_no_extension_has_no_limit_of_it() -> None:
    """[90; -] of FCT-M3 12.9: never extended, so HD2 and HD3 say nothing."""
    program = (((1, 98, 1), 900_000.0), ((1, 98, 3), 910_000.0))
    on = KinematicRecord(0, None, tilted.AXES, (9, 98), 80.0, program)
    changed = replace(LEFT, kinematics=(on,))
    (stretch,) = tilted.tool(ECS, changed).kinematics
    assert stretch.limits == {"HD4": 91.0}


def test_a_sensor_without_a_true_distance_has_its_beam_only() -> None:
    """What an FMU need not have is not a number: no orthogonal distance, no plane."""
    found = motion(ECS.drop_columns(["gap.distance_true_mm", "gap.valid"]))
    assert np.isnan(found.distance_mm).all()
    assert np.array_equal(found.hit_mm, motion().hit_mm)
    assert planes(found) == []


def test_a_run_without_a_kinematic_has_no_tool() -> None:
    observed = Observed(replace(LEFT, kinematics=()), kept(ECS))
    assert tool_findings(observed) == []
    assert sections(RunFindings(), ECS, "a", {}) == []


# Motion: numbers of the issue, 1.5 mm at A -35 and C 20


def test_along_the_tool_the_contour_moves_by_1_8312_and_1_0503_to_the_side() -> None:
    """o/cos b = 1.5/cos 35 = 1.8312 along u: X -0.3592, Y 0.9870, to the side 1.0503."""
    found = motion()
    assert found.moved_mm[STEADY] == pytest.approx(1.8312, abs=5e-5)
    apart = (found.tcp_mm - found.programmed_mm)[STEADY]
    assert apart == pytest.approx(np.tile([-0.3592, 0.9870, 1.5], (len(apart), 1)), abs=5e-5)
    assert np.hypot(apart[:, 0], apart[:, 1]) == pytest.approx(1.0503, abs=5e-5)


@pytest.mark.parametrize(("mode", "way"), [("ECS", 1.8312), ("MCS", 1.5)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_offset_below_0_moves_the_tool_the_other_way(mode: str, way: float, sign: float) -> None:
    trace = tilted.trace(mode=mode, has_sensor=False, offset_mm=sign * 1.5)
    tool = replace(tilted.tool(trace, tilted.left(mode)), sensor=None)
    assert motion(trace, tool).moved_mm[STEADY] == pytest.approx(sign * way, abs=5e-5)
    assert moved_mm(trace, tool)[tilted.STEP + 5] == pytest.approx(sign * way, abs=5e-5)


def test_along_the_normal_nothing_moves_to_the_side() -> None:
    found = motion(MCS, tilted.tool(MCS, tilted.left("MCS")))
    apart = (found.tcp_mm - found.programmed_mm)[STEADY]
    assert np.abs(apart[:, :2]).max() < 1e-9
    assert found.moved_mm[STEADY] == pytest.approx(1.5, abs=1e-9)


def test_plant_and_chain_of_matrices_agree_on_the_tool() -> None:
    """Without a sensor the tool is that of the true positions of the axes, without a surface."""
    by_chain = motion(tilted.trace(has_sensor=False), replace(TOOL, sensor=None))
    by_plant = motion()
    for name in ("clamp_mm", "tcp_mm", "programmed_mm", "tilt_deg", "length_mm"):
        assert np.abs(getattr(by_chain, name) - getattr(by_plant, name)).max() < 1e-9
    assert np.isnan(by_chain.hit_mm).all()
    assert planes(by_chain) == []


def test_the_length_is_virtually_extended_from_50_to_70_degrees() -> None:
    """FCT-M3 12.4.2 with [50; 70] and 80 mm: 150.351 mm at 70 degrees, frozen above."""
    steep = motion(tilted.trace(-80.0, has_sensor=False), replace(TOOL, sensor=None))
    assert steep.length_mm.max() == pytest.approx(150.351, abs=5e-4)
    between = (steep.tilt_deg > 50.0) & (steep.tilt_deg < 70.0) & ~steep.is_on
    heights = steep.clamp_mm[between, 2]
    assert np.ptp(heights) < 1e-9
    assert heights == pytest.approx(80.0 * np.cos(np.radians(50.0)), abs=1e-9)


def test_the_beam_is_below_a_surface_that_has_risen_until_the_offset_follows() -> None:
    """The workpiece rises by 1.5 mm two cycles before the tool: 1.5/cos 35 along the beam."""
    found = motion()
    first = tilted.STEP - tilted.KINEMATIC
    assert found.depth_mm[first : first + 2] == pytest.approx(1.8312, abs=5e-5)
    assert np.abs(found.depth_mm[STEADY]).max() < 1e-9
    assert found.distance_mm[STEADY] == pytest.approx(80.0 * np.cos(np.radians(35.0)), abs=1e-9)


def test_outside_the_kinematic_nothing_is_moved() -> None:
    along = moved_mm(ECS, TOOL)
    assert np.isnan(along[: tilted.KINEMATIC]).all()
    assert along[tilted.KINEMATIC : tilted.STEP].tolist() == [0.0] * (
        tilted.STEP - tilted.KINEMATIC
    )


# Scene


def test_a_workpiece_that_rises_is_two_planes() -> None:
    low, high = planes(motion())
    assert low["normal"] == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)
    assert (low["at_mm"], high["at_mm"]) == (pytest.approx(0.0), pytest.approx(1.5))
    assert high["begin_ms"] == tilted.STEP


def inclined(p_deg: float, wave_mm: float = 0.0) -> Motion:
    """The tilting tool over a plane that rises along Y, or over waves."""
    found = motion()
    slope = np.tan(np.radians(p_deg))
    clamp, u = found.clamp_mm, found.direction
    height = clamp[:, 2] - slope * clamp[:, 1]
    along = height / (u[:, 2] - slope * u[:, 1])
    hit = clamp - along[:, None] * u
    wave = wave_mm * np.sin(np.arange(len(hit)) / 3.0)
    distance = height * np.cos(np.radians(p_deg)) + wave
    return replace(found, hit_mm=hit, along_mm=along, distance_mm=distance)


def test_a_plane_that_is_inclined_is_found_with_its_normal() -> None:
    """Rising by 10 degrees along Y: n = (0, -sin 10, cos 10)."""
    (one,) = planes(inclined(10.0))
    assert one["normal"] == pytest.approx([0.0, -0.173648, 0.984808], abs=1e-5)
    assert one["at_mm"] == pytest.approx(0.0, abs=1e-4)


def test_readings_at_one_place_take_the_normal_before_or_the_level_one() -> None:
    """Rows 0 to 19 along a plane that rises along Y, then one place; the tool is upright there."""
    slope = np.radians(10.0)
    normal = np.array([0.0, -np.sin(slope), np.cos(slope)])
    y = np.arange(20.0)
    rising = np.column_stack([y % 3, y, y * np.tan(slope)])
    place = np.tile([1.0, 30.0, 7.0], (5, 1))
    for clamp_of, expected in ((np.array([0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]), (normal, normal)):
        hit = np.concatenate([rising, place])
        clamp = np.concatenate([rising + 4.0 * normal, place + 4.0 * clamp_of])
        count = len(hit)
        made: Any = SimpleNamespace(
            hit_mm=hit, clamp_mm=clamp, distance_mm=np.full(count, 4.0),
            times_ns=np.arange(count) * MS,
        )  # fmt: skip
        first, second = planes(made)
        assert first["normal"] == pytest.approx(normal, abs=1e-8)
        assert second["normal"] == pytest.approx(expected, abs=1e-8)
        assert second["at_mm"] == pytest.approx(float(place[0] @ np.array(expected)), abs=1e-5)
        assert second["begin_ms"] == 20.0


def test_the_path_of_a_kinematic_begins_as_it_is_switched_on() -> None:
    """Where the axes were sent before is no part of it, although demands act two cycles late."""
    before = np.asarray(ECS["time_ns"]) < tilted.KINEMATIC * MS
    moved = {name: np.asarray(ECS[name]) for name in ECS.column_names}
    for axis in "XYZ":
        moved[f"{axis}.set_mm"] = moved[f"{axis}.set_mm"] + np.where(before, 50.0, 0.0)
    found = motion(pa.table(moved))
    assert np.array_equal(found.programmed_mm, motion().programmed_mm)


def test_what_is_no_plane_is_not_drawn_as_one() -> None:
    assert planes(inclined(10.0, wave_mm=0.5)) == []


def test_the_plane_of_the_tilt_comes_first_and_every_projection_has_its_name() -> None:
    """C 20: the tool leans to 110 degrees from X to Y, by -sin 20 and cos 20."""
    views = projections(motion())
    assert [view["name"] for view in views] == ["tilt", "path", "X-Z", "Y-Z", "X-Y"]
    assert views[0]["right"] == pytest.approx((-0.342020, 0.939693, 0.0), abs=1e-6)
    assert "110°" in views[0]["x"]
    assert views[1]["x"] == "Y in mm"  # along the path
    level = replace(motion(), tilt_deg=np.zeros(len(motion().times_ns)))
    assert "tilt" not in [view["name"] for view in projections(level)]


def test_few_instants_show_the_whole_and_every_step() -> None:
    found = motion()
    rows = instants(found)
    assert len(rows) <= INSTANTS
    assert (rows[0], rows[-1]) == (0, len(found.times_ns) - 1)
    step = tilted.STEP - tilted.KINEMATIC
    assert np.abs(rows - step).min() <= 3


def test_the_scene_can_be_read_back() -> None:
    """Positions to 0.1 um; the same bytes for the same motion."""
    found = motion()
    made = scene(found, TOOL)
    assert made == scene(found, TOOL)
    about = json.loads(made["about"])
    octets = gzip.decompress(base64.b64decode(made["packed"]))
    assert len(octets) == sum(head["planes"] for head in about["columns"]) * about["rows"]
    names = [head["name"] for head in about["columns"]]
    assert names[:4] == ["time_ns", "clamp_x", "clamp_y", "clamp_z"]
    head, part = encode_signal(found.clamp_mm[instants(found), 0], 4)
    assert vars(head) == {k: about["columns"][1][k] if k != "gaps" else [] for k in vars(head)}
    assert part in octets
    assert len(made["about"]) + len(made["packed"]) < 12_000


def test_the_picture_of_the_surface_is_about_the_control_or_about_what_is_near() -> None:
    found = motion()
    assert at_work(found).sum() == tilted.OFF - tilted.ON
    # 20 mm away at first, then within 1 um: an approach is none of it
    length = np.where(np.arange(len(found.times_ns)) < 100, -4.0, 1e-3) + found.along_mm
    alone = replace(found, is_on=np.zeros(len(length), dtype=bool), length_mm=length)
    assert at_work(alone).sum() == len(length) - 100


def test_set_pos_is_an_ideal_surface_along_the_normal_from_the_origin() -> None:
    """n (p - p0) = SET_POS with SET_POS 2 and the origin 5 above zero: at 7."""
    last = TOOL.guides[1]
    guides = [replace(last, change=replace(last.change, origin_mm=(3.0, 0.0, 5.0)))]
    found = replace(motion(), set_pos_mm=np.full(len(motion().times_ns), 2.0))
    assert ideal(found, replace(TOOL, guides=guides)) == [{"normal": [0.0, 0.0, 1.0], "at_mm": 7.0}]
    assert ideal(motion(), TOOL) == []


# Signals and limits


def test_truth_and_what_the_plc_sees_are_one_plot_with_the_limits_of_the_tilt() -> None:
    description, _ = chart(ECS, RunFindings(of_topics=[TOOL]))
    drawn = {plot["plot"]: plot["series"] for plot in description["plots"]}
    shown = [entry["label"] for entry in drawn["tilt"]["channel"]]
    assert shown == ["shown to the PLC", "true"]
    limits = {row["label"]: row["value"] for row in description["limits"]}
    assert limits == {"HD2": 50.0, "HD3": 70.0, "HD4": 85.0}


def test_every_signal_has_its_place_and_points_of_the_tool_have_none() -> None:
    control = replace(distances.control(distances.samples()[0]), axis="channel")
    assert plots(ECS, RunFindings(of_topics=[TOOL, control])).axes == ["channel"]
    assert plots(ECS, RunFindings(of_topics=[TOOL])).axes == []
    after = with_signals(ECS, RunFindings(of_topics=[TOOL, control]))
    names = set(after.column_names)
    assert "channel.moved_mm" in names
    assert not {"C.superposed_deg", "A.superposed_deg"} & names
    assert not [name for name in names if "clamping" in name or "tcp_" in name]
    alone = with_signals(ECS, RunFindings(of_topics=[TOOL]))
    known = [name.partition(".")[2] for name in alone.column_names if name != "time_ns"]
    assert [name for name in known if name not in signals()] == []
    assert "channel.distance_state" not in alone.column_names  # never on


@pytest.mark.parametrize("recorded", ["A.superposed_deg", "A.superposed_mm"])
def test_what_is_superposed_on_an_axis_that_turns_is_drawn_in_degrees(recorded: str) -> None:
    """Older recordings have it under the name of a length."""
    other = ECS.drop_columns(["A.superposed_deg"])
    other = other.append_column(recorded, other.column("Z.superposed_mm"))
    names = set(with_signals(other, RunFindings(of_topics=[TOOL])).column_names)
    assert {name for name in names if name.startswith("A.superposed")} == {"A.superposed_deg"}
    found = Observed(LEFT, kept(other)).column("A", "superposed_mm")
    assert found.tolist() == other.column("Z.superposed_mm").to_pylist()


def test_without_a_sensor_tilt_and_length_are_those_of_the_chain() -> None:
    """80 cos 50/cos 70 = 150.351 mm at 80 degrees; nothing before the kinematic is on."""
    bare = tilted.trace(-80.0, has_sensor=False).drop_columns(["channel.tilt_deg"])
    after = with_signals(bare, RunFindings(of_topics=[replace(TOOL, sensor=None)]))
    tilt = after.column("channel.tilt_true_deg").to_numpy()
    assert np.isnan(tilt[: tilted.KINEMATIC]).all()
    assert tilt[tilted.ON] == pytest.approx(80.0, abs=1e-9)
    length = after.column("channel.tool_length_true_mm").to_numpy()
    assert length[tilted.ON] == pytest.approx(150.351, abs=5e-4)


def test_a_kinematic_without_distance_control_has_its_section() -> None:
    """Nothing of a control is recorded: no guides, no columns of the channel."""
    columns = [name for name in ECS.column_names if name.split(".")[0] in ("time_ns", *"XYZCA")]
    bare = ECS.select([name for name in columns if "superposed" not in name])
    (tool,) = tool_findings(Observed(replace(LEFT, distance_3d=None), kept(bare)))
    assert (tool.guides, tool.diagnosis, tool.sensor) == ([], (), None)
    (found,) = sections(RunFindings(of_topics=[tool]), bare, "a", {})
    assert (found["has_surface"], found["has_offset"], found["modes"]) == (False, False, [])
    assert [row[0] for row in found["rows"]] == ["tilt", "tool length, true"]
    description, _ = chart(bare, RunFindings(of_topics=[tool]))
    assert "tilt" in [plot["plot"] for plot in description["plots"]]


@pytest.mark.parametrize(
    ("missed", "has_surface"),
    [(slice(0, 0), True), (slice(5, 6), True), (slice(0, -1), True), (slice(1, None), True),
     (slice(None), False)],
)  # fmt: skip
def test_a_surface_is_shown_where_the_beam_meets_it_in_any_row(
    missed: slice, has_surface: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In all rows, in all but one, in one alone; only where it never does there is none."""
    hit = np.zeros_like(motion().hit_mm)
    hit[missed] = np.nan
    made = replace(motion(), hit_mm=hit)
    monkeypatch.setattr("axisrig.reports.kinematics.section.motion_of", lambda *_: made)
    monkeypatch.setattr("axisrig.reports.kinematics.section.scene", lambda *_: None)
    (found,) = sections(RunFindings(of_topics=[TOOL]), ECS, "a", {})
    assert found["has_surface"] is has_surface


@pytest.mark.parametrize(
    ("rows", "has_offset"), [(slice(0, 0), False), (slice(3, 4), True), (slice(None), True)]
)
@pytest.mark.parametrize("offset_mm", [0.01, -0.01])
def test_an_offset_is_shown_where_there_is_one_in_any_row(
    rows: slice, has_offset: bool, offset_mm: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To either side; a row without a value is none."""
    values = np.full(len(motion().offset_mm), np.nan)
    values[2:] = 0.0
    values[rows] = offset_mm
    made = replace(motion(), offset_mm=values)
    monkeypatch.setattr("axisrig.reports.kinematics.section.motion_of", lambda *_: made)
    monkeypatch.setattr("axisrig.reports.kinematics.section.scene", lambda *_: None)
    (found,) = sections(RunFindings(of_topics=[TOOL]), ECS, "a", {})
    assert found["has_offset"] is has_offset


# Section


def shown() -> dict[str, Any]:
    (found,) = sections(RunFindings(of_topics=[TOOL]), ECS, "a", {})
    return found


def test_the_section_says_kinematic_mode_and_largest_values() -> None:
    found = shown()
    assert found["kinematics"] == [
        ("50.0 ms", "kinematic 9, 98 on, tool 80 mm, HD2 50°, HD3 70°, HD4 85°")
    ]
    assert found["modes"] == [("300.0 ms", "ECS: the offset acts along the tool")]
    rows = {name: (least, most, unit) for name, least, most, unit in found["rows"]}
    assert rows["tilt"] == ("0.0000", "35.0000", "°")
    assert rows["b, direction to normal"] == ("35.0000", "35.0000", "°")
    assert rows["o/cos b, along the direction"] == ("0.0000", "1.8312", "mm")
    assert rows["beam below the surface while it works"][1] == "1831.16"


def test_diagnosis_data_are_a_table_of_its_names() -> None:
    """1.5/cos 35 is 1.83116."""
    table = dumps(TOOL)
    assert table is not None
    assert table["instants"] == ["0.0 ms", "300.0 ms", "690.0 ms"]
    heads = [(row["head"], row["name"], row["changes"]) for row in table["rows"]]
    assert heads == [
        ("Distance Control", "zstd", True),
        ("", "kp", False),
        ("Dist-Ctrl Interface", "cmd_offset", True),
    ]
    many = [Diagnosis(n * MS, {"zstd": str(n)}) for n in range(40)]
    table = dumps(replace(TOOL, diagnosis=many))
    assert table is not None
    assert (len(table["instants"]), table["left_out"]) == (12, 28)
    assert table["rows"][0]["values"][-1] == "39"
    assert dumps(replace(TOOL, diagnosis=[])) is None


def test_without_signals_the_section_is_still_there() -> None:
    (found,) = sections(RunFindings(of_topics=[TOOL]), None, "a", {})
    assert (found["scene"], found["rows"]) == (None, [])


# The page


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tool")
    return write_runs(folder, "tool", {"ecs": ECS, "mcs": MCS}, {"ecs": LEFT, "mcs": LEFT})


@pytest.mark.long
def test_the_page_has_the_side_view_and_stays_the_same(results: Path) -> None:
    first = build_report(results, findings=tilted.found).read_bytes()
    assert build_report(results, findings=tilted.found).read_bytes() == first
    page = Page(whole(first.decode()))
    views = [a for a in page.find("figure") if a.get("class") == "tv"]
    assert [view["aria-label"] for view in views] == [
        "Side view of the tool of tool-ecs",
        "Side view of the tool of tool-mcs",
    ]
    assert json.loads(views[0]["data-about"])["rows"] <= INSTANTS
    assert len(page.find("caption")) == len(page.find("table"))
    text = " ".join(" ".join(page.text).split())
    for words in ("contour with offset, true", "beam below the surface", "Dist-Ctrl Interface"):
        assert words in text
    article = opened(first.decode())["tool-ecs"].html.split('<div class="body">')[0]
    assert len(article) < 20_000
