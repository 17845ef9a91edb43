"""Probes that tell a level only, axes that tell positions only: how far their edges are known."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from axisrig.kernel.time.clock import MS, US

Make = Callable[..., Any]
BENT, FOLLOWER = "EdgeProof.Bent", "SteppingTest.Follower"
LEVEL, LATE = "SteppingTest.LevelProbe", "SteppingTest.LateLevelProbe"
SURFACE = -0.0003
# v t = surface: before the acceleration changes
EDGE_NS = 0.0003 / 0.02 * 1e9


def edge_of(plant: Any, end_ns: int = 30 * MS) -> tuple[int, float]:
    """Run in SYNCs of 1 ms; return the only edge and its uncertainty."""
    for time_ns in range(MS, end_ns + 1, MS):
        plant.advance_to(time_ns)
    probe = plant.probes["probe"]
    ((edge_ns, level),) = probe.signal.edges
    assert level is True
    return edge_ns, probe.edge_uncertainty_ns


@pytest.mark.long
def test_level_is_enclosed_to_a_nanosecond_where_the_state_can_be_saved(plant: Make) -> None:
    edge_ns, uncertainty_ns = edge_of(plant(BENT, LEVEL, probe_start={"surface": SURFACE}))
    assert uncertainty_ns == 1
    assert abs(edge_ns - EDGE_NS) <= 1


def test_level_is_enclosed_in_accelerated_motion(plant: Make) -> None:
    """x = v t + a t^2/2 also inside the parts of a step, 3 us: a straight line through their ends
    is up to a h^2/8 off, 8 ns here.
    """
    v, a = 0.001, 100.0
    start = {"velocity_start": -v, "acceleration_first": -a}
    for surface in (-1e-6, -2.3e-6, -0.000312345):
        made = plant(BENT, LEVEL, axis_start=start, probe_start={"surface": surface})
        edge_ns, uncertainty_ns = edge_of(made, 20 * MS)
        assert uncertainty_ns == 1
        assert abs(edge_ns - (math.sqrt(v * v - 2 * a * surface) - v) / a * 1e9) <= 1


def test_an_uncertainty_stays_the_worst(plant: Make) -> None:
    """The first edge is late and known to a fine step, the second one enclosed to a nanosecond:
    x = v t until the bend, then v t + a (t - b)^2/2 with the way back through the surface.
    """
    probe = "SteppingTest.LateOnLevelProbe"
    made = plant(BENT, probe, probe_start={"surface": SURFACE})
    for time_ns in range(MS, 80 * MS + 1, MS):
        made.advance_to(time_ns)
        known_ns = made.probes["probe"].edge_uncertainty_ns
        assert known_ns == (1 if time_ns <= 15 * MS else 50 * US)
    (_, on), (off_ns, off) = made.probes["probe"].signal.edges
    assert (on, off) == (True, False)
    v, a, bend_s = 0.02, 1.0, 0.0234567
    rest = -SURFACE - v * bend_s  # below 0: so far back
    back_s = bend_s + (v + math.sqrt(v * v - 2 * a * rest)) / a
    assert abs(off_ns - back_s * 1e9) <= 1


@pytest.mark.long
def test_an_edge_in_a_shorter_step_does_not_better_the_one_before(plant: Make) -> None:
    """An axis without velocity: the step is the uncertainty, 50 us and then a part of it."""
    without = ("velocity", "motor_velocity")
    made = plant(BENT, probe_start={"surface": SURFACE}, without=without, can_save=False)
    for time_ns in range(MS, 80 * MS + 1, MS):
        made.advance_to(time_ns)
        probe = made.probes["probe"]
        if len(probe.signal.edges) == 1:
            assert probe.edge_uncertainty_ns == 50 * US
            probe.slave.can = replace(probe.slave.can, can_save_state=True)
    assert [level for _, level in probe.signal.edges] == [True, False]
    assert probe.edge_uncertainty_ns == 50 * US


@pytest.mark.parametrize("fine_us", [10, 50, 200])
@pytest.mark.parametrize("surface", [SURFACE, -0.000312345])
def test_without_a_saved_state_the_step_is_the_uncertainty(
    plant: Make, fine_us: int, surface: float
) -> None:
    made = plant(
        BENT, LEVEL, probe_start={"surface": surface}, can_save=False, fine_ns=fine_us * US
    )
    edge_ns, uncertainty_ns = edge_of(made)
    assert uncertainty_ns == fine_us * US
    assert abs(edge_ns + surface / 0.02 * 1e9) <= uncertainty_ns


@pytest.mark.long
@pytest.mark.parametrize("fixed_us", [None, 10, 50, 200, 700])
def test_the_fixed_step_of_an_fmu_is_the_uncertainty_where_it_is_longer(
    plant: Make, fixed_us: int | None
) -> None:
    """Fine steps of 50 us; inside, the FMU looks every fixed step only. Of a delayed level too."""
    for probe, can_save in ((LEVEL, False), (LATE, True)):
        made = plant(BENT, probe, probe_start={"surface": SURFACE}, can_save=can_save)
        slave = made.probes["probe"].slave
        slave.can = replace(slave.can, fixed_step_s=fixed_us and fixed_us * 1e-6)
        _, uncertainty_ns = edge_of(made)
        assert uncertainty_ns == pytest.approx(max(50, fixed_us or 0) * US, abs=1e-6)


@pytest.mark.parametrize("can_save", [True, False])
@pytest.mark.parametrize("surface", [SURFACE, -0.000312345, -0.00029999])
def test_a_delayed_level_is_known_to_the_step_in_which_it_began(
    plant: Make, surface: float, can_save: bool
) -> None:
    """130 us later; the FMU took the position at the end of a step for that of the whole step."""
    made = plant(BENT, LATE, probe_start={"surface": surface}, can_save=can_save)
    edge_ns, uncertainty_ns = edge_of(made)
    assert uncertainty_ns == 50 * US
    assert abs(edge_ns + surface / 0.02 * 1e9 - 130e3) <= uncertainty_ns


def test_level_of_a_probe_that_gets_the_trajectory(plant: Make) -> None:
    edge_ns, uncertainty_ns = edge_of(
        plant(BENT, probe_start={"surface": SURFACE}, without=("clearance", "rising_count"))
    )
    assert uncertainty_ns == 1
    assert abs(edge_ns - EDGE_NS) <= 1


@pytest.mark.parametrize("can_save", [True, False])
def test_velocity_is_derived_where_an_axis_tells_none(plant: Make, can_save: bool) -> None:
    """Positions are known at the ends of a part: 50 us, or 1/256 of it."""
    made = plant(
        BENT,
        axis_start={"bend_time": 0.0},
        probe_start={"surface": -0.0001},
        without=("velocity", "motor_velocity"),
        can_save=can_save,
    )
    edge_ns, uncertainty_ns = edge_of(made, 20 * MS)
    assert uncertainty_ns == pytest.approx(50e3 / 256 if can_save else 50e3, abs=1)
    expected_s = 0.02 - math.sqrt(0.02**2 - 2 * 0.0001)
    assert abs(edge_ns - expected_s * 1e9) <= uncertainty_ns
    # Constant acceleration: a parabola through three points has the right slope
    assert made.axes["axis"].motion[1] == pytest.approx(-0.02 + made.now_ns * 1e-9, abs=1e-9)


@pytest.mark.long
def test_plain_demand_is_the_ramp_held_for_62_us(plant: Make) -> None:
    """First-order lag under a staircase: x(k+1) = d(k) + (x(k) - d(k)) exp(-h/T)."""
    ends = []
    for exchange_ns in (100 * US, 20 * MS):
        made = plant(FOLLOWER, LEVEL, probe_start={"surface": -1.0}, exchange_ns=exchange_ns)
        axis = made.axes["axis"]
        made.advance_to(MS)
        assert axis.position_m() == 0.0
        axis.command(MS, 0.0, 0.1, 9 * MS, True)
        made.advance_to(11 * MS)
        ends.append(axis.position_m())
        assert axis.demand_position_m() == pytest.approx(0.1 * 8e-3, abs=1e-15)
    h, x = 62.5e-6, 0.0
    for k in range(160):
        demand = 0.1 * min(k * h, 8e-3)
        x = demand + (x - demand) * math.exp(-h / 5e-3)
    assert ends[0] == pytest.approx(x, abs=1e-12)
    assert ends[1] == pytest.approx(ends[0], abs=1e-15)


@pytest.mark.long
def test_axis_that_cannot_be_switched_off_stays_where_it_was(plant: Make) -> None:
    made = plant(FOLLOWER, LEVEL, axis_start={"position_start": 0.2}, probe_start={"surface": -1.0})
    axis = made.axes["axis"]
    made.advance_to(MS)
    assert axis.position_m() == pytest.approx(0.2, abs=1e-15)
    axis.command(MS, 0.5, 0.0, MS, False)
    made.advance_to(9 * MS)
    assert axis.position_m() == pytest.approx(0.2, abs=1e-15)
    axis.command(9 * MS, 0.2, 0.05, 100 * MS, True)
    made.advance_to(20 * MS)
    where = axis.position_m()
    axis.command(20 * MS, 0.0, 0.0, 20 * MS, False)
    made.advance_to(200 * MS)
    assert axis.position_m() == pytest.approx(where, abs=1e-12)


def test_early_return_at_the_edge_is_exact_without_a_saved_state(plant: Make) -> None:
    """A probe that gets the trajectory and ends its step where its level changes.

    Edge at 15 617 250.5 ns, between two whole nanoseconds, so that no rounding decides on which
    side of it a step ends: the first end behind it is 15 617 251 ns.
    """
    surface_m, speed_m_s = -0.00031234501, -0.02
    edge_ns = surface_m / speed_m_s * 1e9
    edge_at_ns = math.ceil(edge_ns)
    assert (edge_at_ns, edge_at_ns - edge_ns) == (15_617_251, pytest.approx(0.5, abs=1e-6))
    made = plant(
        BENT,
        probe_start={"surface": surface_m},
        without=("clearance", "rising_count"),
        can_save=False,
    )
    slave = made.probes["probe"].slave
    step_towards = slave.step_towards
    slave.step_towards = lambda end_ns: step_towards(
        edge_at_ns if slave.time_ns < edge_at_ns < end_ns else end_ns
    )
    assert edge_of(made) == (edge_at_ns, 1)
