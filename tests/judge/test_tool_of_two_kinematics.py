"""A tool whose kinematic goes off and on again in a run: which of both times each metric is about.

`reports/tilted.py`: the tool is tilted from 250 ms on, the control is on from 300 to 690 ms, and
its offset of 1.5 mm is there from 400 ms on; axes are two cycles later where they were sent.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import kept
from tests.reports import tilted

from axisrig.bench.judge.distance import tool, tool_metrics
from axisrig.bench.judge.distance.plant import NO_PLANT
from axisrig.bench.judge.distance.tool_metrics import NO_CONTROL, NO_KINEMATIC
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import parse_check
from axisrig.bench.record.facts import Facts
from axisrig.bench.record.kinematics import KinematicRecord
from axisrig.kernel.time.clock import MS

U = tilted.direction(np.array([tilted.C_DEG]), np.array([tilted.A_DEG]))[0]
NORMAL = (0.0, 0.6, 0.8)


def on(begin_ms: int, end_ms: int | None, tool_mm: float = tilted.TOOL_MM) -> KinematicRecord:
    (only,) = tilted.left().kinematics
    end_ns = None if end_ms is None else end_ms * MS
    return replace(only, begin_ns=begin_ms * MS, end_ns=end_ns, tool_mm=tool_mm)


def recorded(
    *kinematics: KinematicRecord,
    off: Mapping[str, Mapping[int, float]] | None = None,
    columns: Mapping[str, Any] | None = None,
    without: tuple[str, ...] = (),
    **of_facts: Any,
) -> Observed:
    """off: what is added to a column in some rows; columns: in place of those of the recording."""
    table = tilted.trace()
    for name, rows in (off or {}).items():
        values = table[name].to_numpy().copy()
        for row, more in rows.items():
            values[row] += more
        table = table.set_column(table.column_names.index(name), name, pa.array(values))
    for name, values in (columns or {}).items():
        table = table.set_column(table.column_names.index(name), name, pa.array(values))
    gone = [name for name in table.column_names if name.startswith(without)] if without else []
    of: Facts = replace(tilted.left(), kinematics=kinematics, **of_facts)
    return Observed(of, kept(table.drop_columns(gone)))


def judged(of: Observed, metric: str) -> Observation:
    return observe(of, parse_check(metric, "> -1e12", ""))


# The worst of both


@pytest.mark.parametrize(("first", "second"), [(0.004, 0.002), (-0.002, 0.004), (0.002, -0.003)])
@pytest.mark.parametrize(
    ("metric", "column", "unit"),
    [
        ("tool_length_error_um", "channel.tool_length_mm", 1e3),
        ("kinematic_error_nm", "gap.tcp_y_mm", 1e6),
        ("kinematic_error_nm", "gap.clamping_x_mm", 1e6),
    ],
)
def test_an_error_of_the_tool_is_the_worst_of_all_times_with_a_kinematic(
    metric: str, column: str, unit: float, first: float, second: float
) -> None:
    """What is between them, or before and after, is none."""
    rows = {40: 9.0, 100: first, 250: 9.0, 299: 9.0, 500: second, 601: 9.0}
    found = judged(recorded(on(50, 200), on(300, 600), off={column: rows}), metric)
    assert found.value == pytest.approx(max(abs(first), abs(second)) * unit, rel=1e-6)
    if metric == "kinematic_error_nm":
        assert found.note == "450 cycles of gap"


@pytest.mark.parametrize(("first", "second"), [(0.3, 0.2), (-0.2, 0.3), (0.1, -0.25)])
def test_the_largest_way_across_the_normal_is_that_of_all_times(
    first: float, second: float
) -> None:
    """Without tilt in the first rows; X is across Z whatever the tilt is."""
    rows = {20: 9.0, 52: first, 250: 9.0, 320: second, 390: 9.0}
    of = recorded(on(50, 200), on(300, 380), off={"X.set_mm": rows, "X.superposed_mm": rows})
    way_mm = max(abs(first), abs(second))
    assert judged(of, "tool_sideways_um_max").value == pytest.approx(way_mm * 1e3, rel=1e-6)


def test_each_time_has_the_tool_that_was_in_it() -> None:
    """The PLC shows 80 mm throughout: right for the one, 30 mm wrong for the other."""
    for tools_mm in ((80.0, 50.0), (50.0, 80.0), (50.0, 110.0)):
        first, second = tools_mm
        of = recorded(on(50, 200, first), on(300, 600, second))
        worst_mm = max(abs(80.0 - mm) for mm in tools_mm)
        assert worst_mm == 30.0
        found = judged(of, "tool_length_error_um").value
        assert found == pytest.approx(30e3, rel=1e-6)
    same = judged(recorded(on(50, 200), on(300, 600)), "tool_length_error_um").value
    assert same == pytest.approx(0.0, abs=1e-6)


# The last one


@pytest.mark.parametrize("end_ms", [600, 680])
def test_how_the_offset_has_moved_the_tool_is_of_the_last_kinematic(end_ms: int) -> None:
    """1.5 mm along u/u_z while the control has it; 2 cycles of 0.05 mm behind in Y."""
    way = tilted.OFFSET_MM * U / U[2] - (0.0, 0.1, 0.0)
    later = recorded(on(50, 390), on(450, end_ms))
    for letter, mm in zip("xyz", way, strict=True):
        assert judged(later, f"tool_offset_{letter}_mm").value == pytest.approx(mm, abs=1e-9)
    path_mm = judged(later, "tool_offset_path_mm").value
    assert path_mm == pytest.approx(np.linalg.norm(way), abs=1e-9)


def test_a_kinematic_without_an_offset_shows_none_of_the_one_before() -> None:
    """The control is off from 690 ms on; the axes have come to where they were sent."""
    after = recorded(on(50, 600), on(694, None))
    for letter in "xyz":
        found = judged(after, f"tool_offset_{letter}_mm").value
        assert found == pytest.approx(0.0, abs=1e-9)


def test_without_a_choice_where_the_offset_acts_it_is_across_z_of_the_machine() -> None:
    """As it is with the normal of a level workpiece, and other than with an inclined one."""
    of = tilted.left().distance_3d
    assert of is not None
    way = tilted.OFFSET_MM * U / U[2] - (0.0, 0.1, 0.0)
    for guides, normal in (
        ((), (0.0, 0.0, 1.0)),
        (of.guides, (0.0, 0.0, 1.0)),
        (tuple(replace(guide, normal=NORMAL) for guide in of.guides), NORMAL),
    ):
        observed = recorded(on(50, 600), distance_3d=replace(of, guides=guides))
        across = way - (way @ normal) * np.array(normal)
        found = judged(observed, "tool_offset_sideways_mm").value
        assert found == pytest.approx(np.linalg.norm(across), abs=1e-9)


# Where and why


def test_the_note_of_what_is_superposed_names_the_axis_and_its_own_instant(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each axis is off most at another time; without a name it is that of the worst one."""
    off = {"X.superposed_mm": {120: 0.0005, 150: 0.0001}, "Y.superposed_mm": {150: -0.0003},
           "C.superposed_deg": {260: 0.0002, 120: -0.0001}}  # fmt: skip
    of, own = recorded(on(50, 600), off=off), tool.axes_of(recorded(), tool_metrics.SUPERPOSED)
    monkeypatch.setattr(tool_metrics, "_expected_superposed", lambda _: own)
    for name, axis, increments, at_ms in (
        ("", "X", 5.0, 120), (":X", "X", 5.0, 120), (":Y", "Y", 3.0, 150), (":C", "C", 2.0, 260),
        (":A", "A", 0.0, 0),
    ):  # fmt: skip
        found = judged(of, f"superposed_error_increments{name}")
        assert found.value == pytest.approx(increments, abs=1e-6)
        assert found.note == f"axis {axis}, {at_ms} ms"


