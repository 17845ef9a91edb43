"""Limits of kp with an integral and a derivative part, by the power of q that the offset returns.

With B = q the characteristic polynomial of PI control is z^2 + (kp (1 + g) - 2) z + 1 - kp: a pole
leaves at -1. With B = q^2 it is z^3 - 2 z^2 + (1 + kp (1 + g)) z - kp, of PD control
z^3 - z^2 + kp (1 + r) z - kp r: a pair leaves, where b - a c = 1 - c^2 (Jury). g = T/Tn, r = Tv/T.
"""

import math

import pytest
from tests.oracles.distance.closed_forms import pd_limit, pi_limit

from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop, growth, transfer
from axisrig.bench.oracles.distance.model import first_order_drive
from axisrig.bench.oracles.distance.smoothing import exponential, moving_average
from axisrig.bench.oracles.distance.stability import closed_limit, is_stable, kp_limit

SLOW = first_order_drive(10e-3, 1_000_000)
# B of each: with q alone the offset of a cycle is in the error of the next one
ONE_CYCLE = {
    "distance": {"mode": CONST_DIST, "dead_cycles": 0},
    "both encoders, no dead cycle": {"mode": BOTH, "dead_cycles": 0},
    "both encoders": {"mode": BOTH, "dead_cycles": 3},
    "both encoders, slow drive": {"mode": BOTH, "dead_cycles": 1, "drive": SLOW},
    "surface, no dead cycle": {"mode": SET_POS, "dead_cycles": 0},
    "surface": {"mode": SET_POS, "dead_cycles": 3},
    "surface, slow drive": {"mode": SET_POS, "dead_cycles": 1, "drive": SLOW},
    "surface, mean": {"mode": SET_POS, "dead_cycles": 1, "smoothing": moving_average(4)},
    "surface, exponential": {"mode": SET_POS, "dead_cycles": 2, "smoothing": exponential(0.3)},
}
TWO_CYCLES = {
    "distance": {"mode": CONST_DIST, "dead_cycles": 1},
    "distance, older sensor": {"mode": CONST_DIST, "dead_cycles": 0, "skew_cycles": 1},
    "distance, newer sensor": {"mode": CONST_DIST, "dead_cycles": 2, "skew_cycles": -1},
    "both encoders": {"mode": BOTH, "dead_cycles": 2, "sent_cycles": 1},
    "surface, older sensor": {"mode": SET_POS, "dead_cycles": 0, "skew_cycles": 1},
}
INTEGRAL = (0.02, 0.2, 0.5)
DERIVATIVE = (0.3, 1.0, 4.0)

one_cycle = pytest.mark.parametrize("given", ONE_CYCLE.values(), ids=ONE_CYCLE)
two_cycles = pytest.mark.parametrize("given", TWO_CYCLES.values(), ids=TWO_CYCLES)


def pd_limit_of_two(derivative: float) -> float:
    """Return the root of r^2 kp^2 + kp - 1, with B = q^2."""
    return (math.sqrt(1.0 + 4.0 * derivative**2) - 1.0) / (2.0 * derivative**2)


def pid_limit(integral: float, derivative: float) -> float:
    """Return 4/(2 + g + 4 r), B = q: (1 - q)^2 + kp q ((1 - q) + g + r (1 - q)^2) at q = -1."""
    return 4.0 / (2.0 + integral + 4.0 * derivative)


@one_cycle
@pytest.mark.parametrize("integral", INTEGRAL)
def test_pi_control_of_one_cycle_has_a_pole_at_minus_one(given: dict, integral: float) -> None:
    loop = Loop(**given, integral=integral)
    assert kp_limit(loop) == pytest.approx(pi_limit(integral), rel=1e-6)


@two_cycles
@pytest.mark.parametrize("integral", INTEGRAL)
def test_pi_control_of_two_cycles_is_stable_up_to_one_less_the_integral(
    given: dict, integral: float
) -> None:
    loop = Loop(**given, integral=integral)
    assert kp_limit(loop) == pytest.approx(1.0 - integral, rel=1e-6)
    assert is_stable(loop, 0.99 * (1.0 - integral))
    assert not is_stable(loop, 1.01 * (1.0 - integral))


@one_cycle
@pytest.mark.parametrize("derivative", DERIVATIVE)
def test_pd_control_of_one_cycle(given: dict, derivative: float) -> None:
    loop = Loop(**given, derivative=derivative, of_error=True)
    assert kp_limit(loop) == pytest.approx(pd_limit(derivative), rel=1e-6)


@two_cycles
@pytest.mark.parametrize("derivative", DERIVATIVE)
def test_pd_control_of_two_cycles(given: dict, derivative: float) -> None:
    loop = Loop(**given, derivative=derivative, of_error=True)
    assert kp_limit(loop) == pytest.approx(pd_limit_of_two(derivative), rel=1e-6)


@one_cycle
@pytest.mark.parametrize("integral", [0.02, 0.2])
@pytest.mark.parametrize("derivative", [0.3, 1.0])
def test_pid_control_of_one_cycle(given: dict, integral: float, derivative: float) -> None:
    loop = Loop(**given, integral=integral, derivative=derivative, of_error=True)
    assert kp_limit(loop) == pytest.approx(pid_limit(integral, derivative), rel=1e-6)


