"""True motion inside a step: where a cubic is fastest, and set positions that are on the way."""

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.judge.observed.motion import motion, state_ahead, state_at
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord, PlantRecord, PlantValue
from axisrig.bench.record.facts import Facts, Timing
from axisrig.bench.record.series import Series
from axisrig.kernel.time.clock import MS


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("v_mm_s", "way_mm", "turn"),
    [
        ((0.0, 0.0), 1.0, 0.5),  # from rest to rest: 1.5 of its mean speed in the middle
        ((100.0, 40.0), 1.0, None),
        ((40.0, 100.0), 1.0, None),
        ((0.0, 40.0), 0.9, None),
    ],
)
def test_a_cubic_is_fastest_where_its_speed_turns(
    v_mm_s: tuple[float, float], way_mm: float, turn: float | None, sign: float
) -> None:
    """v(u) = v0 + 2 (3 w - 2 v0 - v1) u + 3 (v0 + v1 - 2 w) u^2 with w = way/h: a parabola whose
    turn is at -b/2c; the look ends before it, begins behind it, or has it inside.
    """
    h_s, (v0, v1) = 8e-3, v_mm_s
    mean = way_mm / h_s
    b, c = 2 * (3 * mean - 2 * v0 - v1), 3 * (v0 + v1 - 2 * mean)
    turns_at = -b / (2 * c)
    assert turn is None or turns_at == pytest.approx(turn)
    assert 0.0 < turns_at < 1.0
    times_ns = np.arange(4) * 8 * MS
    x = sign * np.array([-v0 * h_s, 0.0, way_mm, way_mm + v1 * h_s])
    found = motion(times_ns, x, sign * np.array([v0, v0, v1, v1]))
    for begin, end in ((0.0, 1.0), (0.0, 0.5 * turns_at), (0.5 + 0.5 * turns_at, 1.0)):
        places = [begin, end, *([turns_at] if begin <= turns_at <= end else [])]
        most = max(abs(v0 + b * u + c * u * u) for u in places)
        seen = found.fastest(round((1 + begin) * 8 * MS), round((1 + end) * 8 * MS))
        assert seen is not None
        assert seen.value == pytest.approx(most, rel=1e-6)


ROW, ROWS = 30, 34
WAY_MM, CORNER_MM, INCREMENT_MM = 0.003, 0.000375, 1e-3
KV_PER_S = 100.0
# Three cycles show a change of the acceleration, two are on the way (inferred), with those that
# the drive buffers
ON_THE_WAY = [
    (buffer, late, late <= 5 + buffer) for buffer in (0, 4) for late in (1, 4, 5 + buffer, 12)
]


def steady(buffer: int, late: int, *, plant: bool, share: float = 0.0) -> Observed:
    """3 mm/s, as the axis has gone in every row; the demand gets slower `late` rows before ROW."""
    ways_mm = np.full(ROWS, WAY_MM)
    ways_mm[ROW - late :] -= CORNER_MM
    speed_mm_s = WAY_MM / 1e-3 + 1e-6 * (-1.0) ** np.arange(ROWS)  # it trembles: not straight
    columns = {
        "truth_mm": WAY_MM * np.arange(ROWS),
        "velocity_mm_s": speed_mm_s,
        "set_mm": np.cumsum(ways_mm),
    }
    facts = Facts(
        *(Timing(MS, 0, buffer), 0, 0, 0, ""),
        axes={"Z": AxisRecord("can1", 1, 1.0 / INCREMENT_MM, plant="z" if plant else "")},
        plants={"z": PlantRecord({"feed_forward": PlantValue(share)}, kv_per_s=KV_PER_S)}
        if plant
        else {},
    )
    table = {f"Z.{name}": values for name, values in columns.items()}
    return Observed(facts, Series(pa.table({"time_ns": np.arange(ROWS) * MS, **table})))


@pytest.mark.parametrize(("buffer", "late", "counts"), ON_THE_WAY)
def test_a_corner_counts_as_long_as_it_may_be_on_its_way(
    buffer: int, late: int, counts: bool
) -> None:
    """Of a corner d the position loop makes kv d/8 of speed, a third of it is the doubt."""
    state = state_at(steady(buffer, late, plant=True), "Z", ROW * MS + MS // 3)
    assert state is not None
    corner_mm_s = KV_PER_S * CORNER_MM / 24.0
    assert (state.doubt_mm_s > 0.5 * corner_mm_s) is counts
    assert state.doubt_mm_s <= corner_mm_s * (1.0 + 1e-9)


@pytest.mark.parametrize("buffer", [0, 4])
@pytest.mark.parametrize(("before", "counts"), [(1, True), (3, True), (5, False), (8, False)])
def test_the_speed_ahead_may_change_by_what_is_on_its_way(
    buffer: int, before: int, counts: bool
) -> None:
    """An axis without a gain follows at once: d/T, beside an increment and what it trembles.

    Two cycles are on the way with those that the drive buffers, and a corner shows in the third
    difference of its own cycle and of the next one.
    """
    late = before + buffer
    ahead = state_ahead(steady(buffer, late, plant=False), "Z", ROW * MS + MS // 2)
    assert ahead is not None
    of_increment, of_corner = INCREMENT_MM / 1e-3, CORNER_MM / 1e-3
    assert ahead.doubt_mm_s == pytest.approx(
        of_increment + (of_corner if counts else 0.0), abs=1e-3
    )


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("before", [1, 8])
def test_a_loop_answers_what_comes_by_its_gain_and_its_feed_forward(
    before: int, share: float
) -> None:
    """A demand that is d further makes kv d of speed in the loop, and f d/T beside it."""
    ahead = state_ahead(steady(0, before, plant=True, share=share), "Z", ROW * MS + MS // 2)
    assert ahead is not None
    further_mm = INCREMENT_MM + (CORNER_MM if before == 1 else 0.0)
    assert ahead.doubt_mm_s == pytest.approx(further_mm * (KV_PER_S + share / 1e-3), rel=1e-3)
