"""Bit 4 of the controlword in homing: what its edges start, break off, and leave as it is."""

import pytest
from homing_machine import ATTAINED, ERROR, REACHED, UNITS_PER_MM, Bench, Switch

GENTLE = round(100 * UNITS_PER_MM)
"""609A of 100 mm/s2: 5 mm/s take 50 ms."""


@pytest.mark.parametrize("before", [1, 3, 8])
def test_a_bit_that_is_there_when_the_mode_comes_starts_nothing(before: int) -> None:
    """Homing begins with a rising edge in its own mode."""
    bench = Bench(7.0)
    place = bench.image.position_actual
    bench.write(mode=before, homing_method=37, controlword=0x0F, target_position=place)
    bench.run_ms(5)
    bench.write(controlword=0x1F)
    bench.run_ms(5)
    bench.write(mode=6)
    bench.run_ms(50)
    assert bench.bits == REACHED
    assert bench.image.position_actual == place
    bench.write(controlword=0x0F)
    bench.run_ms(5)
    assert bench.bits == REACHED
    bench.write(controlword=0x1F)
    bench.run_ms(5)
    assert bench.bits == ATTAINED | REACHED


def test_a_bit_that_is_there_at_power_starts_nothing() -> None:
    """Operation is enabled with 001F at once."""
    bench = Bench(7.0)
    bench.write(controlword=0, homing_method=37)
    for word in (0x06, 0x07, 0x1F):
        bench.write(controlword=word)
    bench.run_ms(50)
    assert bench.bits == REACHED
    bench.write(controlword=0x0F)
    bench.write(controlword=0x1F)
    bench.run_ms(5)
    assert bench.bits == ATTAINED | REACHED


def test_a_bit_that_is_held_homes_once() -> None:
    bench = Bench(7.0)
    bench.write(homing_method=37, home_offset=5000, controlword=0x1F)
    bench.run_ms(5)
    bench.write(home_offset=9000)
    bench.run_ms(50)
    assert bench.image.position_actual == -5000


@pytest.mark.parametrize("method", [33, 34])
@pytest.mark.parametrize("late_ms", [1, 20, 45, 60])
def test_home_that_was_found_stays_when_the_bit_falls_while_the_axis_comes_to_rest(
    method: int, late_ms: int
) -> None:
    """5 mm/s with 100 mm/s2: 50 ms of ramp after the zero pulse."""
    bench = Bench(2.6 if method == 33 else 2.4)
    bench.write(homing_acceleration=GENTLE)
    bench.write(homing_method=method, controlword=0x1F)
    for _ in range(400):
        bench.run_ms(0.5)
        if bench.bits & ATTAINED:
            break
    assert bench.bits == ATTAINED
    bench.run_ms(late_ms)
    bench.write(controlword=0x0F)
    bench.run_ms(150)
    assert bench.bits == ATTAINED | REACHED
    found_mm = bench.place_mm - bench.image.position_actual / UNITS_PER_MM
    assert found_mm == pytest.approx(2.5, abs=1.01 / UNITS_PER_MM)


@pytest.mark.parametrize("word", [0x0F, 0x1F])
def test_a_bit_that_falls_after_an_error_leaves_the_error(word: int) -> None:
    """Until the next start, or the mode ends."""
    bench = Bench(7.0)
    bench.write(homing_method=17, controlword=0x1F)
    bench.run_ms(50)
    assert bench.bits == ERROR | REACHED
    bench.write(controlword=word)
    bench.run_ms(50)
    assert bench.bits == ERROR | REACHED


def test_an_axis_that_was_broken_off_may_be_started_before_it_rests() -> None:
    """The new start leads it from where it is, as fast as it is."""
    bench = Bench(0.0, {"positive": Switch(3.0, 1e9), "negative": Switch(-1e9, -100.0)})
    bench.write(homing_acceleration=GENTLE)
    bench.write(homing_method=18, controlword=0x1F)
    bench.run_ms(100)
    bench.write(controlword=0x0F)
    bench.run_ms(20)
    speed = bench.axis.ramp[2]
    assert speed > 0.005
    bench.write(controlword=0x1F)
    bench.run_ms(0.5)
    assert bench.axis.ramp[2] == pytest.approx(speed, abs=1e-3 * 100e-3 * 2)
    bench.run_ms(50)
    assert bench.axis.ramp[2] > speed
    assert bench.bits == 0


# What homing takes from the probes comes back


class Probing(Bench):
    """With the habit that homing switches both probes off."""

    def __init__(self, start_mm: float = 7.0) -> None:
        super().__init__(start_mm, homing="off")
        self.write(homing_acceleration=GENTLE)

    def may_probe(self) -> bool:
        self.write(probe_function=0)
        self.write(probe_function=0x0011)
        return bool(self.image.probe_status & 1)


@pytest.mark.parametrize("halts_ms", [5, 30])
def test_probes_are_free_after_a_halt_on_the_way_to_rest(halts_ms: int) -> None:
    """Broken off, halted while it brakes, and let go: homing is over."""
    bench = Probing()
    assert bench.may_probe()
    bench.write(homing_method=33, controlword=0x1F)
    bench.run_ms(100)
    assert not bench.may_probe()
    bench.write(controlword=0x0F)
    bench.run_ms(halts_ms)
    bench.write(controlword=0x10F)
    bench.run_ms(10)
    assert bench.may_probe()
    bench.write(controlword=0x0F)
    bench.run_ms(200)
    assert bench.bits == REACHED
    assert bench.may_probe()


@pytest.mark.parametrize(("method", "is_found"), [(33, True), (17, False)])
def test_probes_are_free_after_home_was_found_or_not(method: int, is_found: bool) -> None:
    bench = Probing(2.7)
    bench.home(method)
    assert bench.bits == (ATTAINED if is_found else ERROR) | REACHED
    assert bench.may_probe()


def test_probes_are_free_in_a_halt_and_taken_again_after_it() -> None:
    bench = Probing()
    bench.write(homing_method=33, controlword=0x1F)
    bench.run_ms(60)
    bench.write(controlword=0x11F)
    bench.run_ms(100)
    assert bench.may_probe()
    bench.write(controlword=0x1F)
    bench.run_ms(20)
    assert not bench.may_probe()


@pytest.mark.parametrize("word", [0x00, 0x06, 0x07])
def test_probes_are_free_without_power(word: int) -> None:
    bench = Probing()
    bench.write(homing_method=33, controlword=0x1F)
    bench.run_ms(60)
    bench.write(controlword=word)
    bench.run_ms(100)
    assert bench.may_probe()
