"""Metrics of the tool centre point where a program has several kinematics, or rapid traverse."""

from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import kept
from tests.reports import tilted

from axisrig.bench.judge.distance import tool, tool_metrics
from axisrig.bench.judge.kinematics import metrics
from axisrig.bench.judge.kinematics.metrics import KINEMATIC_METRICS
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import parse_check
from axisrig.kernel.time.clock import MS

FIRST, LAST = (SimpleNamespace(axes=axes) for axes in (("X", "Y", "Z", "A"), ("U", "V", "W", "B")))
# Places of the tool in 8 rows: 1 mm a cycle in rapid traverse, then 0.1, down 0.2, and at rest
X_MM = np.array([0.0, 1.0, 2.0, 2.1, 2.2, 2.0, 1.8, 1.8])


def observed(monkeypatch: pytest.MonkeyPatch, *stretches: tuple[bool, int, int]) -> Any:
    found = [
        SimpleNamespace(on=FIRST, has_feed=feed, begin=begin, end=end, shift=0)
        for feed, begin, end in stretches
    ]
    monkeypatch.setattr(metrics, "stretches", lambda _: found)
    monkeypatch.setattr(metrics, "places", lambda _, on, _column, rows: (on, X_MM[rows]))

    def centre(_: Any, on: Any, axes: Any) -> Any:
        assert axes[0] is on
        offset = 100.0 if on is LAST else 0.0
        return np.stack([axes[1] + offset, axes[1] * 0 + offset, axes[1] * 0 - offset], axis=-1)

    monkeypatch.setattr(metrics, "tool_centre_mm", centre)

    class Rows:
        facts = SimpleNamespace(kinematics=(FIRST, LAST), timing=SimpleNamespace(period_ns=2 * MS))

        def __len__(self) -> int:
            return len(X_MM)

    return Rows()


