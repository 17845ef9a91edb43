"""Homing: how it fails."""

import math

import pytest
from homing_machine import ATTAINED, ERROR, FAST, REACHED, UNITS_PER_MM, Bench, Switch


def failed(bench: Bench, method: int) -> float:
    bench.home(method)
    assert bench.bits == ERROR | REACHED
    assert bench.emergencies == []
    return bench.place_mm


@pytest.mark.long
@pytest.mark.parametrize("method", [3, 19])
def test_limit_switch_in_the_way_is_an_error(method: int) -> None:
    switches = {
        "negative": Switch(-1e9, -50.0),
        "positive": Switch(60.0, 1e9),
        "home": Switch(70.0, 1e9),
    }
    place_mm = failed(Bench(0.0, switches), method)
    # v dt until it is seen, then v2/2a with the homing acceleration of 1000 mm/s2
    assert 60.0 < place_mm < 60.0 + FAST * 0.5e-3 + FAST**2 / 2000 + 1e-3


@pytest.mark.parametrize("method", [7, 11, 23])
def test_home_switch_that_is_nowhere_is_looked_for_between_both_limits(method: int) -> None:
    switches = {
        "negative": Switch(-1e9, -5.0),
        "positive": Switch(6.0, 1e9),
        "home": Switch(70.0, 71.0),
    }
    bench = Bench(0.0, switches)
    place_mm = failed(bench, method)
    beyond_mm = FAST**2 / 2000  # 609A is 1000 mm/s2
    expected_mm = 6.0 + beyond_mm if method == 11 else -5.0 - beyond_mm
    assert place_mm == pytest.approx(expected_mm, abs=FAST * 0.5e-3)
    travelled_mm = [p * 1e3 for p in bench.axis.past]
    assert min(travelled_mm) < -5.0 < 6.0 < max(travelled_mm)


def test_both_limits_at_once_are_an_error() -> None:
    switches = {"negative": Switch(-1e9, 1e9), "positive": Switch(-1e9, 1e9), "home": Switch(5, 9)}
    assert failed(Bench(0.0, switches), 23) == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("method", [1, 2, 3, 17, 30])
def test_switch_that_is_not_wired_is_an_error_at_once(method: int) -> None:
    assert failed(Bench(7.0), method) == 7.0


def test_blocked_axis_is_an_error() -> None:
    assert failed(Bench(0.0, {"home": Switch(50.0, 60.0)}, wall_mm=20.0), 19) == pytest.approx(20.0)


def test_a_new_start_clears_the_error() -> None:
    bench = Bench(7.0)
    failed(bench, 17)
    bench.write(controlword=0x0F)
    bench.home(37)
    assert bench.bits == ATTAINED | REACHED


@pytest.mark.parametrize("method", [0, 15, 16, 31, 32, 36, 40, -5])
def test_unknown_method_by_pdo_is_an_error(method: int) -> None:
    assert failed(Bench(7.0), method) == 7.0


def test_each_homing_may_turn_round_once_at_a_limit_switch() -> None:
    """The cam of the home switch is from 8 to 9 mm; up to the limit at 12, then down to that at 5.

    What the first homing had to turn round for is none of the second one's.
    """
    switches = {
        "negative": Switch(-1e9, 5.0),
        "positive": Switch(12.0, 1e9),
        "home": Switch(8.0, 9.0),
    }
    bench = Bench(11.0, switches)
    bench.home(23)
    assert bench.bits == ATTAINED | REACHED
    assert max(bench.axis.past) > 12e-3
    assert min(bench.axis.past) > 5e-3
    bench.write(controlword=0x0F)
    bench.home(27)
    assert bench.bits == ATTAINED | REACHED
    assert min(bench.axis.past) < 5e-3


