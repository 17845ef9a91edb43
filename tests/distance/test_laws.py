"""Both laws against closed forms of the loop (Kuruklis; domain of P, PI and PID in increments).

All have the period of 1 ms. n dead cycles: the error is measured n cycles late.
"""

import contextlib
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy import signal

from axisrig.kernel.distance import DistanceCommand, DistanceControl, DistanceState, Reading
from axisrig.kernel.errors import Alarm

ON, ON_CONST = DistanceCommand.ON, DistanceCommand.ON_CONST_DIST
Make = Callable[..., Any]
T = 0.001


def constant(loop: Any, set_dist_mm: float = 0.0) -> Any:
    loop.control.set_distance(set_dist_mm)
    return loop.say(ON_CONST)


def surface(loop: Any, set_pos_mm: float = 0.0) -> Any:
    loop.control.set_surface(set_pos_mm)
    return loop.say(ON)


def up_from(cycle: int, height_mm: float) -> Callable[[int], float]:
    return lambda k: height_mm if k >= cycle else 0.0


@pytest.mark.parametrize("start", [constant, surface])
@pytest.mark.parametrize("kp", [0.05, 0.3, 1.0, 1.7])
def test_without_dead_time_the_error_is_a_power(make_loop: Make, start: Any, kp: float) -> None:
    loop = start(make_loop(lambda _k: 0.25, kp=kp)).run(30)
    expected = 0.25 * (1 - kp) ** np.arange(30)
    assert loop.errors_mm == pytest.approx(expected.tolist(), abs=1e-13)
    assert loop.offsets_mm[-1] == pytest.approx(0.25 * (1 - (1 - kp) ** 30), abs=1e-12)


def test_the_distance_comes_to_its_set_value_over_any_surface(make_loop: Make) -> None:
    loop = constant(make_loop(lambda _k: 3.0, program_mm=5.0, kp=0.5), 1.5).run(60)
    assert loop.control.distance_mm == pytest.approx(1.5)
    assert loop.control.offset_mm == pytest.approx(3.0 + 1.5 - 5.0)


def test_the_surface_error_stays_and_the_sensor_returns(make_loop: Make) -> None:
    """FCT-M3 5.1 and 10: the deviation is compensated by an offset that stays."""
    loop = surface(make_loop(lambda _k: 31.0, program_mm=30.0, kp=0.3), 30.0).run(200)
    assert loop.control.offset_mm == pytest.approx(1.0)
    assert loop.control.filtered_mm == pytest.approx(1.0)
    assert loop.control.sensor_mm == pytest.approx(0.0, abs=1e-9)
    assert loop.control.error_mm == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("dead_cycles", range(7))
def test_constant_distance_is_stable_up_to_the_known_gain(
    make_loop: Make, dead_cycles: int
) -> None:
    limit = 2 * math.sin(math.pi / (2 * (2 * dead_cycles + 1)))
    for kp, grows in ((limit * 0.97, False), (limit * 1.03, True)):
        loop = make_loop(lambda _k: 1e-3, dead_cycles=dead_cycles, kp=kp, max_deviation_mm=1e30,
                         min_pos_mm=-1e30, max_pos_mm=1e30, max_change_mm_s=1e30,
                         v_max_mm_s=1e30, a_max_mm_s2=1e30)  # fmt: skip
        errors = np.abs(constant(loop).run(600).errors_mm)
        assert (errors[-50:].max() > errors[:50].max()) == grows


@pytest.mark.long
@pytest.mark.parametrize(("dead_cycles", "count"), [(0, 4), (1, 4), (3, 4), (3, 20)])
def test_a_mean_in_the_loop_lowers_that_gain(make_loop: Make, dead_cycles: int, count: int) -> None:
    w = math.pi / (count + 2 * dead_cycles)
    limit = 2 * count * math.sin(w / 2) ** 2 / math.sin(count * w / 2)
    for kp, grows in ((limit * 0.97, False), (limit * 1.03, True)):
        loop = make_loop(lambda k: 1e-3 * (k > 0), dead_cycles=dead_cycles, kp=kp, n_cycles=count,
                         max_deviation_mm=1e30, min_pos_mm=-1e30, max_pos_mm=1e30,
                         max_change_mm_s=1e30, v_max_mm_s=1e30, a_max_mm_s2=1e30)  # fmt: skip
        errors = np.abs(constant(loop).run(3000).errors_mm)
        assert (errors[-100:].max() > errors[100:200].max()) == grows