@pytest.mark.parametrize(
    ("stretches", "speed_mm_s"),
    [
        ([(False, 0, 2), (True, 2, 4), (True, 4, 6)], 100.0),
        ([(True, 2, 4), (False, 0, 2)], 50.0),
        ([(False, 0, 2)], None),
        ([], None),
    ],
)
def test_a_speed_is_that_of_blocks_with_a_feed(
    stretches: list[tuple[bool, int, int]],
    speed_mm_s: float | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen = observed(monkeypatch, *stretches)
    found = KINEMATIC_METRICS["tcp_velocity_mm_s_max"](seen, None).value
    assert found == (None if speed_mm_s is None else pytest.approx(speed_mm_s))


def test_the_place_at_the_end_is_that_of_the_last_kinematic(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of its own axes: those of the first one are none of it any more."""
    seen = observed(monkeypatch)
    values = [KINEMATIC_METRICS["tcp_mm"](seen, axis).value for axis in "UVW"]
    assert values == pytest.approx([101.8, 100.0, -100.0])
    for axis in ("X", "B", None):
        missing = KINEMATIC_METRICS["tcp_mm"](seen, axis)
        assert missing.value is None
        assert "U V W" in missing.note


@pytest.mark.parametrize(
    ("until_ms", "offset_mm", "expected"),
    [
        (None, [1.0] * 6, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        (6, [1.0] * 6, [1.0, 2.0, 3.0, 3.0, 3.0, 3.0]),  # goes in the very cycle of row 3
        (5, [1.0] * 6, [1.0, 2.0, 3.0, 3.0, 3.0, 3.0]),  # between two rows
        (6, [1.0, 1.0, 2.0, 1.0, 0.5, 0.0], [1.0, 2.0, 6.0, 3.0, 1.5, 0.0]),  # it runs out
        (6, [1.0, 1.0, 0.0, 1.0, 1.0, 1.0], [1.0, 2.0, 0.0, 0.0, 0.0, 0.0]),
        (0, [1.0] * 6, [0.0] * 6),  # there was no way before
    ],
)
def test_what_is_superposed_turns_as_long_as_its_kinematic_is_on(
    until_ms: int | None,
    offset_mm: list[float],
    expected: list[float],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The base goes 1, 2 .. 6 mm in cycles of 2 ms; this way moves the axis by base times offset.

    From the cycle in which the kinematic goes, the axis keeps what it had in the one before, and
    what runs out then does so by its share.
    """
    base = np.arange(1.0, 7.0)[:, None]
    way = SimpleNamespace(
        until_ns=None if until_ms is None else until_ms * MS,
        superposed=lambda poses, offsets: poses + poses * np.asarray(offsets)[:, None],
    )
    truth: Any = SimpleNamespace(
        listed=SimpleNamespace(is_optimized=True),
        is_active=np.ones(6, dtype=bool),
        base=base,
        times_ns=np.arange(6) * 2 * MS,
        way_rows=lambda: [(way, slice(0, 6))],
    )
    walked = SimpleNamespace(offset_mm=np.array(offset_mm))
    monkeypatch.setattr(tool_metrics.expected_offset, "walk", lambda _: walked)

    class Truth(SimpleNamespace):
        def __getitem__(self, name: str) -> Any:
            return walked.offset_mm

    found = tool_metrics._expected_superposed(Truth(**vars(truth)))  # type: ignore[arg-type]
    assert found[:, 0].tolist() == pytest.approx(expected)


INACTIVE, FOLLOWING, FROZEN, RUNNING_OUT = 0, 4, 2, 3
"""States of a control; it follows with a constant distance."""


@pytest.mark.parametrize(
    ("states", "offset_mm", "expected"),
    [
        (
            [FOLLOWING, FOLLOWING, FOLLOWING, FOLLOWING, FOLLOWING, FOLLOWING],
            [1.0, 2.0, 0.0, -1.0, 0.0, 0.0],
            [0.0, 1.0, 2.0, 0.0, -1.0, 0.0],
        ),
        (
            [FOLLOWING, FOLLOWING, FROZEN, FROZEN, FOLLOWING, FOLLOWING],
            [1.0, 2.0, 2.0, 2.0, 3.0, 4.0],
            [0.0, 1.0, 2.0, 2.0, 2.0, 3.0],
        ),
        # It runs out; its last part is on its way when the control is off
        (
            [FOLLOWING, FOLLOWING, RUNNING_OUT, RUNNING_OUT, INACTIVE, INACTIVE],
            [1.0, 2.0, 1.5, 0.5, 0.0, 0.0],
            [0.0, 1.0, 2.0, 1.5, 0.5, 0.0],
        ),
        # OFF NO_MOVE, while it follows and when it is frozen
        (
            [FOLLOWING, FOLLOWING, FOLLOWING, INACTIVE, INACTIVE, INACTIVE],
            [1.0, 2.0, 3.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 2.0, 0.0, 0.0, 0.0],
        ),
        (
            [FOLLOWING, FOLLOWING, FROZEN, FROZEN, INACTIVE, INACTIVE],
            [1.0, 2.0, 2.0, 2.0, 0.0, 0.0],
            [0.0, 1.0, 2.0, 2.0, 0.0, 0.0],
        ),
        # A reset keeps it until the axes rest; ON may come in the cycle that hands it over
        (
            [FOLLOWING, FOLLOWING, INACTIVE, INACTIVE, INACTIVE, INACTIVE],
            [1.0, 2.0, 2.0, 2.0, 0.0, 0.0],
            [0.0, 1.0, 2.0, 2.0, 0.0, 0.0],
        ),
        (
            [FOLLOWING, FOLLOWING, INACTIVE, FOLLOWING, FOLLOWING, FOLLOWING],
            [1.0, 2.0, 2.0, 0.0, 0.0, 1.0],
            [0.0, 1.0, 2.0, 0.0, 0.0, 0.0],
        ),
    ],
)
def test_an_offset_is_sent_in_the_cycle_after_and_none_that_is_handed_over(
    states: list[int],
    offset_mm: list[float],
    expected: list[float],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Without P-CHAN-00818. What the interpolated positions take over is not on its way."""
    found = superposed(monkeypatch, states, offset_mm, is_optimized=False)
    assert found == pytest.approx(expected)
    if INACTIVE not in states and RUNNING_OUT not in states:
        now = superposed(monkeypatch, states, offset_mm, is_optimized=True)
        assert now == pytest.approx(offset_mm)


def test_where_the_model_has_no_offset_that_of_the_kernel_counts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    own, kernel = [1.0, np.nan, 3.0, np.nan, 5.0, 6.0], [9.0, 2.0, 9.0, 4.0, 5.5, 6.5]
    found = superposed(
        monkeypatch,
        [FOLLOWING, FOLLOWING, FOLLOWING, FOLLOWING, FROZEN, INACTIVE],
        own,
        kernel_mm=kernel,
        is_optimized=True,
    )
    assert found == pytest.approx([1.0, 2.0, 3.0, 4.0, 5.5, 6.5])


def test_a_way_whose_kinematic_went_before_it_was_chosen_keeps_what_was_there(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The first way squares until row 3, the second one has lost its kinematic in row 2."""
    squares = SimpleNamespace(
        until_ns=None, superposed=lambda poses, offsets: poses + np.asarray(offsets)[:, None] ** 2
    )
    ways = [(squares, slice(0, 3)), (way_of(7.0, until_ns=2 * MS), slice(3, 6))]
    found = superposed(monkeypatch, [FOLLOWING] * 6, [1.0, 2.0, 3.0, 3.0, 6.0, 1.5], ways=ways)
    assert found == pytest.approx([1.0, 4.0, 9.0, 9.0, 18.0, 4.5])


def way_of(gain: float, until_ns: int | None = None) -> Any:
    return SimpleNamespace(
        until_ns=until_ns,
        superposed=lambda poses, offsets: poses + gain * np.asarray(offsets)[:, None],
    )


def superposed(
    monkeypatch: pytest.MonkeyPatch,
    states: list[int],
    own_mm: list[float],
    kernel_mm: list[float] | None = None,
    ways: list[tuple[Any, slice]] | None = None,
    *,
    is_optimized: bool = True,
) -> list[float]:
    """What must be superposed on one axis in rows of 1 ms; own_mm: of the model of the judge."""
    state, count = np.array(states), len(states)

    class Truth(SimpleNamespace):
        def __getitem__(self, name: str) -> Any:
            assert name == "offset_mm"
            return np.array(own_mm if kernel_mm is None else kernel_mm)

    truth: Any = Truth(
        listed=SimpleNamespace(is_optimized=is_optimized),
        state=state,
        is_active=state == FOLLOWING,
        base=np.zeros((count, 1)),
        times_ns=np.arange(count) * MS,
        way_rows=lambda: ways or [(way_of(1.0), slice(0, count))],
    )
    walked = SimpleNamespace(offset_mm=np.array(own_mm))
    monkeypatch.setattr(tool_metrics.expected_offset, "walk", lambda _: walked)
    found: list[float] = tool_metrics._expected_superposed(truth)[:, 0].tolist()
    return found


# ---- of a recording made of formulas: what is found is what was written into it

U = tilted.direction(np.array([tilted.C_DEG]), np.array([tilted.A_DEG]))[0]
INCLINED = (0.0, np.sin(np.radians(20.0)), np.cos(np.radians(20.0)))
UNTIL = 600
"""The kinematic goes while the offset is there: its last row is the one before."""
AT = np.arange(tilted.ROWS)


def seen(
    mode: str = "ECS",
    columns: Mapping[str, Any] | None = None,
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0),
) -> Observed:
    """tilted.py with the kinematic on until 600 ms, and other or further columns."""
    table = tilted.trace(mode=mode)
    for name, values in (columns or {}).items():
        if name in table.column_names:
            table = table.drop_columns([name])
        table = table.append_column(name, pa.array(values))
    of = tilted.left(mode)
    assert of.distance_3d is not None
    guides = tuple(replace(guide, normal=normal) for guide in of.distance_3d.guides)
    on = (replace(of.kinematics[0], end_ns=UNTIL * MS),)
    of = replace(of, kinematics=on, distance_3d=replace(of.distance_3d, guides=guides))
    return Observed(of, kept(table))


def changed(name: str, **rows: float) -> dict[str, Any]:
    """A column of the recording with something added in these rows."""
    values = tilted.trace()[name].to_numpy().copy()
    for row, more in rows.items():
        values[int(row[1:])] += more
    return {name: values}


def value(of: Observed, metric: str) -> Any:
    return observe(of, parse_check(metric, "> -1e12", "")).value


@pytest.mark.parametrize("mode", ["ECS", "MCS"])
@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), INCLINED])
def test_how_the_offset_moves_the_tool_and_the_axes(
    mode: str, normal: tuple[float, float, float]
) -> None:
    """1.5 mm along u/u_z or Z in one cycle; the tool is two cycles late, 0.1 mm behind in Y."""
    of = seen(mode, normal=normal)
    way = 1.5 * (U / U[2] if mode == "ECS" else np.array([0.0, 0.0, 1.0]))
    late = way - (0.0, 0.1, 0.0)

    def across(what: Any) -> float:
        return float(np.linalg.norm(what - (what @ normal) * np.array(normal)))

    expected = {
        "tool_offset_path_mm": np.linalg.norm(late),
        "tool_offset_sideways_mm": across(late),
        **{f"tool_offset_{letter}_mm": late[k] for k, letter in enumerate("xyz")},
        "tool_sideways_um_max": 1e3 * across(way),
        **{
            f"superposed_{word}_max:{axis}": scale * abs(way[k])
            for word, scale in (("mm", 1.0), ("speed_mm_s", 1e3), ("acceleration_mm_s2", 1e6))
            for k, axis in enumerate("XYZ")
        },
    }
    found = {metric: value(of, metric) for metric in expected}
    assert found == {metric: pytest.approx(mm, abs=1e-9) for metric, mm in expected.items()}


