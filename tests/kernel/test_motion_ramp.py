"""The ramp that stops one axis off the path: its speed from three positions, its way by hand."""

import pytest

from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.motion.ramp import STANDING_MM_S, Ramp
from axisrig.kernel.time.clock import MS

BRAKE = Slope(1000.0, 1000.0, 1.0)


def places(ramp: Ramp, cycles: int) -> list[float]:
    return [ramp.advance() for _ in range(cycles)]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_axis_brakes_over_v_squared_by_2_a(sign: float) -> None:
    """10 mm/s, 1000 mm/s²: 10 ms and 0.05 mm; x = v t - a t²/2."""
    ramp = Ramp(5.0, sign * 10.0, BRAKE, MS)
    assert not ramp.is_standing
    way = [10.0 * k * 1e-3 - 500.0 * (k * 1e-3) ** 2 for k in range(1, 11)]
    assert places(ramp, 10) == pytest.approx([5.0 + sign * mm for mm in way])
    assert ramp.is_standing
    assert places(ramp, 3) == pytest.approx([5.0 + sign * 0.05] * 3)


@pytest.mark.parametrize(
    ("velocity_mm_s", "deceleration"),
    [(10.0, None), (0.0, BRAKE), (STANDING_MM_S, BRAKE), (-STANDING_MM_S, BRAKE)],
)
def test_an_axis_that_has_no_brake_or_stands_stops_at_once(
    velocity_mm_s: float, deceleration: Slope | None
) -> None:
    ramp = Ramp(5.0, velocity_mm_s, deceleration, MS)
    assert ramp.is_standing
    assert places(ramp, 2) == [5.0, 5.0]


@pytest.mark.parametrize("acceleration", [0.0, 2000.0, -2000.0])
def test_the_speed_is_that_of_the_parabola_through_three_positions(acceleration: float) -> None:
    """x = 3 + 10 t + a t²/2 at -4, -2 and 0 ms in cycles of 2 ms: 10 mm/s at the last."""
    last = [3.0 + 10.0 * t + 0.5 * acceleration * t * t for t in (-0.004, -0.002, 0.0)]
    ramp = Ramp.after(last, BRAKE, 2 * MS)
    assert places(ramp, 6)[-1] == pytest.approx(3.05)
    assert Ramp.after(last[::-1], None, 2 * MS).advance() == last[0]
