"""What the corners of a demand make of the motion between two SYNCs, and how well that is known.

A drive goes on from one set position to the next at an even speed; a velocity loop rounds the
corners, alike in each step, so that a cubic through the SYNCs shows none of it.
"""

from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pytest
from scipy.linalg import expm

from axisrig.bench.judge.observed.motion import doubts_before, fastest, state_at
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.machine.recording.lag import largest_lag
from axisrig.bench.record.axes import AxisRecord, PlantRecord, PlantValue
from axisrig.bench.record.facts import Facts, Timing
from axisrig.bench.record.series import Series
from axisrig.kernel.time.clock import MS

Floats = npt.NDArray[np.float64]


@pytest.mark.parametrize("gain_mm_s2", [1000.0, -1000.0, 250.0])
def test_the_corners_of_a_demand_that_a_velocity_loop_rounds_are_within_three_doubts(
    gain_mm_s2: float,
) -> None:
    """Steps of 8 ms, kv 40/s, a velocity loop of 60 Hz: alike in each, at no SYNC to be seen."""
    kv_per_s, loop_s, part_s, parts, steps = 40.0, 1.0 / (2.0 * np.pi * 60.0), 2e-5, 400, 40
    times_s = np.arange(steps + 1) * 8e-3
    demand = 100.0 * times_s + gain_mm_s2 * times_s**2 / 2.0
    x, v, seen = 0.0, 0.0, []

    def slope(x: float, v: float, d: float) -> tuple[float, float]:
        return v, (kv_per_s * (d - x) - v) / loop_s

    for begin, end in pairwise(demand.tolist()):
        for part in range(parts):
            seen.append((x, v))
            d = begin + (end - begin) * (part + 0.5) / parts
            half = slope(x, v, d)
            ahead = slope(x + half[0] * part_s / 2.0, v + half[1] * part_s / 2.0, d)
            x, v = x + ahead[0] * part_s, v + ahead[1] * part_s
    known = np.array(seen)
    syncs = known[::parts]
    columns = {"truth_mm": syncs[:, 0], "velocity_mm_s": syncs[:, 1], "set_mm": demand[:-1]}
    facts = Facts(
        *(Timing(8 * MS, 0, 0), 0, 0, 0, ""),
        axes={"Z": AxisRecord("can1", 1, 1000.0, plant="z")},
        plants={"z": PlantRecord(kv_per_s=kv_per_s)},
    )
    table = {f"Z.{name}": values for name, values in columns.items()}
    times = np.arange(steps) * 8 * MS
    observed = Observed(facts, Series(pa.table({"time_ns": times, **table})))
    shares = []
    for part in range(parts * (steps - 3), parts * (steps - 2), 7):
        state = state_at(observed, "Z", round(part * part_s * 1e9))
        assert state is not None
        off_mm_s = abs(state.speed_mm_s - known[part, 1])
        assert abs(state.position_mm - known[part, 0]) <= 3.0 * state.doubt_mm + 1e-12
        assert off_mm_s <= 3.0 * state.doubt_mm_s + 1e-12
        shares.append(off_mm_s / max(state.doubt_mm_s, 1e-12))
    assert max(shares) > 0.3


