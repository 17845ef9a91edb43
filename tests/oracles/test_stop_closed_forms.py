"""The closed forms against a simulation that knows nothing of them.

An ideal axis: it follows its demand with a lag of first order and stands at its stop as soon as it
is pressed in by delta. It is sampled at every SYNC; lag, window and time are counted by cycles.
"""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from axisrig.bench.oracles.fixed_stop.timing import (
    Approach,
    Cycles,
    Instant,
    after,
    bus_lag_mm,
    later,
    least_path_mm,
    running_lag_mm,
    seen,
)

S = 1e9
SYNC_NS, OFFSET_NS = 48_000, 600_000
CYCLES = 4000


@dataclass(frozen=True)
class Axis:
    """Parameters of one simulated run; the axis is at its stop after contact_s."""

    period_ns: int
    delay: int
    speed: float
    kv: float
    share: float
    delta: float
    contact_s: float
    rise: float  # L - e0
    rows: int  # tau in cycles
    part: float  # where in its cycle tau ends

    @property
    def cycles(self) -> Cycles:
        age = OFFSET_NS - SYNC_NS
        return Cycles(self.period_ns, (age, age), delay_cycles=self.delay)

    @property
    def tau_ns(self) -> int:
        return round((self.rows - 1 + self.part) * self.period_ns)

    def simulate(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return SYNC instants (ns), lag that cycle k judges and position there, (CYCLES,)."""
        k = np.arange(CYCLES)
        t_s = k * self.period_ns / S
        sent = self.speed * (t_s + 2 * self.period_ns / S)  # demand at SYNC k is s(k - 2)
        settled = 1.0 - np.exp(-self.kv * t_s)
        free = self.speed * t_s - (1.0 - self.share) * self.speed / self.kv * settled
        actual = np.minimum(free, self.place_mm + self.delta)
        lag = np.zeros(CYCLES)
        lag[self.delay :] = sent[: CYCLES - self.delay] - actual[self.delay :]
        return k * self.period_ns + SYNC_NS, lag, actual

    @property
    def place_mm(self) -> float:
        behind = (
            (1.0 - self.share) * self.speed / self.kv * (1 - math.exp(-self.kv * self.contact_s))
        )
        return self.speed * self.contact_s - behind

    def approach(self) -> Approach:
        lag = running_lag_mm(self.speed, self.kv, self.share, self.cycles)
        contact_ns = self.contact_s * S + SYNC_NS
        return Approach(contact_ns, 10.0, self.speed, lag, self.delta)


axes = st.builds(
    Axis,
    period_ns=st.sampled_from([1_000_000, 2_000_000, 4_000_000]),
    delay=st.integers(1, 6),
    speed=st.floats(1.0, 50.0),
    kv=st.floats(20.0, 80.0),
    share=st.floats(0.0, 1.0),
    delta=st.floats(0.0, 0.1),
    contact_s=st.floats(1.0, 1.1),
    rise=st.floats(0.01, 5.0),
    rows=st.integers(1, 150),
    part=st.floats(0.1, 1.0),
)


def first(flags: np.ndarray) -> int | None:
    found = np.flatnonzero(flags)
    return int(found[0]) if len(found) else None


def lag_cycle(axis: Axis, limit: float, lag: np.ndarray) -> tuple[int, int] | None:
    """Count cycle by cycle: (first one beyond, the one that detects)."""
    count, begin = -1, 0
    for k, value in enumerate(lag):
        count = count + 1 if abs(value) > limit else -1
        if count == 0:
            begin = k
        if count >= 0 and count * axis.period_ns >= axis.tau_ns:
            return begin, k
    return None


def window_cycle(axis: Axis, window: float, actual: np.ndarray, begin: int) -> int | None:
    back = math.ceil(axis.tau_ns / axis.period_ns)
    moved = np.abs(actual[back:] - actual[:-back])
    found = first(moved[begin - back :] <= window)
    return None if found is None else found + begin


def instant_ns(times: np.ndarray, k: int) -> int:
    return int(times[k]) + OFFSET_NS - SYNC_NS


def by_lag(axis: Axis, limit: float) -> tuple[Instant, Instant]:
    approach, cycles = axis.approach(), axis.cycles
    doubt = approach.doubt_ns + 1e3  # rounding of the simulation
    beyond = seen(approach.lag_exceeded_ns(limit), doubt, cycles, "t_L")
    return beyond, after(beyond, axis.tau_ns, cycles, "tau")


def by_window(axis: Axis, window: float) -> Instant:
    approach, cycles = axis.approach(), axis.cycles
    lasting = cycles.up(axis.tau_ns) * cycles.period_ns
    return seen(approach.window_true_ns(window, lasting), approach.doubt_ns + 1e3, cycles, "t_W")


@settings(max_examples=300, deadline=None)
@given(axes)
@example(Axis(2_000_000, 4, 20.0, 80.0, 0.75, 0.0, 1.0, 0.0625, 1, 1.0))  # finds in the run-up
@pytest.mark.long
def test_lag_criterion(axis: Axis) -> None:
    times, lag, _ = axis.simulate()
    limit = axis.approach().running_lag_mm + axis.rise
    counted = lag_cycle(axis, limit, lag)
    if counted is None or bus_lag_mm(axis.speed, axis.cycles) < -limit:
        return  # the simulation ends before, or d over-compensates beyond the limit in the run-up
    beyond, found = by_lag(axis, limit)
    assert beyond.holds(instant_ns(times, counted[0]))
    assert found.holds(instant_ns(times, counted[1]))
    assert found.high_ns is not None
    assert found.low_ns is not None
    assert found.high_ns - found.low_ns < axis.period_ns + 5e3, "one cycle wide and no more"


@settings(max_examples=300, deadline=None)
@given(axes, st.floats(0.05, 0.95))
@pytest.mark.long
def test_window_criterion(axis: Axis, share: float) -> None:
    way = axis.speed * math.ceil(axis.tau_ns / axis.period_ns) * axis.period_ns / S
    if way <= axis.delta:
        return  # W >= delta and W/tau < v cannot both be
    window = axis.delta + share * (way - axis.delta)
    times, _, actual = axis.simulate()
    steady = int(0.95 * S / axis.period_ns)
    counted = window_cycle(axis, window, actual, steady)
    if counted is None or window * S / axis.tau_ns >= axis.speed:
        return
    assert by_window(axis, window).holds(instant_ns(times, counted))


@pytest.mark.long
@settings(max_examples=150, deadline=None)
@given(axes, st.floats(0.05, 0.95))
def test_both_criteria(axis: Axis, share: float) -> None:
    rows = math.ceil(axis.tau_ns / axis.period_ns)
    way = axis.speed * rows * axis.period_ns / S
    limit = axis.approach().running_lag_mm + axis.rise
    window = axis.delta + share * (way - axis.delta)
    if way <= axis.delta or window * S / axis.tau_ns >= axis.speed:
        return
    times, lag, actual = axis.simulate()
    counted = lag_cycle(axis, limit, lag)
    other = window_cycle(axis, window, actual, int(0.95 * S / axis.period_ns))
    if counted is None or other is None or bus_lag_mm(axis.speed, axis.cycles) < -limit:
        return
    found = later(by_lag(axis, limit)[1], by_window(axis, window))
    assert found.holds(instant_ns(times, max(counted[1], other)))


@pytest.mark.parametrize(
    ("share", "delay", "lag_mm"), [(0.0, 0, 1.7), (0.0, 2, 1.66667), (1.0, 0, 0.03333)]
)
def test_running_lag_of_the_printed_numbers(share: float, delay: int, lag_mm: float) -> None:
    """1 m/min, Kv 10 1/s, 1 ms: v/Kv = 1.667 mm and v T = 16.7 um for each cycle."""
    cycles = Cycles(1_000_000, (0, 0), delay_cycles=delay)
    assert running_lag_mm(1000.0 / 60.0, 10.0, share, cycles) == pytest.approx(lag_mm, abs=1e-5)


@settings(max_examples=100, deadline=None)
@given(st.floats(0.01, 1.0), st.integers(10, 200), st.floats(100.0, 2000.0))
@pytest.mark.long
def test_path_from_which_a_window_cannot_hold_in_a_ramp(
    window_mm: float, tau_ms: int, acceleration: float
) -> None:
    t = np.arange(0.0, 5.0, 1e-5)
    path = 0.5 * acceleration * t * t
    before = 0.5 * acceleration * np.maximum(t - tau_ms * 1e-3, 0.0) ** 2
    leaves = path[first(path - before > window_mm) or 0]
    found = least_path_mm(window_mm, tau_ms * 1_000_000, acceleration)
    assert found == pytest.approx(leaves, rel=2e-2, abs=2e-3)


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize(
    ("first", "second", "band", "word"),
    [
        ((10.0, 10.0, 11.0), (20.0, 20.5, 21.5), (20.5, 21.5), "second"),
        ((10.0, 10.0, 23.0), (20.0, 20.5, 21.5), (20.5, 23.0), "second"),  # one in great doubt
        ((19.0, 21.0, 21.2), (20.0, 20.5, 21.5), (21.0, 21.5), "second"),
    ],
)
def test_both_criteria_hold_from_the_later_bounds_on(
    first: tuple[float, float, float], second: tuple[float, float, float],
    band: tuple[float, float], word: str, turn: int,
) -> None:  # fmt: skip
    """Neither the first nor the last instant of one alone is that of both."""
    one, other = (
        Instant(*ends, name, doubt) for ends, name, doubt in (
            (first, "first", 1.0), (second, "second", 2.0))
    )  # fmt: skip
    found = later(*(one, other)[::turn])
    assert (found.time_ns, found.low_ns, found.high_ns) == (second[0], *band)
    assert found.note == f"the later of both criteria: {word}"
    assert found.doubt_ns == 2.0
    unknown = Instant(None, note="no closed form")
    assert later(unknown, other) is later(other, unknown) is unknown


@pytest.mark.parametrize("ends", [(None, 1.0, 2.0), (1.5, None, 2.0), (1.5, 1.0, None), (1.5,)])
def test_an_instant_that_lacks_its_time_or_a_bound_is_unknown_with_what_follows(
    ends: tuple[float | None, ...],
) -> None:
    """Whichever of two criteria it is of; what is unknown keeps its own note."""
    unknown, known = Instant(*ends, note="no bound"), Instant(20.0, 19.0, 21.0, "known")
    assert later(unknown, known) is later(known, unknown) is unknown
    assert later(unknown, Instant(None, note="other")) is unknown
    assert after(unknown, 1_000_000, Cycles(1_000_000, (0, 0)), "tau") is unknown


@pytest.mark.parametrize(
    ("tau_ns", "cycles"),
    [(0, 0), (1, 1), (999_999, 1), (1_000_000, 1), (1_000_001, 2), (2_000_000, 2)],
)
def test_a_time_is_over_in_whole_cycles(tau_ns: int, cycles: int) -> None:
    """Both bounds move with the instant, and its doubt stays."""
    begin = Instant(20.0, 19.0, 22.0, "begins", 0.5)
    moved = cycles * 1e6
    assert after(begin, tau_ns, Cycles(1_000_000, (0, 0)), "tau") == Instant(
        20.0 + moved, 19.0 + moved, 22.0 + moved, "tau; begins", 0.5
    )