@pytest.mark.parametrize("dead_cycles", [0, 3])
def test_the_surface_law_knows_no_dead_time(make_loop: Make, dead_cycles: int) -> None:
    """Its deviation holds both encoders, so that the drive leaves the loop: pole 1 - kp."""
    loop = surface(make_loop(lambda _k: 0.25, dead_cycles=dead_cycles, kp=1.0)).run(10)
    assert loop.offsets_mm == pytest.approx([0.25] * 10)


@pytest.mark.parametrize(
    ("kp", "dead_cycles", "count"),
    [(0.05, 0, 1), (0.2, 0, 1), (1.0, 0, 1), (0.05, 2, 1), (0.3, 2, 1), (0.05, 1, 4), (0.2, 1, 4)],
)
def test_ramp_error_of_a_constant_distance(
    make_loop: Make, kp: float, dead_cycles: int, count: int
) -> None:
    """v T/kp as measured, before the update, whatever dead time and filter."""
    v_mm_s = 10.0
    loop = make_loop(lambda k: v_mm_s * T * k, dead_cycles=dead_cycles, kp=kp, n_cycles=count)
    sensor_mm = constant(loop).run(900).sensors_mm[-1]
    assert sensor_mm == pytest.approx(v_mm_s * T / kp, rel=1e-6)


@pytest.mark.parametrize(("kp", "dead_cycles", "count"), [(0.2, 1, 4), (0.5, 0, 1), (1.0, 3, 8)])
def test_ramp_error_of_the_surface_law(
    make_loop: Make, kp: float, dead_cycles: int, count: int
) -> None:
    """v (T/kp - T + n T + (N - 1) T/2), n cycles from an offset to the tool that stands there."""
    v_mm_s, n = 10.0, dead_cycles + 1
    loop = make_loop(lambda k: v_mm_s * T * k, dead_cycles=dead_cycles, kp=kp, n_cycles=count)
    sensor_mm = surface(loop).run(400).sensors_mm[-1]
    expected = v_mm_s * T * (1 / kp - 1 + n + (count - 1) / 2)
    assert sensor_mm == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("lag", [0.0, 0.9])
@pytest.mark.parametrize("both", [False, True], ids=["sensor", "both encoders"])
def test_with_both_encoders_a_slow_drive_leaves_the_loop(
    make_loop: Make,
    lag: float,
    both: bool,
) -> None:
    """Dead beat with kp 1 then, and an overshoot without (FCT-M3 7.1)."""
    loop = constant(make_loop(up_from(1, 0.25), lag=lag, kp=1.0, both_encoders=both)).run(200)
    if both or not lag:
        assert loop.offsets_mm[1:] == pytest.approx([0.25] * 199)
    else:
        assert max(loop.offsets_mm) > 0.35


@pytest.fixture
def open_deltas(make_loop: Make) -> Callable[..., list[float]]:
    """Give a control errors and return what it asks for in each cycle."""

    def run(errors_mm: list[float], **changes: Any) -> list[float]:
        control = constant(make_loop(**changes)).control
        deltas = []
        for error_mm in errors_mm:
            control.step(Reading(error_mm, 0.0, 0.0))  # d = -sensor, e = 0 - d
            deltas.append(control.delta_mm)
        return deltas

    return run


def test_integral_time_is_when_both_parts_are_equal(open_deltas: Make) -> None:
    deltas = open_deltas([0.01] * 50, kp=0.4, tn_s=0.02)
    expected = [0.4 * 0.01 * (1 + (k + 1) / 20) for k in range(50)]
    assert deltas == pytest.approx(expected)
    assert deltas[19] == pytest.approx(2 * 0.4 * 0.01)


def test_derivative_time_is_when_both_parts_are_equal(open_deltas: Make) -> None:
    deltas = open_deltas([0.001 * k for k in range(50)], kp=0.4, tv_s=0.02)
    expected = [0.0] + [0.4 * 0.001 * (k + 20) for k in range(1, 50)]
    assert deltas == pytest.approx(expected)
    assert deltas[20] == pytest.approx(2 * 0.4 * 0.001 * 20)


def test_the_derivative_does_not_see_the_start(open_deltas: Make) -> None:
    assert open_deltas([0.5, 0.5], kp=0.1, tv_s=1.0) == pytest.approx([0.05, 0.05])


