"""True motion between two SYNCs: where it turns, uneven steps, and whose doubt counts where."""

from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.judge.observed.motion import (
    doubts_before,
    farthest,
    fastest,
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

ROWS = 24
TIMES_NS = np.arange(ROWS) * MS


def observed(
    x: Any, v: Any, set_mm: Any = None, buffer: int = 0, per_mm: float = 1000.0, **of_plant: Any
) -> Observed:
    columns = {"truth_mm": x, "velocity_mm_s": v}
    columns |= {} if set_mm is None else {"set_mm": set_mm}
    values = {name: PlantValue(of_plant.pop(name)) for name in list(of_plant) if name != "kv_per_s"}
    facts = Facts(
        *(Timing(MS, 0, buffer), 0, 0, 0, ""),
        axes={"Z": AxisRecord("can1", 1, per_mm, plant="z")},
        plants={"z": PlantRecord(values, **of_plant)},
    )
    table = {f"Z.{name}": np.asarray(values, dtype=float) for name, values in columns.items()}
    return Observed(facts, Series(pa.table({"time_ns": TIMES_NS[: len(x)], **table})))


# Where it turns


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("v_mm_s", [10.0, 3.0])
def test_an_axis_that_turns_within_a_step_was_farthest_there(v_mm_s: float, side: float) -> None:
    """A parabola from v to -v in a step h: at h/2 it is v h/4 away, whichever way it went."""
    x = np.array([-1.5 * v_mm_s, -0.0, 0.0, -1.5 * v_mm_s]) * 1e-3
    goes = motion(TIMES_NS[:4], side * x, side * v_mm_s * np.array([2.0, 1.0, -1.0, -2.0]))
    found = goes.farthest(0.0, MS, 2 * MS)
    assert found is not None
    assert found.value == pytest.approx(v_mm_s * 1e-3 / 4.0)
    at = goes.at(MS + MS // 2)
    assert at is not None
    assert at.position_mm == pytest.approx(side * v_mm_s * 1e-3 / 4.0)
    assert at.speed_mm_s == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("first", "second"), [(0.25, 0.75), (0.1, 0.6), (-0.5, 0.3), (0.4, 2.0)])
def test_a_cubic_was_farthest_where_it_turns(first: float, second: float, side: float) -> None:
    """v = 6 (t - first) (t - second) in steps; from one turn, or one end, to the others."""

    def x(t: Any) -> Any:
        return side * (2.0 * t**3 - 3.0 * (first + second) * t**2 + 6.0 * first * second * t)

    ends = np.array([0.0, 1.0])
    goes = motion(TIMES_NS[:2], x(ends), side * 6.0 * (ends - first) * (ends - second) / 1e-3)
    places = np.append(ends, [t for t in (first, second) if 0.0 < t < 1.0])
    for start in x(places):
        found = goes.farthest(float(start), 0, MS)
        assert found is not None
        assert found.value == pytest.approx(np.max(np.abs(x(places) - start)), abs=1e-12)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_look_that_ends_at_a_sync_has_nothing_of_the_step_behind_it(side: float) -> None:
    """The speed jumps behind row 12: what is in doubt there is no part of what ended there."""
    v = np.where(np.arange(ROWS) <= 12, 10.0, 40.0 + 9.0 * (-1.0) ** np.arange(ROWS))
    x = np.concatenate([[0.0], np.cumsum((v[1:] + v[:-1]) * 0.5e-3)])
    goes = motion(TIMES_NS, side * x, side * v)
    inside = slice(5, 12)
    assert goes.doubts_mm_s[12] > 2.0 * np.max(goes.doubts_mm_s[inside])
    fast, far = goes.fastest(5 * MS, 12 * MS), goes.farthest(0.0, 5 * MS, 12 * MS)
    assert fast is not None
    assert far is not None
    assert fast.value == pytest.approx(10.0)
    assert fast.doubt == pytest.approx(float(np.max(goes.doubts_mm_s[inside])))
    assert far.doubt <= float(np.max(goes.doubts_mm[inside]))


# What is straight, and what explains itself


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("far_mm", [0.0, 1e4, 1e7])
def test_a_step_is_straight_as_far_from_0_on_both_sides(far_mm: float, side: float) -> None:
    """Both positions are known to half a spacing of their digits, of one in mm twice of that."""
    x = side * (far_mm + np.array([0.0, 1e-3, 2e-3]))
    spacing_mm = float(np.spacing(np.abs(x)).max())
    mean = np.diff(x) / 1e-3
    rounding = 1e-9 + 2.0 * spacing_mm / 1e-3
    for share, straight in ((0.9, True), (1.2, False)):
        ends = np.array([mean[0] + share * rounding, mean[0] + 5.0, mean[1] + 5.0])
        found = is_straight(np.full(2, 1e-3), x, ends)
        assert found.tolist() == [straight, False]


@pytest.mark.parametrize("steps_us", [(1000, 1000, 1000), (700, 1300, 900), (2000, 500, 1500)])
def test_a_cubic_explains_itself_in_steps_of_any_lengths(steps_us: tuple[int, ...]) -> None:
    """x = 2 + 30 t - 900 t^2 + 2e5 t^3: nothing is left in doubt, wherever the SYNCs are."""
    times_ns = np.concatenate([[0], np.cumsum(np.tile(steps_us, 3)) * 1000])
    t = times_ns * 1e-9
    x = 2.0 + 30.0 * t - 900.0 * t**2 + 2e5 * t**3
    goes = motion(times_ns, x, 30.0 - 1800.0 * t + 6e5 * t**2)
    assert goes.doubts_mm == pytest.approx(0.0, abs=1e-12)
    assert goes.doubts_mm_s == pytest.approx(0.0, abs=1e-8)


@pytest.mark.parametrize("row", [2, 7, 15, ROWS - 3])
def test_the_doubt_of_an_instant_is_that_of_its_step_in_the_whole_motion(row: int) -> None:
    """The rows behind the end of the step count as those before it do."""
    at = np.arange(ROWS)
    v = 10.0 + 2.0 * np.sin(1.3 * at) + np.where(at == row + 2, 7.0, 0.0)
    x = np.concatenate([[0.0], np.cumsum((v[1:] + v[:-1]) * 0.5e-3)]) + 1e-4 * np.cos(2.1 * at)
    whole = motion(TIMES_NS, x, v)
    found = state_at(observed(x, v), "Z", row * MS + MS // 3)
    assert found is not None
    assert found.doubt_mm == pytest.approx(whole.doubts_mm[row])
    assert found.doubt_mm_s == pytest.approx(whole.doubts_mm_s[row])
    before = doubts_before(observed(x, v), "Z", 0, ROWS)
    assert before[1:] == pytest.approx(whole.doubts_mm)
    assert before[0] == 0.0


# What is ahead


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("gain_mm_s2", [0.0, 500.0, -800.0])
@pytest.mark.parametrize("part", [0.25, 0.9])
def test_an_axis_ahead_goes_on_with_the_acceleration_that_it_had(
    gain_mm_s2: float, part: float, side: float
) -> None:
    """x + v t + a t^2/2 and v + a t, of the row before."""
    t = TIMES_NS * 1e-9
    x, v = side * (10.0 * t + 0.5 * gain_mm_s2 * t**2), side * (10.0 + gain_mm_s2 * t)
    ahead = state_ahead(observed(x, v, set_mm=x), "Z", round((15 + part) * MS))
    assert ahead is not None
    since_s = (15 + part) * 1e-3
    assert ahead.position_mm == pytest.approx(
        side * (10.0 * since_s + 0.5 * gain_mm_s2 * since_s**2), abs=1e-12
    )
    assert ahead.speed_mm_s == pytest.approx(side * (10.0 + gain_mm_s2 * since_s))


def test_what_is_in_doubt_ahead_adds_up_and_grows_with_the_time() -> None:
    """The doubt of the step before, and what the speed may change by; of the place for a time."""
    at = np.arange(ROWS)
    v = 10.0 + 0.5 * (-1.0) ** at
    x = 0.01 * at
    of = observed(x, v, set_mm=x)
    first, second = (state_ahead(of, "Z", round((15 + part) * MS)) for part in (0.2, 0.8))
    assert first is not None
    assert second is not None
    whole = motion(TIMES_NS[12:16], x[12:16], v[12:16])
    # Second differences of the speed of 2 mm/s, and an increment of 1 um at once in a cycle
    change_mm_s = 2.0 + 1.0
    assert whole.doubts_mm_s[-1] > 0.0
    for found, part in ((first, 0.2), (second, 0.8)):
        assert found.doubt_mm_s == pytest.approx(whole.doubts_mm_s[-1] + change_mm_s)
        assert found.doubt_mm == pytest.approx(whole.doubts_mm[-1] + change_mm_s * part * 1e-3)


def test_a_loop_without_gain_follows_at_once() -> None:
    """As one of which no gain is known: an increment in a cycle."""
    x, v = 0.01 * np.arange(ROWS), np.full(ROWS, 10.0)
    doubts = []
    for kv_per_s in (None, 0.0, 50.0):
        ahead = state_ahead(observed(x, v, set_mm=x, kv_per_s=kv_per_s), "Z", 15 * MS + MS // 2)
        assert ahead is not None
        doubts.append(ahead.doubt_mm_s)
    assert doubts == pytest.approx([1.0, 1.0, 0.05])


# What a velocity loop rounds, alike in each step


KV_PER_S, HZ = 100.0, 60.0


def rounded(
    corner_row: int, share: float = 0.0, hz: float = HZ, buffer: int = 0
) -> tuple[Observed, float]:
    """An axis that trembles by 1 nm/s; its demand has one corner of 0.375 um. With its left g."""
    corner_mm, way_mm = 0.000375, np.full(ROWS, 0.003)
    way_mm[corner_row:] -= corner_mm
    v = 3.0 + 1e-6 * (-1.0) ** np.arange(ROWS)
    of = observed(0.003 * np.arange(ROWS), v, np.cumsum(way_mm), buffer, kv_per_s=KV_PER_S,
                  feed_forward=share, velocity_bandwidth=hz)  # fmt: skip
    per_s, b = 2.0 * np.pi / 1e-3, 2.0 * np.pi * hz
    asked = float(np.sqrt(share**2 + (KV_PER_S / per_s) ** 2))
    return of, corner_mm / 8.0 * asked * b / float(np.sqrt(per_s**2 + b**2))


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("hz", [20.0, 60.0, 400.0])
def test_what_a_velocity_loop_leaves_of_a_corner_is_in_doubt_of_way_and_speed(
    share: float, hz: float
) -> None:
    """d/8 g of way and w d/8 g of speed, g = sqrt(f^2 + (kv/w)^2) b/sqrt(w^2 + b^2)."""
    of, left_mm = rounded(10, share, hz)
    fast, far = fastest(of, "Z", 11 * MS, 12 * MS), farthest(of, "Z", 0.0, 11 * MS, 12 * MS)
    assert fast is not None
    assert far is not None
    assert far.doubt == pytest.approx(left_mm, rel=1e-6)
    assert fast.doubt == pytest.approx(2.0 * np.pi / 1e-3 * left_mm, rel=1e-6)


@pytest.mark.parametrize("buffer", [0, 3])
@pytest.mark.parametrize("corner_row", [5, 9])
def test_a_corner_is_in_doubt_in_the_steps_in_which_it_may_act(
    corner_row: int, buffer: int
) -> None:
    """Sent in its row, it acts from the next SYNC on, five cycles and those of the buffer."""
    of, left_mm = rounded(corner_row, buffer=buffer)
    doubts = doubts_before(of, "Z", 0, ROWS)  # of the step that ends in a row
    in_doubt = np.flatnonzero(doubts > 0.5 * left_mm)
    first, last = corner_row + 2, corner_row + 2 + 5 + buffer
    assert in_doubt.tolist() == list(range(first, last))


@pytest.mark.parametrize("buffer", [0, 3])
def test_a_look_at_one_step_finds_the_corners_that_may_act_in_it(buffer: int) -> None:
    """From row 15 to 16: those of the five rows before row 14, and of as many as are buffered."""
    counts = []
    for corner_row in range(3, 17):
        of, left_mm = rounded(corner_row, buffer=buffer)
        fast = fastest(of, "Z", 15 * MS, 16 * MS)
        assert fast is not None
        counts.append(fast.doubt > np.pi / 1e-3 * left_mm)
    rows = np.flatnonzero(counts) + 3
    assert rows.tolist() == list(range(10 - buffer, 15))
