"""True motion between two SYNCs: what a cubic finds, and how well it says that it knows it."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pytest

from axisrig.bench.judge.observed.motion import (
    Motion,
    farthest,
    fastest,
    largest,
    motion,
    state_ahead,
    state_at,
)
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord, PlantRecord, PlantValue
from axisrig.bench.record.facts import Facts, Timing
from axisrig.bench.record.series import Series
from axisrig.kernel.time.clock import MS

Floats = npt.NDArray[np.float64]
Curve = Callable[[Floats], Floats]
STEP_NS = 8 * MS
VARIES = 1.25
"""The fourth derivative of half a radian in a step is not the same in two steps."""


def sampled(place: Curve, speed: Curve, rows: int = 6) -> Motion:
    """SYNCs every 8 ms of a motion over the time in steps, mm and mm/step."""
    n = np.arange(rows, dtype=np.float64)
    return motion(np.arange(rows) * STEP_NS, place(n), speed(n) / (STEP_NS * 1e-9))


def worst_shares(place: Curve, speed: Curve) -> tuple[float, float]:
    """Largest error in the step from 2 to 3, of position and speed, over the doubt there."""
    found, step_s = sampled(place, speed), STEP_NS * 1e-9
    inside = np.linspace(2.0, 3.0, 101)[1:-1]
    states = [found.at(round(at * STEP_NS)) for at in inside]
    x, v = place(inside), speed(inside) / step_s
    off_mm = max(abs(s.position_mm - a) for s, a in zip(states, x, strict=True) if s)
    off_mm_s = max(abs(s.speed_mm_s - a) for s, a in zip(states, v, strict=True) if s)
    return off_mm / float(found.doubts_mm[2]), off_mm_s / float(found.doubts_mm_s[2])


@pytest.mark.long
@pytest.mark.parametrize("power", [2, 3])
def test_a_jump_of_acceleration_or_jerk_is_within_three_doubts_and_beyond_one(power: int) -> None:
    """Sums of (t - s)^n from s on; the jump of the acceleration, n = 2, is the worst one."""
    shares = []
    for s in np.linspace(2.001, 2.999, 200):
        shares.append(
            worst_shares(
                lambda t, s=s: np.maximum(t - s, 0.0) ** power,
                lambda t, s=s: power * np.maximum(t - s, 0.0) ** (power - 1),
            )
        )
    of_place, of_speed = np.max(shares, axis=0)
    assert of_place <= 3
    assert of_speed <= 3
    if power == 2:
        assert of_place > 1.0
        assert of_speed > 1.0


@pytest.mark.parametrize("angle", [0.1, 0.5, 1.0, 2.0, 3.0])
def test_a_vibration_of_up_to_half_a_period_in_a_step_is_within_three_doubts(angle: float) -> None:
    for phase in np.linspace(0.0, np.pi, 60):
        of_place, of_speed = worst_shares(
            lambda t, phase=phase: np.sin(angle * t + phase),
            lambda t, phase=phase: angle * np.cos(angle * t + phase),
        )
        assert of_place <= 3
        assert of_speed <= 3


@pytest.mark.parametrize("ratio", [0.2, 0.4, 1.0, 2.0, 3.0, 8.0, 20.0, 50.0])
def test_a_demand_that_gets_faster_at_each_sync_is_within_three_doubts(
    ratio: float,
) -> None:
    """The demand has the speed n in step n, the axis follows with tau, a step is tau * ratio.

    It is behind by the same at every SYNC, so that neighbours show nothing of what is between.
    """
    q = np.exp(-ratio)
    late = 1.0 / (1.0 - q)  # demand less speed just after a SYNC, when it is as large each time

    def speed(t: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        n = np.floor(t + 1e-9)
        return n - late * np.exp(-ratio * (t - n))

    def place(t: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        n = np.floor(t + 1e-9)
        whole = n * (n - 1) / 2 - n * late * (1 - q) / ratio
        return whole + n * (t - n) - late * (1 - np.exp(-ratio * (t - n))) / ratio

    of_place, of_speed = worst_shares(place, speed)
    assert of_place <= 3
    assert of_speed <= 3


@pytest.mark.parametrize("begin", [3.0, 3.0 + 1e-6, 3.3])
@pytest.mark.parametrize("angle", [0.0, 0.1, 0.5])
def test_a_brake_behind_a_step_takes_nothing_from_what_is_known_of_it(
    begin: float, angle: float
) -> None:
    """A motion with a slow vibration is known from 2 to 3 as it is without the brake after it."""

    def doubts(brake: float) -> tuple[float, float]:
        found = sampled(
            lambda t: np.sin(angle * t) + brake * np.maximum(t - begin, 0.0) ** 2,
            lambda t: angle * np.cos(angle * t) + 2 * brake * np.maximum(t - begin, 0.0),
        )
        return float(found.doubts_mm[2]), float(found.doubts_mm_s[2])

    free, braked = doubts(0.0), doubts(1.0)
    # Of t^4 the past leaves W = 12 and D = 4, 16/3 by a third of 4 D, the row at the begin 4: of
    # that 4/27 and 1, where the neighbours leave 0.05 x 4 and 0.25 x 4
    assert braked[0] <= 4 / 27 * 16 / 3 / 0.2 * free[0] * VARIES + 1e-12
    assert braked[1] <= 16 / 3 * free[1] * VARIES + 1e-9


@pytest.mark.parametrize("seed", range(20))
def test_an_acceleration_of_one_sign_is_within_three_doubts(seed: int) -> None:
    """Jumps of acceleration and jerk at any instants of the step, one that may be after it."""
    random = np.random.default_rng(seed)
    begins, blows = random.uniform(2.0, [3.0, 3.0, 3.0, 5.0]), random.uniform(0.0, 1.0, 4)
    powers = random.integers(2, 4, 4)

    def place(t: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        ways = np.maximum(t[:, None] - begins, 0.0) ** powers
        return np.asarray(ways @ blows)

    def speed(t: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        speeds = powers * np.maximum(t[:, None] - begins, 0.0) ** (powers - 1)
        return np.asarray(speeds @ blows)

    of_place, of_speed = worst_shares(place, speed)
    assert of_place <= 3
    assert of_speed <= 3


def braked(rows: int = 20, blocks: int = 1) -> Observed:
    """Z with 60 mm/s from 100 mm down, 5000 mm/s2 against it from 20 ms on: it comes back."""
    times = np.arange(rows, dtype=np.int64) * STEP_NS
    t = times * 1e-9
    after = np.maximum(t - 0.02, 0.0)
    table = pa.table(
        {
            "time_ns": times,
            "Z.truth_mm": 100.0 - 60.0 * t + 2500.0 * after**2,
            "Z.velocity_mm_s": -60.0 + 5000.0 * after,
        }
    )
    facts = Facts(Timing(STEP_NS, 0, 0), 0, 0, 0, "", axes={"Z": AxisRecord("can1", 1, 1.0)})
    return Observed(facts, Series(table))


def test_the_farthest_place_and_the_speed_are_those_between_two_syncs() -> None:
    """Contact at 99.5 mm, 8.333 ms; v^2/2a = 0.36 mm on from 98.8, at 32 ms + ... = a SYNC + 0."""
    observed = braked()
    touch = state_at(observed, "Z", 8_333_333)
    assert touch is not None
    assert touch.position_mm == pytest.approx(99.5, abs=1e-6)
    assert touch.speed_mm_s == pytest.approx(-60.0, abs=1e-6)
    # 100 - 1.2 - 0.36 = 98.44 at 32 ms; until 30 ms it is 98.45
    for end_ns, way_mm in ((32 * MS, 1.06), (30 * MS, 1.05), (28 * MS, 1.02)):
        found = farthest(observed, "Z", 99.5, 8_333_333, end_ns)
        assert found is not None
        # The brake begins in the middle of a step: 0.0162 of its 5000 mm/s2 in 8 ms
        assert found.value == pytest.approx(way_mm, abs=1e-9)
    inside = farthest(observed, "Z", 99.5, 8_333_333, 21 * MS)
    assert inside is not None
    assert abs(inside.value - (0.7 + 0.06 - 0.0025)) <= 3 * inside.doubt
    # 60 mm/s are at the begin, the axis has -60 + 5000 x 0.024 = 60 at 44 ms, 64 a bit later
    fast = fastest(observed, "Z", 0, 44 * MS + 800_000)
    assert fast is not None
    assert fast.value == pytest.approx(64.0, abs=1e-6)
    down = fastest(observed, "Z", 0, 16 * MS)
    assert down is not None
    assert down.value == pytest.approx(60.0, abs=1e-6)


def test_an_axis_that_goes_straight_is_known_exactly_and_no_faster_than_it_went() -> None:
    """Speeds of the steps 0, 10, 25, 25, 5 mm/s; the row at the end of a step has its speed."""
    speeds = np.array([0.0, 0.0, 10.0, 25.0, 25.0, 5.0])
    x = np.cumsum(speeds) * 8e-3
    times = np.arange(6) * STEP_NS
    found = motion(times, x, speeds)
    assert found.fastest(0, 5 * STEP_NS) == (25.0, 0.0)
    state = found.at(2 * STEP_NS + STEP_NS // 4)
    assert state is not None
    assert state == pytest.approx((x[2] + 25.0 * 2e-3, 25.0, 0.0, 0.0))


def test_a_short_straight_step_far_from_zero_is_straight_all_the_same() -> None:
    """At 0.2 mm/s in steps of 1 us a position has but 8 digits of the way: its rounding counts."""
    times = np.arange(9) * 1000
    speeds = np.where(np.arange(9) > 4, 0.2, 0.0)
    x = 1e3 * (0.3200001 + np.cumsum(speeds) * 1e-9)
    found = motion(times, x, speeds).fastest(0, 8000)
    assert found is not None
    assert found.value == pytest.approx(0.2, abs=1e-6)


def test_behind_the_last_sync_nothing_is_known() -> None:
    observed = braked(rows=3)
    assert state_at(observed, "Z", 16 * MS) is not None
    assert state_at(observed, "Z", 16 * MS + 1) is None
    assert farthest(observed, "Z", 100.0, 17 * MS, 18 * MS) is None


def test_a_long_time_is_looked_at_in_parts() -> None:
    """A dip of 2 mm between two SYNCs, in the fifth thousand of rows."""
    rows, dip = 9000, 8191
    v = np.zeros(rows)
    v[dip], v[dip + 1] = -1000.0, 1000.0
    # A cubic from 0 with -v to 0 with +v goes to -v h/4
    table = pa.table(
        {
            "time_ns": np.arange(rows, dtype=np.int64) * STEP_NS,
            "Z.truth_mm": np.zeros(rows),
            "Z.velocity_mm_s": v,
        }
    )
    facts = Facts(Timing(STEP_NS, 0, 0), 0, 0, 0, "", axes={"Z": AxisRecord("can1", 1, 1.0)})
    found = farthest(Observed(facts, Series(table)), "Z", 0.0, 0, rows * STEP_NS)
    assert found is not None
    assert found.value == pytest.approx(1000.0 * 8e-3 / 4)


INCREMENT_MM = 1e-5


def driven(kv_per_s: float | None, share: float, set_mm: Floats) -> tuple[Observed, Floats]:
    """Return an axis x' = kv (d - x) + f d', and its speeds 100 us apart behind its last row.

    d is straight between the SYNCs and in whole increments; without a gain x = d. A row has the set
    position that d reaches two SYNCs later.
    """
    demand = np.round(set_mm[:-1] / INCREMENT_MM) * INCREMENT_MM
    rates, part_s = np.diff(demand) / 1e-3, np.arange(1, 11) * 1e-4
    x, v = [float(demand[0])], [0.0]
    inside = np.zeros(0)
    for begin, rate in zip(demand, rates, strict=False):
        if kv_per_s is None:
            inside = np.full(len(part_s), rate)
            places = begin + rate * part_s
        else:
            lag = (1.0 - share) * rate / kv_per_s
            left = (x[-1] - begin + lag) * np.exp(-kv_per_s * part_s)
            places = begin + rate * part_s - lag + left
            inside = rate - kv_per_s * left
        x.append(float(places[-1]))
        v.append(float(inside[-1]))
    columns = {"truth_mm": x[:-1], "velocity_mm_s": v[:-1], "set_mm": set_mm[2:]}
    table = {f"Z.{name}": values for name, values in columns.items()}
    values = {"feed_forward": PlantValue(share)}
    facts = Facts(
        *(Timing(MS, 0, 0), len(x) * MS, 0, len(x) * MS, ""),
        axes={"Z": AxisRecord("can1", 1, 1.0 / INCREMENT_MM, plant="z")},
        plants={"z": PlantRecord(kv_per_s=kv_per_s, values=values)},
    )
    times = np.arange(len(x) - 1) * MS
    return Observed(facts, Series(pa.table({"time_ns": times, **table}))), inside


@pytest.mark.parametrize(("kv_per_s", "share"), [(40.0, 0.0), (40.0, 0.5), (None, 0.0)])
@pytest.mark.parametrize("slip", range(-3, 4))
def test_the_speed_ahead_is_known_to_what_a_drive_makes_of_an_increment(
    kv_per_s: float | None, share: float, slip: int
) -> None:
    """A steady feed of 49.97 increments in a cycle: one of 33 is shorter, in whichever step."""
    rows = 400 + slip
    observed, speeds = driven(kv_per_s, share, (np.arange(rows) * 49.97 + 0.4) * INCREMENT_MM)
    last_ns = int(observed.times_ns[-1])
    for part, speed in enumerate(speeds.tolist(), start=1):
        ahead = state_ahead(observed, "Z", last_ns + part * MS // 10)
        assert ahead is not None
        assert abs(ahead.speed_mm_s - speed) <= ahead.doubt_mm_s + 1e-9
    gain = 1e3 if kv_per_s is None else kv_per_s + share * 1e3
    assert ahead.doubt_mm_s < 5.0 * gain * INCREMENT_MM


@pytest.mark.parametrize("rows", [1, 2])
def test_nothing_is_ahead_of_a_motion_that_no_step_shows(rows: int) -> None:
    observed, _ = driven(40.0, 0.0, np.arange(rows + 2) * 0.05)
    for part in (1, 5, 9):
        assert state_ahead(observed, "Z", part * MS // 10) is None
    assert (state_ahead(observed, "Z", (rows - 1) * MS + MS // 2) is None) is (rows == 1)


@pytest.mark.parametrize("gain_mm_s2", [300.0, -300.0])
def test_the_speed_ahead_counts_a_slope_that_begins_there(gain_mm_s2: float) -> None:
    """The feed changes with the step of the contact: of that no row before shows anything."""
    steps_mm = np.full(400, 0.05)
    steps_mm[-2:] += gain_mm_s2 * 1e-6
    observed, speeds = driven(40.0, 0.0, np.cumsum(steps_mm))
    ahead = state_ahead(observed, "Z", int(observed.times_ns[-1]) + 9 * MS // 10)
    assert ahead is not None
    assert 0.005 < abs(ahead.speed_mm_s - speeds[8]) <= ahead.doubt_mm_s < 0.02


@pytest.mark.parametrize(
    ("values", "doubts", "value", "doubt"),
    [
        ([1.0, 0.95], [0.0, 0.2], 1.0, 0.15),  # the smaller one may be 1.15
        ([0.95, 1.0], [0.2, 0.0], 1.0, 0.15),
        ([1.0, 0.95], [0.3, 0.2], 1.0, 0.3),
        ([1.0, 0.1], [0.0, 0.2], 1.0, 0.0),
        ([2.0, 2.0], [0.0, 0.5], 2.0, 0.5),
    ],
)
def test_a_smaller_value_with_more_doubt_may_be_the_largest(
    values: list[float], doubts: list[float], value: float, doubt: float
) -> None:
    found = largest(np.array(values), np.array(doubts))
    assert found is not None
    assert (found.value, found.doubt) == pytest.approx((value, doubt))
    assert largest(np.array([]), np.array([])) is None