def test_pid_in_the_loop_is_that_of_scipy(make_loop: Make) -> None:
    """e = h/(1 + L/z) with L = kp (1 + T/Tn/(1 - 1/z) + Tv/T (1 - 1/z))/(1 - 1/z)."""
    kp, tn_s, tv_s = 0.25, 0.05, 0.0004
    heights = np.concatenate([[0.0], np.random.default_rng(7).normal(0, 0.1, 400)])
    loop = make_loop(lambda k: float(heights[k]), kp=kp, tn_s=tn_s, tv_s=tv_s)
    errors = constant(loop).run(len(heights)).errors_mm
    back = np.array([1.0, -1.0])
    ones = np.convolve(back, back)
    pid = kp * (np.array([1.0, -1.0, 0.0]) + np.array([T / tn_s, 0, 0]) + tv_s / T * ones)
    expected = signal.lfilter(ones, np.append(ones, 0.0) + np.append(0.0, pid), heights)
    assert errors == pytest.approx(expected.tolist(), abs=1e-11)


def test_the_integral_part_takes_the_ramp_error_away(make_loop: Make) -> None:
    loop = make_loop(lambda k: 0.01 * k, kp=0.2, tn_s=0.05, max_deviation_mm=1e3)
    assert constant(loop).run(3000).errors_mm[-1] == pytest.approx(0.0, abs=1e-9)


def test_a_set_distance_may_change_in_every_cycle(make_loop: Make) -> None:
    """FCT-M3 5.2, over the PLC."""
    loop = constant(make_loop(kp=1.0))
    for k in range(40):
        loop.control.set_distance(0.01 * k)
        loop.run(1)
        assert loop.control.offset_mm == pytest.approx(0.01 * k)


def test_a_programmed_motion_leads_and_the_distance_comes_back(make_loop: Make) -> None:
    loop = constant(make_loop(kp=0.3), 1.5).run(60)
    loop.program_mm = 2.0
    loop.run(1)
    assert loop.control.distance_mm == pytest.approx(3.5)
    loop.run(60)
    assert loop.control.distance_mm == pytest.approx(1.5)
    assert loop.control.offset_mm == pytest.approx(-0.5)


@pytest.mark.parametrize("start", [constant, surface])
@pytest.mark.parametrize(("start_mm", "alarm_id"), [(0.001, 70330), (-0.001, 70576)])
@pytest.mark.parametrize("kp", [0.2, 1.0])
def test_a_sensor_that_counts_with_the_motor_runs_away(
    make_loop: Make, kp: float, start: Any, start_mm: float, alarm_id: int
) -> None:
    """In both laws s(k) = s(0) (1 + kp)^k: the first cycle beyond the limit is known."""
    control: DistanceControl = start(make_loop(kp=kp, max_pos_mm=1.0, min_pos_mm=-1.0)).control
    found: list[int] = []
    cycles = -1
    while not found:
        cycles += 1
        with contextlib.suppress(Alarm):
            actual_mm = control.offset_mm
            control.step(Reading(start_mm + actual_mm, actual_mm, actual_mm))
            continue
        found.append(cycles)
    assert control.state is DistanceState.ERROR
    with pytest.raises(Alarm, match=f"ID {alarm_id}"):
        control.check_position(start_mm + control.offset_mm)
    assert cycles == math.ceil(math.log(1.0 / abs(start_mm)) / math.log(1 + kp))


@pytest.mark.parametrize("between", [(DistanceCommand.OFF,), (DistanceCommand.FREEZE,)])
@pytest.mark.parametrize("start", [constant, surface])
@pytest.mark.parametrize("tv_s", [0.0, T / 2])
def test_a_second_on_begins_with_an_empty_integral_and_nothing_before(
    make_loop: Make, start: Any, between: Any, tv_s: float
) -> None:
    """A ramp fills the sum; the first step of the next ON is kp e (1 + T/Tn), without a D part:
    what it would look back on was measured before the control was off.
    """
    kp, tn_s, ramp = 0.2, 0.02, lambda k: 0.01 * min(k, 200)
    loop = start(make_loop(ramp, kp=kp, tn_s=tn_s, tv_s=tv_s, max_deviation_mm=1e3))
    loop.run(200)
    assert loop.steps_mm[-1] == pytest.approx(0.01, abs=1e-6)  # the sum carries the ramp alone
    loop.say(*between).run(30).say(DistanceCommand.OFF).run(300)
    assert loop.control.offset_mm == 0.0
    start(loop).run(1)
    assert loop.errors_mm[-1] == pytest.approx(2.0, abs=1e-9)
    assert loop.steps_mm[-1] == pytest.approx(kp * 2.0 * (1 + T / tn_s), abs=1e-9)
