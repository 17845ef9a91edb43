"""Functions, arrays and whole numbers in equations."""

import math

import numpy as np
import pytest

from axisrig.fmus import BuildError

CLASSES = """
  function series "sum of u^k/k! by a loop"
    input Real u; input Integer last; output Real v;
  protected
    Real term;
  algorithm
    v := 1; term := 1;
    for k in 1:18 loop
      term := term*u/k;
      if k <= last then v := v + term; end if;
    end for;
  end series;
  function polynomial "value and slope, coefficients from the highest power on"
    input Real c[:]; input Real u; output Real value; output Real slope;
  algorithm
    value := 0; slope := 0;
    for k in 1:size(c, 1) loop
      slope := slope*u + value;
      value := value*u + c[k];
    end for;
  end polynomial;
  function twice input Real u; output Real v; algorithm v := 2*series(u, 18); end twice;
  function rotated
    input Real a; input Real u[2]; output Real v[2];
  protected
    Real m[2, 2];
  algorithm
    m := {{cos(a), -sin(a)}, {sin(a), cos(a)}};
    v := m*u;
  end rotated;
  function external_one
    input Real u; output Real v;
  external "C" v = foreign(u);
  end external_one;
  block Gain parameter Real k = 1; input Real u; output Real y; equation y = k*u; end Gain;
"""


def test_loops_and_branches_in_a_function(plant):
    fmu = plant("y = series(time, 18); n = 0; x = twice(time);", "", CLASSES)
    fmu.step(0.75)
    assert fmu.y == pytest.approx(math.exp(0.75), rel=1e-15)
    assert fmu.x == pytest.approx(2 * math.exp(0.75), rel=1e-15)


def test_function_with_two_results_and_an_array(plant):
    fmu = plant("(y, x) = polynomial({2, -3, 5, 7}, time); n = 0;", "", CLASSES)
    fmu.step(0.3)
    assert fmu.y == pytest.approx(np.polyval([2, -3, 5, 7], 0.3), rel=1e-15)
    assert fmu.x == pytest.approx(np.polyval([6, -6, 5], 0.3), rel=1e-15)


def test_function_on_both_sides_of_a_derivative(plant):
    """x' = -series(x): compared with the closed form of x' = -exp x, x(0) = 1."""
    fmu = plant("der(x) = -series(x, 18); y = x; n = 0;", "", CLASSES)
    fmu.step(2.0)
    assert fmu.y == pytest.approx(-math.log(2.0 + math.exp(-1)), abs=1e-12)


def test_array_function(plant):
    declaration = "Real v[2]; Real w[2];"
    fmu = plant(
        "v = rotated(time, {1, 2}); w = rotated(-time, v); y = w*v; x = w[2]; n = 0;",
        declaration,
        CLASSES,
    )
    fmu.step(0.5)
    assert fmu.x == pytest.approx(2, abs=1e-15)
    assert fmu.y == pytest.approx(5 * math.cos(0.5), rel=1e-14)


def test_external_function_is_refused_with_its_name(plant):
    with pytest.raises(BuildError, match="external"):
        plant("y = external_one(time); n = 0; x = 0;", "", CLASSES)


def test_array_of_components_and_states(plant):
    """Three first-order lags in a chain: the step response of the last one."""
    declaration = "Real s[3](each start=0, each fixed=true); Gain g[3](k = {1, 2, 0.5});"
    equation = """
      g[1].u = 1 - s[1]; g[2].u = g[1].k*s[1] - s[2]; g[3].u = s[2] - s[3];
      for i in 1:3 loop der(s[i]) = g[i].u; end for;
      y = s[3]; x = sum(g.y); n = 0;"""
    fmu = plant(equation, declaration, CLASSES)
    t = 1.5
    fmu.step(t)
    assert fmu.y == pytest.approx(1 - math.exp(-t) * (1 + t + t * t / 2), abs=1e-12)
    s = [1 - math.exp(-t) * sum(t**k / math.factorial(k) for k in range(m)) for m in (1, 2, 3)]
    assert fmu.x == pytest.approx((1 - s[0]) + 2 * (s[0] - s[1]) + 0.5 * (s[1] - s[2]), abs=1e-12)


@pytest.mark.long(but=1)
@pytest.mark.parametrize(("a", "b"), [(7, 3), (-7, 3), (7, -3), (-7, -3), (6, 3), (-6, 3)])
def test_whole_number_division_has_the_signs_of_the_language(plant, a, b):
    """mod has the sign of the divisor, rem that of the dividend; div cuts towards zero."""
    declaration = f"parameter Integer a = {a}; Integer m; Integer r; Integer d;"
    fmu = plant(f"m = mod(a, {b}); r = rem(a, {b}); d = div(a, {b}); n = 0;", declaration)
    assert (fmu.m, fmu.r, fmu.d) == (a % b, int(math.fmod(a, b)), int(a / b))


def test_jumps_of_whole_parts_are_events(plant):
    """The integral of floor(3t) + mod(t, 0.3) + ceil(-2t), exact although jumps lie in steps."""
    equation = "der(x) = floor(3*time) + mod(time, 0.3) + ceil(-2*time); y = x; n = 0;"
    fmu = plant(equation, x_start=0, step_s=0.01)
    fmu.step(1.5)
    floors = sum(k / 3 for k in range(4)) + 4 * (1.5 - 4 / 3)
    mods = 5 * 0.3**2 / 2
    ceils = -sum(k / 2 for k in range(3))
    assert fmu.y == pytest.approx(floors + mods + ceils, abs=1e-10)


def test_each_call_is_that_of_its_function(plant):
    """Several functions in nested calls, in one equation, in a loop and in when-clauses."""
    classes = """
      function f input Real u; output Real v; algorithm v := g(u) + 1; end f;
      function g input Real u; output Real v; algorithm v := u*u; end g;
      function h input Real u; output Real v; algorithm v := 3 - u; end h;
      block B input Real u; output Real y; equation y = h(g(u)) + f(u); end B;
    """
    declaration = """Real w[3]; B b1; B b2; discrete Real s(start=0, fixed=true);
      parameter Real p = 2; parameter Real q = f(p) + h(p);"""
    equation = """
      for i in 1:3 loop w[i] = g(h(i*time)); end for;
      b1.u = time; b2.u = h(time);
      y = f(g(h(time))) + h(time);
      x = f(b2.y);
      when g(time) > 0.2 then s = f(time) + h(pre(s)); end when;"""
    fmu = plant(equation, declaration, classes)
    fmu.step(0.7)
    f, g, h = lambda u: u * u + 1, lambda u: u * u, lambda u: 3 - u
    b = [h(g(u)) + f(u) for u in (0.7, h(0.7))]
    assert fmu.y == pytest.approx(f(g(h(0.7))) + h(0.7), rel=1e-14)
    assert fmu.x == pytest.approx(f(b[1]), rel=1e-14)
    assert fmu.s == pytest.approx(f(math.sqrt(0.2)) + h(0), abs=1e-9)
    assert fmu.q == f(2) + h(2)
    assert fmu.get("b1.y") == pytest.approx(b[0], rel=1e-14)
