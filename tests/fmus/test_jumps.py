"""reinit(), warnings and terminate(): what happens at an event beside discrete equations."""

import math

import pytest
from fmpy.fmi1 import FMICallException

BALL = (
    "der(x) = v; der(v) = -9.81; when x <= 0 then reinit(v, -e*pre(v)); n = pre(n) + 1; end when;"
)
DECLARATION = "Real v(start=0, fixed=true); parameter Real e = 0.8;"


def test_ball_bounces_as_in_closed_form(plant):
    fmu = plant(BALL, DECLARATION)
    g, speed = 9.81, math.sqrt(2 * 9.81)
    landed = speed / g
    for k in range(1, 120):
        fmu.step(0.02)
        t = 0.02 * k
        while t > landed + 2 * 0.8 * speed / g:
            landed += 2 * 0.8 * speed / g
            speed *= 0.8
        flight = t - landed
        height = 1 - g * t * t / 2 if flight < 0 else 0.8 * speed * flight - g * flight**2 / 2
        assert fmu.x == pytest.approx(height, abs=1e-9)


def test_bounces_that_pile_up_end_with_place_and_time(plant):
    """With e = 0.5 the flights sum up to 3 sqrt(2/g)."""
    fmu = plant(BALL, DECLARATION, e=0.5)
    end = 3 * math.sqrt(2 / 9.81)
    fmu.step(end - 1e-3)
    with pytest.raises(FMICallException):
        fmu.step(2e-3)
    assert fmu.messages[-1].startswith("Small/package.mo:8: events with reinit() follow each other")
    assert float(fmu.messages[-1].split("t = ")[1].split()[0]) == pytest.approx(end, abs=1e-5)


def test_warning_is_told_once_with_its_values_and_the_run_goes_on(plant):
    equation = (
        'der(x) = -1; assert(x > 0.5, "x is " + String(x) + ", n " + String(n), '
        "AssertionLevel.warning); n = 7;"
    )
    fmu = plant(equation)
    for _ in range(9):
        fmu.step(0.1)
    assert len(fmu.messages) == 1
    assert fmu.messages[0].startswith("Small/package.mo:8: x is 0.5, n 7 (t = 0.5")
    assert fmu.x == pytest.approx(0.1, abs=1e-12)


def test_terminate_tells_text_place_and_time(plant):
    fmu = plant('der(x) = -1; when x < 0.25 then terminate("far enough"); end when;')
    fmu.slave.doStep(0.0, 0.5)
    fmu.slave.doStep(0.5, 0.5)
    assert fmu.messages[-1].startswith("terminate: Small/package.mo:8: far enough (t = 0.75")
    assert fmu.x == pytest.approx(0.25, abs=1e-10)
