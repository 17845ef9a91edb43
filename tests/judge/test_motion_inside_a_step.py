"""True motion inside a step: where a cubic is fastest, and set positions that are on the way."""

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.judge.observed.motion import (
    Largest,
    Motion,
    is_straight,
    motion,
    state_ahead,
    state_at,
)
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


# What a look takes of its steps


TIMES_NS = np.arange(5) * MS
PLACES_MM, SPEEDS_MM_S = np.arange(5) * 0.01, np.full(5, 10.0)
DOUBTS_MM, DOUBTS_MM_S = np.array([0.8, 0.4, 0.2, 0.1]), np.array([9.0, 5.0, 3.0, 2.0])
GOES = Motion(TIMES_NS, PLACES_MM, SPEEDS_MM_S, DOUBTS_MM, DOUBTS_MM_S)


@pytest.mark.parametrize(
    ("begin_ns", "end_ns", "steps"),
    [
        (0, 4 * MS, (0, 4)),
        (1 * MS, 2 * MS, (1, 2)),  # from one SYNC to the next
        (1 * MS - 1, 2 * MS, (0, 2)),
        (1 * MS, 2 * MS + 1, (1, 3)),
        (1 * MS + 1, 2 * MS - 1, (1, 2)),
        (3 * MS, 9 * MS, (3, 4)),
        (3 * MS, 4 * MS, (3, 4)),
        (-5, 1 * MS, (0, 1)),
    ],
)
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_look_has_the_doubts_of_its_own_steps(
    begin_ns: int, end_ns: int, steps: tuple[int, int], side: float
) -> None:
    """10 mm/s all along: 0.01 mm a step from 0, or to it."""
    goes = Motion(TIMES_NS, side * PLACES_MM, side * SPEEDS_MM_S, DOUBTS_MM, DOUBTS_MM_S)
    own = slice(*steps)
    assert goes.fastest(begin_ns, end_ns) == pytest.approx((10.0, max(DOUBTS_MM_S[own])))
    far = goes.farthest(0.0, begin_ns, end_ns)
    assert far is not None
    most_mm = min(end_ns, 4 * MS) * 1e-9 * 10.0
    assert far.value == pytest.approx(most_mm)
    # Of an earlier step with more doubt its own end may be it as well
    ends_mm = np.minimum(np.arange(1, 5) * 0.01, most_mm)[own]
    assert far.doubt == pytest.approx(
        max(max(ends_mm + DOUBTS_MM[own]) - most_mm, DOUBTS_MM[own][-1])
    )
    assert far.value != 0.0


def test_a_look_behind_all_rows_or_at_no_step_has_none() -> None:
    assert GOES.at(4 * MS + 1) is None
    assert GOES.at(-1) is None
    assert GOES.at(4 * MS) == (0.04, 10.0, 0.0, 0.0)
    short = Motion(TIMES_NS[:1], PLACES_MM[:1], SPEEDS_MM_S[:1], DOUBTS_MM[:0], DOUBTS_MM_S[:0])
    assert short.fastest(0, MS) is None
    assert short.farthest(0.0, 0, MS) is None
    assert isinstance(GOES.fastest(0, MS), Largest)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("mean_mm_s", "off_mm_s", "straight"),
    [
        # 1e-9 of the speed, and of 1 mm/s at least
        (0.0, 0.8e-9, True), (0.0, 1.3e-9, False), (0.01, 0.8e-9, True), (0.01, 1.3e-9, False),
        (100.0, 0.8e-7, True), (100.0, 1.3e-7, False),
    ],
)  # fmt: skip
def test_a_step_is_straight_by_the_rounding_of_its_speed(
    mean_mm_s: float, off_mm_s: float, straight: bool, sign: float
) -> None:
    """The way is the speed at one of the ends times the time; the other end is far off."""
    x = sign * np.array([0.0, mean_mm_s * 8e-3])
    for ends in ((mean_mm_s + off_mm_s, mean_mm_s + 5.0), (mean_mm_s - 5.0, mean_mm_s - off_mm_s)):
        found = is_straight(np.array([8e-3]), x, sign * np.array(ends))
        assert found.tolist() == [straight], ends