@pytest.mark.parametrize("other", [8, 1, 3])
def test_an_error_of_homing_is_gone_with_its_mode(other: int) -> None:
    """Back in mode 6 nothing has been started yet: neither an error nor a reference (CiA 402-2)."""
    bench = Bench(7.0)
    failed(bench, 17)
    bench.write(controlword=0x0F)
    assert bench.bits & ERROR
    bench.write(mode=other, target_position=bench.image.position_actual)
    assert bench.bits & ERROR == 0
    bench.run_ms(2)
    bench.write(mode=6)
    bench.run_ms(200)
    assert bench.bits == REACHED
    bench.home(37)
    assert bench.bits == ATTAINED | REACHED


def test_a_reference_stays_when_the_mode_is_left_and_an_error_does_not_take_its_bit_back() -> None:
    bench = Bench(7.0)
    bench.home(37)
    bench.write(controlword=0x0F)
    bench.write(mode=8, target_position=bench.image.position_actual)
    bench.run_ms(2)
    bench.write(mode=6)
    bench.run_ms(200)
    assert bench.bits == ATTAINED | REACHED
    bench.write(homing_method=17, controlword=0x1F)
    bench.run_ms(200)
    assert bench.bits == ERROR | REACHED


@pytest.mark.parametrize("is_home", [False, True])
def test_a_homing_that_is_broken_off_has_attained_nothing(is_home: bool) -> None:
    """Bit 4 is taken back on the way to the switch at 50 mm; a home of before does not count."""
    bench = Bench(0.0, {"home": Switch(50.0, 60.0)})
    if is_home:
        bench.home(37)
        bench.write(controlword=0x0F)
        assert bench.bits & ATTAINED
    bench.write(homing_method=19, controlword=0x1F)
    bench.run_ms(100)
    assert bench.bits == 0
    bench.write(controlword=0x0F)
    bench.run_ms(300)
    assert bench.bits == REACHED
    assert 0.0 < bench.place_mm < 50.0


@pytest.mark.parametrize("late_ms", [1, 500])
def test_a_start_bit_that_falls_when_home_is_found_takes_nothing_away(late_ms: float) -> None:
    """Method 37 has its home at once; coming to rest and resting there are no search any more."""
    bench = Bench(7.0)
    bench.write(homing_method=37, controlword=0x1F)
    bench.run_ms(late_ms)
    bench.write(controlword=0x0F)
    bench.run_ms(300)
    assert bench.bits == ATTAINED | REACHED


@pytest.mark.parametrize(("method", "start_mm"), [(17, 1.5), (18, 2.5)])
def test_both_limits_at_once_are_an_error_while_one_of_them_is_looked_for(
    method: int, start_mm: float
) -> None:
    """The other one comes on with it: which of both the axis has met is not known.

    It is 0.5 mm from the limit, speeds up by 1000 mm/s2 (609A) until it is there and brakes as
    fast: it stands 0.5 mm beyond.
    """
    switches = {"negative": Switch(-1e9, 1.0), "positive": Switch(3.0, 1e9)}
    bench = Bench(start_mm, switches)
    other = switches["positive" if method == 17 else "negative"]
    other.low_mm, other.high_mm = (-1e9, 1.0) if method == 17 else (3.0, 1e9)
    # 0.5 ms until the switch is read: at 31.6 mm/s, and 0.5 mm/s faster then
    late_mm = 2 * math.sqrt(2 * 1000 * 0.5) * 0.5e-3
    assert failed(bench, method) == pytest.approx(0.5 if method == 17 else 3.5, abs=late_mm)
    assert not bench.bits & ATTAINED


@pytest.mark.parametrize(
    ("objects", "most_mm_s"),
    [
        ({"max_profile_velocity": round(10 * UNITS_PER_MM)}, 10.0),
        ({"max_motor_speed": 12}, 2.0),  # 12 rev/min of 10 mm
        ({"max_profile_velocity": round(80 * UNITS_PER_MM), "max_motor_speed": 600}, FAST),
    ],
)
@pytest.mark.parametrize("method", [17, 18])
def test_a_search_is_no_faster_than_the_drive_may_be(
    objects: dict[str, int], most_mm_s: float, method: int
) -> None:
    """607F and 6080 limit 6099 too, in either direction."""
    switches = {"negative": Switch(-1e9, -100.0), "positive": Switch(100.0, 1e9)}
    bench = Bench(0.0, switches)
    bench.write(**objects)
    bench.write(homing_method=method, controlword=0x1F)
    bench.run_ms(120)
    velocity_mm_s = bench.axis.ramp[2] * 1e3
    assert velocity_mm_s == pytest.approx(most_mm_s * (-1 if method == 17 else 1), rel=1e-3)