OF_TOOL = ("tool_tilt_end_deg", "tool_tilt_deg_max", "tool_length_end_mm", "tool_length_error_um")
OF_OFFSET = ("tool_offset_path_mm", "tool_offset_sideways_mm", "tool_offset_x_mm",
             "tool_offset_y_mm", "tool_offset_z_mm", "tool_sideways_um_max")  # fmt: skip


@pytest.mark.parametrize("metric", OF_TOOL)
def test_what_the_plc_does_not_show_of_a_tool_has_no_value(metric: str) -> None:
    without = recorded(on(50, 600), without=("channel.tilt", "channel.tool"))
    assert judged(without, metric) == Observation(None, note=NO_CONTROL)
    nothing = np.full(tilted.ROWS, np.nan)
    dark = recorded(columns={"channel.tilt_deg": nothing, "channel.tool_length_mm": nothing})
    assert judged(dark, metric) == Observation(None, note=NO_KINEMATIC)


@pytest.mark.parametrize("metric", [*OF_OFFSET, "kinematic_error_nm"])
def test_without_any_kinematic_no_metric_of_a_tool_has_a_value(metric: str) -> None:
    assert judged(recorded(), metric) == Observation(None, note=NO_KINEMATIC)
    short = recorded(on(200, 200))
    assert judged(short, metric) == Observation(None, note=NO_KINEMATIC), "off in the same cycle"


@pytest.mark.parametrize(
    "metric",
    [*OF_OFFSET, "superposed_mm_max:X", "superposed_speed_mm_s_max:Y",
     "superposed_acceleration_mm_s2_max:Z", "superposed_share_pct_min", "clamping_height_error_nm",
     "superposed_error_increments"],
)  # fmt: skip
def test_without_3d_control_no_metric_of_its_offset_has_a_value(metric: str) -> None:
    assert judged(recorded(on(50, 600), distance_3d=None), metric) == Observation(
        None, note=NO_CONTROL
    )


def test_a_plant_that_shows_no_tool_has_no_error_of_its_kinematic() -> None:
    found = judged(recorded(on(50, 600), without=("gap.tcp", "gap.clamping")), "kinematic_error_nm")
    assert found == Observation(None, note=f"{NO_PLANT} of an inclined tool")
