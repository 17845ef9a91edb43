"""Equations that hold at once, and what decides the start."""

import math

import numpy as np
import pytest
import scipy.linalg
from fmpy.fmi1 import FMICallException
from scipy.optimize import brentq

BRIDGE = """parameter Real r[5] = {100, 220, 330, 470, 150}; parameter Real u = 9;
  Real v[2]; Real i[5];"""
BRIDGE_EQUATIONS = """
  r[1]*i[1] = u - v[1]; r[2]*i[2] = u - v[2]; r[3]*i[3] = v[1]; r[4]*i[4] = v[2];
  r[5]*i[5] = v[1] - v[2]; i[1] = i[3] + i[5]; i[2] + i[5] = i[4]; y = i[5];
"""


def test_linear_loop_is_solved_as_by_elimination(plant):
    """A resistor bridge; reference: its node equations by numpy."""
    fmu = plant(BRIDGE_EQUATIONS, BRIDGE)
    r = [100, 220, 330, 470, 150]
    g = [1 / x for x in r]
    nodes = np.array([[g[0] + g[2] + g[4], -g[4]], [-g[4], g[1] + g[3] + g[4]]])
    v = np.linalg.solve(nodes, [9 * g[0], 9 * g[1]])
    assert fmu.y == pytest.approx((v[0] - v[1]) / 150, rel=1e-13)


def test_loop_without_a_solution_is_told_with_its_variables(plant):
    fmu = plant("x + y = time; x + (1 + p)*y = 1; ", "parameter Real p = 1;")
    fmu.slave.reset()
    with pytest.raises(FMICallException):
        fmu.start(p=0.0)
    assert "no solution of the equations for" in fmu.messages[-1]
    assert "x" in fmu.messages[-1]
    assert "y" in fmu.messages[-1]
    assert fmu.messages[-1].startswith("Small/package.mo:")


def test_coupled_derivatives(plant):
    """A mass matrix in the states; reference: the matrix exponential."""
    declaration = "Real v(start=2, fixed=true);"
    fmu = plant("2*der(x) + der(v) = -x; der(x) + 3*der(v) = -v;", declaration)
    fmu.step(1.5)
    matrix = np.linalg.solve([[2, 1], [1, 3]], -np.eye(2))
    expected = scipy.linalg.expm(1.5 * matrix) @ [1, 2]
    assert (fmu.x, fmu.v) == pytest.approx(tuple(expected), abs=1e-12)


def test_nonlinear_equation_follows_its_branch(plant):
    """y - 0.9 sin y = t (Kepler); reference: bisection."""
    fmu = plant("y - 0.9*sin(y) = time;")
    for k in range(1, 40):
        fmu.step(0.25)
        t = 0.25 * k
        expected = brentq(lambda e, t=t: e - 0.9 * math.sin(e) - t, t - 1, t + 1, xtol=1e-15)
        assert fmu.y == pytest.approx(expected, abs=1e-13)


def test_nonlinear_loop_with_torn_variables(plant):
    """Two diodes with a resistor each behind one source; reference: bisection of one unknown."""
    declaration = "Real i[2]; Real v[2]; Real u; parameter Real r = 100;"
    equation = """
      for k in 1:2 loop i[k] = 1e-9*(exp(v[k]/0.025) - 1); u = v[k] + r*k*i[k]; end for;
      u = 5*sin(time) - 50*(i[1] + i[2]); y = u;"""
    fmu = plant(equation, declaration)

    def currents(u: float) -> float:
        total = 0.0
        for k in (1, 2):
            v = brentq(lambda v, k=k: v + 100 * k * 1e-9 * math.expm1(v / 0.025) - u, -10, 1)
            total += 1e-9 * math.expm1(v / 0.025)
        return total

    for t in np.arange(0.1, 3.1, 0.1):
        fmu.step(0.1)
        u = brentq(lambda u, t=t: 5 * math.sin(t) - 50 * currents(u) - u, -6, 6, xtol=1e-15)
        assert fmu.y == pytest.approx(u, abs=1e-10)


def test_search_without_end_is_told_with_name_and_time(plant):
    """y^2 = 1 - t has no solution behind t = 1."""
    fmu = plant("y^2 = 1 - time + p;", "parameter Real p = 0.25;")
    fmu.step(1.0)
    with pytest.raises(FMICallException):
        fmu.step(0.5)
    assert "no solution of the equations for y was found at t = 1.25" in fmu.messages[-1]


def test_steady_state_at_the_start(plant):
    """der(x) = 0 of x' = -x^3 + u at the start, then u steps; reference: the cubic root."""
    declaration = "input Real u(start=2); initial equation der(x) = 0; equation"
    fmu = plant("der(x) = -x^3 + u;", declaration, x_fixed=False, u=5.0)
    assert fmu.x == pytest.approx(5 ** (1 / 3), rel=1e-13)
    fmu.step(0.5)
    assert fmu.x == pytest.approx(5 ** (1 / 3), rel=1e-12)


def test_parameter_that_the_start_decides(plant):
    """The gain for which the start is at rest, by a nonlinear system over algebraic variables."""
    declaration = """parameter Real k(fixed=false, start=1); Real a; Real b;
      initial equation der(x) = 0; x = 2; equation"""
    fmu = plant("der(x) = a - b; a = k*x^2; b = exp(x) + a/10; y = k;", declaration, x_fixed=False)
    assert fmu.x == pytest.approx(2, rel=1e-15)
    assert fmu.y == pytest.approx(math.exp(2) / (0.9 * 4), rel=1e-13)


def test_start_values_that_contradict_each_other_are_an_error(plant):
    declaration = "parameter Real p = 1; initial equation x = p; equation"
    fmu = plant("der(x) = -x; y = x;", declaration)
    fmu.slave.reset()
    with pytest.raises(FMICallException):
        fmu.start(p=3.0)
    assert "contradicts the other equations" in fmu.messages[-1]


def test_homotopy_is_its_first_argument(plant):
    fmu = plant("homotopy(y^3 + y, y) = 2 + time;")
    fmu.step(1.0)
    assert fmu.y**3 + fmu.y == pytest.approx(3, rel=1e-14)