def test_the_last_step_of_a_run_out_is_a_speed_and_what_off_hands_over_is_none() -> None:
    """1.5 mm run out by 0.1 mm a cycle, the last step is 0.6 mm, in the row that is off."""
    off = tilted.OFF
    state = np.where((AT >= tilted.ON) & (off > AT), 4, 0)
    state[off - 9 : off] = 3
    z_mm = np.where((AT >= tilted.STEP) & (off > AT), 1.5, 0.0)
    z_mm[off - 9 : off] -= 0.1 * np.arange(1, 10)
    z_mm[tilted.STEP : tilted.STEP + 15] = 0.1 * np.arange(15)
    columns = {"channel.distance_state": state, "Z.superposed_mm": z_mm}
    assert value(seen(columns=columns), "superposed_speed_mm_s_max:Z") == pytest.approx(600.0)
    state[off - 9 : off] = 4
    handed_over = {**columns, "channel.distance_state": state}
    assert value(seen(columns=handed_over), "superposed_speed_mm_s_max:Z") == pytest.approx(100.0)


def test_what_the_plc_sees_of_the_tool_is_judged_while_a_kinematic_is_on() -> None:
    tilt = np.where((AT < 50) | (AT > 650), np.nan, 35.0)
    tilt[320], tilt[650] = 41.5, 12.0
    length = np.where(AT > 640, np.nan, 80.0)
    length[640] = 77.0
    share = np.where((AT >= 300) & (AT < 690), 90.0, 20.0)
    share[500] = 40.0
    own = {"tilt_deg": tilt, "tool_length_mm": length, "axes_share_pct": share}
    of = seen(columns={f"channel.{name}": values for name, values in own.items()})
    assert value(of, "tool_tilt_end_deg") == 12.0
    assert value(of, "tool_tilt_deg_max") == 41.5
    assert value(of, "tool_length_end_mm") == 77.0
    assert value(of, "superposed_share_pct_min") == 40.0


