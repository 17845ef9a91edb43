"""Steps of the co-simulation must not show in what is measured.

Between two SYNCs the plants go in steps of any length; where an edge can be they go in fine ones.
The encoder has 0.6 nm, and the input delay of 333 us puts the latch behind the step of the edge.
"""

import math
from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import parse_check

Run = Callable[..., Any]
INCREMENT_MM = 5 / 2**23
T_S, A_MM_S2, VELOCITY_LOOP_HZ = 1e-3, 1000.0, 60.0
FINE_US = 50
# In speeding up the demand velocity steps by a T; the velocity loop answers with 2 pi f times it
JUMP_MM_S2 = 2 * math.pi * VELOCITY_LOOP_HZ * A_MM_S2 * T_S


def stated_mm(step_us: float, jump_mm_s2: float = JUMP_MM_S2) -> float:
    """0.0162 da h^2: cubic Hermite across a jump of the acceleration (physics.md 2(e))."""
    return 0.0162 * jump_mm_s2 * (step_us * 1e-6) ** 2


def _uncertainty_um(out: Any) -> float:
    check = parse_check("latch_error_um", "<= 0", "test")
    return observe(out.observed, check).uncertainty


def _run(run_nc: Run, cycle: str, *, wall_mm: float = 119.0, **drive: Any) -> Any:
    settings = {"input_delay_us": 333.0, **drive}
    feed_forward = settings.pop("feed_forward", 0.0)
    lines = "\n".join(f"{key} = {value!r}" for key, value in settings.items())
    rig = f"""
    [cycle]
    {cycle}
    [drive.servo]
    encoder_increments = 8_388_608
    lead_mm = 5.0
    {lines}
    [plant.z]
    start = {{ position_start_mm = 120.0, feed_forward = {feed_forward} }}
    [plant.probe]
    start = {{ surface_mm = {wall_mm}, trigger_delay_us = 120 }}
    """
    return run_nc("N10 G100 Z100 F6000", rig, base="probe-z.toml")


def _left(out: Any) -> Any:
    """All that a run leaves: frames, edges, contacts, trace."""
    (probe,) = out.machine.plant.probes.values()
    trace = out.machine.recorder.table().to_pydict()
    return out.machine.hexdigest(), probe.signal.edges, probe.contacts, trace


@pytest.mark.long
@pytest.mark.parametrize(
    ("period_us", "steps_us"),
    [(1000, (50, 100, 450, 1000, 20_000)), (10_000, (100, 250, 1000, 2000, 10_000))],
)
@pytest.mark.parametrize("latch", ["interpolated", "sampled"])
def test_longest_step_does_not_change_a_bit(
    run_nc: Run, period_us: int, steps_us: tuple[int, ...], latch: str
) -> None:
    """With one SYNC period; the samples of the drive reach back before the edge."""
    left = []
    for step_us in steps_us:
        cycle = f"period_us = {period_us}\nexchange_us = {step_us}"
        out = _run(run_nc, cycle, latch=latch, sample_us=1000.0, wall_mm=113.0)
        left.append(_left(out))
    assert len(left[0][1]) >= 1
    assert all(other == left[0] for other in left)


@pytest.mark.long
def test_an_elastic_axis_with_backlash_is_latched_alike_at_any_step(run_nc: Run) -> None:
    """A screw that rings at 160 Hz, one SYNC in 10 ms; truth is the load, the latch the motor."""
    left = []
    for step_us in (100, 1000, 10_000):
        rig = f"""
        [cycle]
        period_us = 10_000
        exchange_us = {step_us}
        [plant.z]
        fmu = "AxisRig.Drives.ScrewAxis"
        start = {{ backlash_um = 5, position_start_mm = 120.0 }}
        [plant.probe]
        start = {{ surface_mm = 117.0 }}
        """
        out = run_nc("N10 G100 Z100 F1200", rig, "set:Z.getriebe[0].window=200")
        assert out.alarms == []
        left.append(_left(out))
        (contact,) = out.machine.plant.probes["probe"].contacts
        assert contact.position_mm["z"] == pytest.approx(117.0, abs=1e-7)
        # The motor leads by half the backlash and by what friction bends the screw, F/k
        friction_n = 120 + 800 * 0.020
        leads_mm = 5e-3 / 2 + friction_n / 120e6 * 1e3
        latched_mm = out.machine.channel.records[0].latched_mm["Z"]
        assert latched_mm == pytest.approx(117.0 - leads_mm, abs=10 / 2**20)
    assert left == [left[0]] * 3


# Depths: in speeding up (to 5 mm), in steady motion, and in braking (from 15 mm on)
@pytest.mark.long
@pytest.mark.parametrize(
    ("depth_mm", "feed_forward"), [(0.1, 0.0), (7.0, 0.0), (0.01, 1.0), (3.0, 1.0), (15.5, 1.0)]
)
def test_fine_steps_move_the_value_by_less_than_is_stated(
    run_nc: Run, depth_mm: float, feed_forward: float
) -> None:
    """Reference: every step is of 10 us."""
    values, contacts_ns = [], []
    for cycle in (f"fine_us = {FINE_US}", "fine_us = 10\nexchange_us = 10"):
        out = _run(run_nc, cycle, wall_mm=120.0 - depth_mm, feed_forward=feed_forward)
        values.append(out.machine.channel.records[0].latched_mm["Z"])
        contacts_ns.append(out.machine.plant.probes["probe"].contacts[0].time_ns)
    # The increment may flip
    assert abs(values[0] - values[1]) <= stated_mm(FINE_US) + INCREMENT_MM
    # 1 ns of rounding at both ends; an edge is found in 1/16 of a fine step
    speed_mm_s = math.sqrt(2 * A_MM_S2 * depth_mm) if depth_mm < 5 else 100.0
    moved_mm = speed_mm_s * (abs(contacts_ns[0] - contacts_ns[1]) - 2) * 1e-9
    assert moved_mm <= stated_mm(FINE_US / 16)


@pytest.mark.long
def test_the_interpolation_is_part_of_the_uncertainty_of_the_latch_error(run_nc: Run) -> None:
    """At 45 mm/s the 2 ns of the events are 0.00009 um beside it."""
    for fine_us in (50, 500):
        uncertainty_um = _uncertainty_um(_run(run_nc, f"fine_us = {fine_us}"))
        whole_um = stated_mm(fine_us, 1000.0) * 1e3
        assert uncertainty_um == pytest.approx(whole_um + 0.9e-4, abs=0.3e-4)