@pytest.mark.parametrize("share", [1.0, 0.5, 0.0])
@pytest.mark.parametrize(
    ("period_ms", "bandwidth_hz"), [(1, 60.0), (2, 60.0), (8, 60.0), (2, 20.0)]
)
def test_the_largest_of_what_a_velocity_loop_makes_of_corners_is_within_its_doubt(
    share: float, period_ms: int, bandwidth_hz: float
) -> None:
    """800 mm/s2, then an even speed; feed-forward, kv 40/s and a velocity loop.

    Its course is alike in each step, so that the cubics through the SYNCs miss it in all of them.
    """
    kv_per_s, step_s, parts, ramp, steps = 40.0, period_ms * 1e-3, 192, 60, 70
    way_mm = 800.0 * step_s**2 * np.minimum(np.arange(steps), ramp)
    demand_mm = np.concatenate([[0.0], np.cumsum(way_mm)])
    known = answered(demand_mm, step_s, parts, kv_per_s, share, bandwidth_hz)
    syncs = known[::parts]
    columns = {"truth_mm": syncs[:, 0], "velocity_mm_s": syncs[:, 1]}
    # Set positions are sent in the cycle before the SYNC from which they are the end of the demand
    columns["set_mm"] = np.append(demand_mm[2:], demand_mm[-1] + way_mm[-1])
    values = {"feed_forward": PlantValue(share), "velocity_bandwidth": PlantValue(bandwidth_hz)}
    facts = Facts(
        *(Timing(period_ms * MS, 0, 0), 0, 0, 0, ""),
        axes={"Z": AxisRecord("can1", 1, 1000.0, plant="z")},
        plants={"z": PlantRecord(kv_per_s=kv_per_s, values=values)},
    )
    times_ns = np.arange(steps) * period_ms * MS
    table = {f"Z.{name}": values for name, values in columns.items()}
    observed = Observed(facts, Series(pa.table({"time_ns": times_ns, **table})))

    for end in (ramp - 2, steps - 1):  # while it gets faster, and all of it
        speed = fastest(observed, "Z", 0, int(times_ns[end]))
        assert speed is not None
        assert abs(speed.value - np.max(known[: end * parts + 1, 1])) <= speed.doubt + 1e-9
    tick_ns = 250_000 if period_ms > 1 else 125_000
    lag_mm = largest_lag(times_ns, (demand_mm[:-1], syncs[:, 0], syncs[:, 1]), tick_ns)
    places = np.arange(len(known)) / parts
    true_mm = np.abs(np.interp(places, np.arange(steps + 1), demand_mm) - known[:, 0])
    every = parts * tick_ns // (period_ms * MS)
    doubts_mm = doubts_before(observed, "Z", 0, steps)
    shares = []
    for row in range(ramp // 2, ramp):  # the loop has come to its lag of even acceleration
        most_mm = max(true_mm[(row - 1) * parts + every : row * parts + 1 : every])
        missed_mm = abs(lag_mm[row] - most_mm)
        assert missed_mm <= doubts_mm[row] + 1e-9
        shares.append(missed_mm / doubts_mm[row])
    assert share < 1.0 or period_ms > 2 or max(shares) > 0.3, "far too careful"


def answered(
    demand_mm: Floats, step_s: float, parts: int, kv_per_s: float, share: float, hz: float
) -> Floats:
    """Place and speed of an axis at parts of each step, shape (n, 2).

    The speed demanded is share u + kv (d - x) with the slope u of the demand d. The velocity loop
    is that of the models: gain 2 pi hz, 8 ms of integral time, a current loop of 800 Hz. Exactly
    from part to part: u is constant in a step, a linear system with a constant input.
    """
    w, dt, integral_s, current_s = 2.0 * np.pi * hz, step_s / parts, 8e-3, 1.0 / (1600.0 * np.pi)
    error = np.array([kv_per_s, -1.0, 0.0, 0.0, share])  # of the speed
    matrix = np.zeros((5, 5))  # d - x, v, acceleration, integral, u
    matrix[0, [1, 4]] = -1.0, 1.0
    matrix[1, 2] = 1.0
    matrix[2] = w * error / current_s
    matrix[2, [2, 3]] += -1.0 / current_s, w / current_s
    matrix[3] = error / integral_s
    once = expm(matrix * dt)
    state, found = np.zeros(5), []
    for begin, end in pairwise(demand_mm.tolist()):
        state[4] = (end - begin) / step_s
        for part in range(parts):
            d = begin + (end - begin) * part / parts
            found.append((d - state[0], state[1]))
            state = once @ state
    return np.array(found)


@pytest.mark.parametrize(("late", "is_known"), [(0, True), (1, False)])
def test_a_corner_that_is_not_on_its_way_yet_puts_nothing_in_doubt(
    late: int, is_known: bool
) -> None:
    """Braking that the CNC sends in the cycle of the step acts at the next SYNC at the earliest.

    At 3 mm/s a corner d of 0.375 um, kv 100/s: kv d/24 = 0.0015625 mm/s. The axis trembles by
    1 nm/s, so that it does not go straight.
    """
    row, rows = 20, 24
    way_mm = np.full(rows, 0.003)
    way_mm[row - late] -= 0.000375
    set_mm = np.cumsum(way_mm)
    syncs = 0.003 * np.arange(rows)
    speed_mm_s = 3.0 + 1e-6 * (-1.0) ** np.arange(rows)
    columns = {"truth_mm": syncs, "velocity_mm_s": speed_mm_s, "set_mm": set_mm}
    facts = Facts(
        *(Timing(MS, 0, 0), 0, 0, 0, ""),
        axes={"Z": AxisRecord("can1", 1, 1000.0, plant="z")},
        plants={"z": PlantRecord(kv_per_s=100.0)},
    )
    table = {f"Z.{name}": values for name, values in columns.items()}
    observed = Observed(facts, Series(pa.table({"time_ns": np.arange(rows) * MS, **table})))
    state = state_at(observed, "Z", row * MS + MS // 3)
    assert state is not None
    corner_mm_s = 100.0 * 0.000375 / 24.0
    if is_known:
        assert 0.0 < state.doubt_mm_s < 0.01 * corner_mm_s
    else:
        assert state.doubt_mm_s == pytest.approx(corner_mm_s)