@pytest.mark.parametrize(
    ("metric", "column", "unit"),
    [
        ("tool_length_error_um", "channel.tool_length_mm", 1e3),
        ("kinematic_error_nm", "gap.tcp_x_mm", 1e6),
        ("kinematic_error_nm", "gap.tcp_z_mm", 1e6),
        ("kinematic_error_nm", "gap.clamping_y_mm", 1e6),
    ],
)
def test_an_error_of_a_tool_is_the_largest_while_its_kinematic_is_on(
    metric: str, column: str, unit: float
) -> None:
    """In either direction; what is before and after it is none."""
    assert value(seen(), metric) == pytest.approx(0.0, abs=1e-9 * unit)
    columns = changed(column, r20=9.0, r50=0.001, r100=0.003, r400=-0.004, r599=0.002, r600=9.0)
    assert value(seen(columns=columns), metric) == pytest.approx(0.004 * unit, rel=1e-6)
    last = changed(column, r599=0.002)
    assert value(seen(columns=last), metric) == pytest.approx(0.002 * unit, rel=1e-6)


def test_the_height_that_the_control_uses_is_that_of_the_chains() -> None:
    """Surface and sensor of the CNC add up to the clamping point, from the cycle after ON on."""
    clamp = tilted.trace()["gap.clamping_z_mm"].to_numpy()
    sensor = 3.0 + 0.001 * AT
    for rows, error_nm in (({500: 2e-6, 450: -5e-6}, 5.0), ({300: 1.0, 690: 1.0, 20: 1.0}, 0.0)):
        surface = clamp - sensor
        for row, more in rows.items():
            surface[row] += more
        columns = {"channel.surface_cnc_mm": surface, "channel.sensor_mm": sensor}
        found = value(seen(columns=columns), "clamping_height_error_nm")
        assert found == pytest.approx(error_nm, abs=0.001)


