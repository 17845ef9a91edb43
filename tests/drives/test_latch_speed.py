"""How fast an axis was at its latch: what the dead time of a probe is multiplied by (P-AXIS-00487).

The axis moves uniformly accelerated, x(k) = x0 + v k + a k^2 / 2 increments at SYNC k; the latch
lies anywhere between two SYNCs, where its speed is v + a k.
"""

import pytest

from axisrig.kernel.drives.cia402.latch_watch import LatchWatch

ENABLED, STORED = 0x0001, 0x0002


def _speed(v: float, a: float, at: float, told_later: int = 1, cycles: int = 30) -> float:
    """Let a drive tell the latch at cycle `at`, one or more SYNCs later."""

    def place(k: float) -> int:
        return round(1e6 + v * k + a * k * k / 2)

    watch = LatchWatch("Z", ENABLED, STORED, 1000.0)
    watch.take(0, 5, 7, place(0))
    watch.arm()
    for k in range(1, cycles):
        is_told = k >= at + told_later
        status = ENABLED | STORED if is_told else ENABLED
        watch.take(status, place(at) if is_told else 5, 8 if is_told else 7, place(k))
        if watch.increments is not None:
            return watch.speed_increments
    raise AssertionError("no latch")


@pytest.mark.parametrize("v", [1000.0, -1000.0, 37.0])
@pytest.mark.parametrize("at", [3.0, 3.25, 10.5, 20.999])
def test_at_constant_speed_it_is_the_speed(v: float, at: float) -> None:
    assert _speed(v, 0.0, at) == pytest.approx(v)


@pytest.mark.parametrize(("v", "a"), [(5000.0, -200.0), (-5000.0, 200.0), (100.0, 50.0)])
@pytest.mark.parametrize("at", [3.0, 4.25, 10.5, 17.75])
def test_in_a_ramp_it_is_the_speed_of_the_instant(v: float, a: float, at: float) -> None:
    """Rounding to increments leaves one or two of them per cycle."""
    assert _speed(v, a, at) == pytest.approx(v + a * at, abs=2.0)


@pytest.mark.parametrize("told_later", [1, 2, 4])
def test_a_latch_that_is_told_late_has_the_speed_of_its_place(told_later: int) -> None:
    assert _speed(5000.0, -200.0, 10.5, told_later) == pytest.approx(5000 - 200 * 10.5, abs=2.0)


def test_an_axis_that_stood_has_no_speed() -> None:
    assert _speed(0.0, 0.0, 5.0) == 0.0
