"""The latched position against the step over which axes and sensors exchange their motion.

The encoder has 0.6 nm, and the input delay of 333 us puts the latch into another step than the
edge, so that errors of the two look-ups do not cancel. Reference: steps of 10 us.
Measured: without feed-forward no increment of difference at any step; with full feed-forward, whose
steps of demand velocity shake the acceleration, 0.6 nm up to 500 us and 3.0 nm at 1000 us.
"""

import math
from collections.abc import Callable
from typing import Any

import pytest

from bench.plan.checks import parse_check
from bench.run.metrics import observe
from bench.run.observe import Observed

Run = Callable[..., Any]
STEPS_US = (62, 125, 250, 500, 1000)
INCREMENT_MM = 5 / 2**23
T_S, A_MM_S2, VELOCITY_LOOP_HZ = 1e-3, 1000.0, 60.0
# In speeding up the demand velocity steps by a T; the velocity loop answers with 2 pi f times it
JUMP_MM_S2 = 2 * math.pi * VELOCITY_LOOP_HZ * A_MM_S2 * T_S


def stated_mm(step_us: float) -> float:
    """0.0162 da h^2: cubic Hermite across a jump of the acceleration (physics.md 2(e))."""
    return 0.0162 * JUMP_MM_S2 * (step_us * 1e-6) ** 2


def whole_mm(step_us: float) -> float:
    """The same for the jump by 1000 mm/s2 that the documents reckon with."""
    return 0.0162 * 1000 * (step_us * 1e-6) ** 2


def _uncertainty_um(out: Any) -> float:
    check = parse_check("latch_error_um", "<= 0", "test")
    return observe(Observed(out.machine), check).uncertainty


def _run(run_nc: Run, wall_mm: float, step_us: int, feed_forward: float) -> Any:
    rig = f"""
    [cycle]
    exchange_us = {step_us}
    [drive.servo]
    encoder_increments = 8_388_608
    lead_mm = 5.0
    input_delay_us = 333.0
    [plant.z]
    start = {{ position_start_mm = 120.0, feed_forward = {feed_forward} }}
    [plant.probe]
    start = {{ surface_mm = {wall_mm} }}
    """
    return run_nc("N10 G100 Z100 F6000", rig, base="probe-z.toml")


# Depths: in speeding up (to 5 mm), in steady motion, and in braking (from 15 mm on)
@pytest.mark.parametrize(
    ("depth_mm", "feed_forward"), [(0.1, 0.0), (7.0, 0.0), (0.01, 1.0), (3.0, 1.0), (15.5, 1.0)]
)
def test_the_step_moves_the_value_by_less_than_is_stated(
    run_nc: Run, depth_mm: float, feed_forward: float
) -> None:
    wall_mm = 120.0 - depth_mm
    values, contacts_ns = {}, {}
    for step_us in (10, *STEPS_US):
        out = _run(run_nc, wall_mm, step_us, feed_forward)
        values[step_us] = out.machine.channel.records[0].latched_mm["Z"]
        contacts_ns[step_us] = out.machine.plant.probes["probe"].contacts[0].time_ns
    for step_us in STEPS_US:
        # Two look-ups (edge and latch), and the increment may flip
        allowed_mm = 2 * stated_mm(step_us) + INCREMENT_MM
        assert abs(values[step_us] - values[10]) <= allowed_mm, step_us
        # 1 ns of rounding at both ends
        speed_mm_s = math.sqrt(2 * A_MM_S2 * depth_mm) if depth_mm < 5 else 100.0
        moved_mm = speed_mm_s * (abs(contacts_ns[step_us] - contacts_ns[10]) - 2) * 1e-9
        assert moved_mm <= 2 * stated_mm(step_us), step_us


def test_a_step_of_a_quarter_millisecond_hides_below_the_usual_increment() -> None:
    """1 nm for a jump by 1000 mm/s2; as it is here below a tenth of the shipped 9.5 nm."""
    assert stated_mm(250) < 0.1 * 10 / 2**20
    assert whole_mm(250) == pytest.approx(1e-6, rel=0.02)


def test_the_interpolation_is_part_of_the_uncertainty_of_the_latch_error(run_nc: Run) -> None:
    """At 45 mm/s the 2 ns of the events are 0.00009 um beside it."""
    uncertainty_um = _uncertainty_um(_run(run_nc, 119.0, 250, 0.0))
    assert uncertainty_um == pytest.approx(whole_mm(250) * 1e3 + 0.9e-4, abs=0.3e-4)


def test_a_longer_step_makes_the_latch_error_less_certain(run_nc: Run) -> None:
    assert _uncertainty_um(_run(run_nc, 119.0, 1000, 0.0)) >= whole_mm(1000) * 1e3