def test_without_a_control_or_a_kinematic_each_metric_says_so() -> None:
    for of, word in (
        (Observed(replace(tilted.left(), distance_3d=None), kept(tilted.trace())), "control"),
        (Observed(replace(tilted.left(), kinematics=()), kept(tilted.trace())), "kinematic"),
    ):
        for metric in ("tool_offset_x_mm", "tool_sideways_um_max", "tool_offset_path_mm"):
            found = observe(of, parse_check(metric, "> -1e12", ""))
            assert found.value is None
            assert word in found.note


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_axis_that_is_off_by_most_increments_is_the_worst(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Y is off by most mm and C by most increments; each alone has its own."""
    per_unit = {"X": 10_000.0, "Y": 100.0, "Z": 1000.0, "C": 10_000.0, "A": 10.0}
    off = {"X.superposed_mm": 0.0005, "Y.superposed_mm": 0.02, "C.superposed_deg": 0.001}
    columns: dict[str, Any] = {}
    for name, error in off.items():
        columns |= changed(name, r200=0.5 * error, r150=side * error, r260=-0.25 * error)
    base = seen(columns=columns)
    axes = {
        name: replace(record, increments_per_mm=per_unit[name])
        for name, record in base.facts.axes.items()
    }
    of = Observed(replace(base.facts, axes=axes), base.series)
    own = tool.axes_of(seen(), tool_metrics.SUPERPOSED)
    monkeypatch.setattr(tool_metrics, "_expected_superposed", lambda _: own)
    expected = {"": 10.0, ":X": 5.0, ":Y": 2.0, ":Z": 0.0, ":C": 10.0, ":A": 0.0}
    found = {axis: value(of, f"superposed_error_increments{axis}") for axis in expected}
    assert found == {axis: pytest.approx(n, abs=1e-6) for axis, n in expected.items()}