@pytest.mark.parametrize("integral", [0.0, 0.02, 0.5])
@pytest.mark.parametrize("name", [name for name in ONE_CYCLE if name.startswith("surface")])
def test_the_derivative_of_a_feedback_does_not_see_the_offset_of_a_surface(
    name: str, integral: float
) -> None:
    """Motor and sensor move against each other: nothing of the offset is left in their sum."""
    loop = Loop(**ONE_CYCLE[name], integral=integral, derivative=4.0)
    assert kp_limit(loop) == pytest.approx(pi_limit(integral), rel=1e-6)


@pytest.mark.parametrize("mode", [CONST_DIST, BOTH])
def test_the_derivative_of_error_and_feedback_are_one_beside_a_surface(mode: str) -> None:
    for of_error in (False, True):
        loop = Loop(mode, 0, derivative=1.0, of_error=of_error)
        assert kp_limit(loop) == pytest.approx(pd_limit(1.0), rel=1e-6)


@pytest.mark.parametrize("gain", [0.5, 2.0])
@pytest.mark.parametrize("integral", [0.0, 0.2])
def test_a_distance_that_grows_faster_takes_less_kp(gain: float, integral: float) -> None:
    loop = Loop(CONST_DIST, 0, integral=integral, gain=gain)
    assert kp_limit(loop) == pytest.approx(pi_limit(integral) / gain, rel=1e-6)


def test_an_integral_that_is_too_strong_leaves_no_kp() -> None:
    """1 - g is the limit of two cycles: from g = 1 on there is none."""
    assert kp_limit(Loop(CONST_DIST, 1, integral=1.0)) == 0.0
    assert kp_limit(Loop(CONST_DIST, 1, integral=1.5)) == 0.0


@pytest.mark.parametrize(
    "changed",
    [{"integral": 0.1}, {"derivative": 1.0}, {"drive": SLOW}, {"sign": -1}],
    ids=lambda one: next(iter(one)),
)
@pytest.mark.parametrize("mode", [CONST_DIST, BOTH, SET_POS])
def test_what_has_no_closed_form_has_no_number_of_one(mode: str, changed: dict) -> None:
    assert closed_limit(Loop(mode, 1)) is not None
    assert closed_limit(Loop(mode, 1, **changed)) is None


@pytest.mark.parametrize(
    ("given", "count", "limit"),
    [
        ({"mode": CONST_DIST, "dead_cycles": 0, "skew_cycles": 1}, 1, 1.0),
        ({"mode": CONST_DIST, "dead_cycles": 1, "gain": 4.0}, 1, 0.25),
        ({"mode": BOTH, "dead_cycles": 5, "sent_cycles": 0}, 1, 2.0),
        ({"mode": BOTH, "dead_cycles": 5, "sent_cycles": 1}, 1, 1.0),
        ({"mode": BOTH, "dead_cycles": 1, "skew_cycles": 1}, 1, None),
        ({"mode": BOTH, "dead_cycles": 1, "gain": 2.0}, 1, None),
        ({"mode": SET_POS, "dead_cycles": 1, "gain": 2.0}, 1, None),
        ({"mode": SET_POS, "dead_cycles": 5}, 9, 2.0),
        ({"mode": SET_POS, "dead_cycles": 1, "skew_cycles": 1}, 1, 2.0 / 3.0),
        ({"mode": SET_POS, "dead_cycles": 1, "skew_cycles": 1}, 2, None),
        ({"mode": SET_POS, "dead_cycles": 2, "skew_cycles": 1}, 1, None),
        ({"mode": SET_POS, "dead_cycles": 1, "skew_cycles": 2}, 1, None),
    ],
)
def test_which_loops_have_a_closed_form(given: dict, count: int, limit: float | None) -> None:
    found = closed_limit(Loop(**given), count)
    assert found == (None if limit is None else pytest.approx(limit))


def test_without_a_dead_cycle_a_distance_of_kp_one_is_reached_at_once() -> None:
    assert growth(Loop(CONST_DIST, 0), 1.0) == pytest.approx(0.0, abs=1e-12)
    assert growth(Loop(CONST_DIST, 0), 0.25) == pytest.approx(0.75)


@pytest.mark.parametrize("omega_t", [0.1, 1.0, math.pi])
def test_the_open_loop_of_p_control_is_kp_over_two_sines(omega_t: float) -> None:
    """kp q/(1 - q) has the size kp/(2 sin(wT/2)) and the phase -90 deg - wT/2; n adds -n wT."""
    for dead in (0, 2):
        (found,) = transfer(Loop(CONST_DIST, dead), 0.3, [omega_t])  # type: ignore[arg-type]
        assert abs(found) == pytest.approx(0.3 / (2.0 * math.sin(omega_t / 2)))
        turned = found * complex(math.cos(dead * omega_t), math.sin(dead * omega_t))
        expected = -math.pi / 2 - omega_t / 2
        whole = complex(math.cos(expected), math.sin(expected))
        assert turned / abs(found) == pytest.approx(whole, abs=1e-9)
