"""sample(): when a clock ticks, and what the equations that wait for it do."""

import math
from fractions import Fraction

import pytest
from fmpy.fmi1 import FMICallException

from axisrig.fmus import BuildError

COUNTER = "when sample({start}, {interval}) then n = pre(n) + 1; last = time; end when;"
DECLARATION = 'discrete output Real last(unit="s", start=-1, fixed=true);'


def test_ticks_at_start_and_every_interval_without_drift(plant):
    """1/3 s has no exact double; the thousandth tick is at the double next to 1000/3."""
    fmu = plant(COUNTER.format(start=0, interval="1/3"), DECLARATION, step_s=0.05)
    assert (fmu.n, fmu.last) == (1, 0.0)
    for k in range(1, 1001):
        fmu.step(float(Fraction(k, 3)) - fmu.time)
        assert fmu.n == k + 1
    assert fmu.last == pytest.approx(1000 / 3, abs=1e-13)


@pytest.mark.long(but=1)
@pytest.mark.parametrize("step_s", [1e-3, 2.5e-3, 0.1, 0.7])
def test_ticks_do_not_depend_on_the_communication_step(plant, step_s):
    fmu = plant(COUNTER.format(start=0.0123, interval=0.0017), DECLARATION)
    for k in range(1, round(1.4 / step_s) + 1):
        fmu.step(k * step_s - fmu.time)
    ticks = math.floor((fmu.time - 0.0123) / 0.0017)
    assert fmu.n == ticks + 1
    assert fmu.last == pytest.approx(0.0123 + ticks * 0.0017, abs=1e-15)


@pytest.mark.long
def test_tick_at_the_end_of_a_step_is_part_of_it_however_the_time_is_rounded(plant):
    fmu = plant(COUNTER.format(start=0.1, interval=0.1), DECLARATION)
    for k in range(1, 101):
        fmu.step(0.1)  # the sum of tenths is not the multiple of a tenth
        assert fmu.n == k


@pytest.mark.long
def test_interval_follows_the_parameter_of_the_instance(plant):
    declaration = DECLARATION + ' parameter Real ts(unit="s") = 0.1;'
    equation = COUNTER.format(start="ts/2", interval="ts")
    fmu = plant(equation, declaration, ts=0.25)
    fmu.step(1.0)
    assert (fmu.n, fmu.last) == (4, 0.875)


@pytest.mark.long
def test_each_component_has_the_interval_of_its_own_parameter(plant):
    """Two blocks with the same default, one of which is bound to another parameter."""
    classes = """block Counter
    parameter Real ts(unit="s") = 0.1;
    output Integer n(start=0, fixed=true);
  equation
    when sample(ts, ts) then n = pre(n) + 1; end when;
  end Counter;"""
    declaration = 'parameter Real t2(unit="s") = 0.1; Counter a; Counter b(ts = t2);'
    fmu = plant("n = 10*a.n + b.n;", declaration, classes, **{"t2": 0.25})
    fmu.step(1.05)
    assert fmu.n == 104


@pytest.mark.long
def test_interval_that_is_not_above_zero_is_an_error_with_the_place(plant):
    declaration = DECLARATION + ' parameter Real ts(unit="s") = 0.1;'
    fmu = plant(COUNTER.format(start=0, interval="ts"), declaration)
    with pytest.raises(FMICallException):
        fmu.restart(ts=0.0)
    assert (
        "interval of a clock must be above zero, sample() at Small/package.mo:" in fmu.messages[-1]
    )


def test_interval_that_could_not_follow_its_parameter_stops_the_build(plant):
    declaration = DECLARATION + ' parameter Real ts(unit="s") = 0.1;'
    with pytest.raises(BuildError, match="start and interval must be numbers, parameters"):
        plant(COUNTER.format(start=0, interval="sqrt(ts)"), declaration)


@pytest.mark.long
def test_sampled_value_is_that_of_the_instant(plant):
    """x = sin t, sampled every 0.1 s and held."""
    declaration = "Real v(start=1); discrete output Real held(start=0, fixed=true);"
    equation = "der(x) = v; der(v) = -x; when sample(0.1, 0.1) then held = x; n = 0; end when;"
    fmu = plant(equation, declaration, x_start=0)
    for k in range(1, 50):
        fmu.step(0.1 * k + 0.05 - fmu.time)
        assert fmu.held == pytest.approx(math.sin(0.1 * k), abs=1e-12)


@pytest.mark.long
def test_random_numbers_are_exact_and_repeat(plant):
    """Schrage's 16807 generator by its definition in whole numbers; the product passes 2^45."""
    equation = "when sample(0, 0.001) then n = mod(16807*pre(n), 2147483647); end when;"
    fmu = plant(equation, n_start=42)
    state = 42
    for k in range(2000):
        state = 16807 * state % 2147483647
        assert fmu.n == state
        fmu.step((k + 1) / 1000 - fmu.time)


@pytest.mark.long
def test_clock_and_relation_of_one_instant_are_one_event(plant):
    """The relation and the tick both come at t = 0.5; pre(n) is that of before both."""
    declaration = "Integer m(start=0, fixed=true); Real ramp(start=0, fixed=true);"
    equation = (
        "der(ramp) = 1; when {sample(0.5, 1), ramp >= 0.5} then n = pre(n) + 1; end when;"
        " when sample(0.5, 1) then m = n; end when;"
    )
    fmu = plant(equation, declaration)
    fmu.step(1.0)
    assert (fmu.n, fmu.m) == (1, 1)