@pytest.mark.parametrize("method", [1, 2, 7, 11])
def test_a_limit_switch_before_the_zero_pulse_is_an_error(method: int) -> None:
    """The marks are 2.5 mm beside whole revolutions; the other switch is met on the way to it."""
    negative, positive = Switch(-1e9, -50.0), Switch(60.0, 1e9)
    start_mm = {1: -50.5, 2: 60.5, 7: 12.5, 11: 17.5}[method]
    if method == 1:
        positive.low_mm = -48.5  # the mark is at -47.5
    elif method == 2:
        negative.high_mm = 53.5  # at 52.5
    elif method == 7:
        negative.high_mm = 4.0  # at 2.5, below a cam from 12 to 18 mm
    else:
        positive.low_mm = 21.0  # at 22.5
    switches = {"negative": negative, "positive": positive, "home": Switch(12.0, 18.0)}
    bench = Bench(start_mm, switches)
    bench.write(homing_speed_zero=round(FAST * UNITS_PER_MM))
    place_mm = failed(bench, method)
    end_mm = {1: -48.5, 2: 53.5, 7: 4.0, 11: 21.0}[method]
    # 50 mm/s: 0.5 ms until the switch is read, then v2/2a with 1000 mm/s2
    away_mm = (place_mm - end_mm) * (1 if method in (1, 11) else -1)
    assert 1.25 <= away_mm <= 1.25 + FAST * 0.5e-3 + 1e-3
    # It does not turn round: that is for the search of the switch
    travelled_mm = [place_m * 1e3 for place_m in bench.axis.past]
    if method in (2, 7):
        assert max(travelled_mm) == start_mm
    else:
        assert min(travelled_mm) == start_mm


@pytest.mark.parametrize("method", [18, 17])
def test_an_acceleration_of_0_is_one_unit(method: int) -> None:
    """A PDO can write it: the axis hardly moves, and homing is under way."""
    switches = {"negative": Switch(-1e9, -100.0), "positive": Switch(100.0, 1e9)}
    bench = Bench(0.0, switches)
    bench.write(homing_acceleration=0)
    bench.write(homing_method=method, controlword=0x1F)
    bench.run_ms(50)
    assert bench.bits == 0
    assert abs(bench.axis.demand_position_m()) < 1e-6


def test_each_homing_has_its_own_time_at_standstill() -> None:
    """6070 = 50 ms: bit 10 comes so long after home is found, the second time too."""
    bench = Bench(7.0)
    bench.write(velocity_threshold_ms=50)
    for _ in range(3):
        bench.run_ms(200)
        bench.write(homing_method=37, controlword=0x1F)
        bench.run_ms(49)
        assert bench.bits == ATTAINED
        bench.run_ms(2)
        assert bench.bits == ATTAINED | REACHED
        bench.write(controlword=0x0F)


@pytest.mark.parametrize("method", [17, 18])
def test_rest_is_not_said_before_the_ramp_is_over(method: int) -> None:
    """50 mm/s with 1000 mm/s2 take 50 ms, whatever 606F calls a standstill."""
    switches = {"negative": Switch(-1e9, -100.0), "positive": Switch(100.0, 1e9)}
    bench = Bench(0.0, switches)
    bench.write(velocity_threshold=round(100 * UNITS_PER_MM), velocity_threshold_ms=0)
    bench.write(homing_method=method, controlword=0x1F)
    bench.run_ms(100)
    bench.write(controlword=0x0F)
    bench.run_ms(49)
    assert bench.bits == 0
    bench.run_ms(2)
    assert bench.bits == REACHED
