package Faults "Models that must fail at run time, told with time and name"
  model DivisionByZero
    output Real y, x(start = 0, fixed = true);
  equation
    der(x) = 1;
    y = 1/max(0, 0.5 - x);
  end DivisionByZero;

  model RootOfNegative
    output Real y, x(start = 1, fixed = true);
  equation
    der(x) = -1;
    y = sqrt(x);
  end RootOfNegative;

  model LogOfNegative "The derivative itself turns into NaN"
    output Real x(start = 1, fixed = true);
  equation
    der(x) = log(1.5 - time)*0 - 1;
  end LogOfNegative;

  model Diverging
    output Real x(start = 1, fixed = true);
  equation
    der(x) = 1e4*x;
  end Diverging;

  model AssertError
    output Real x(start = 0, fixed = true);
  equation
    der(x) = 1;
    assert(x < 0.5, "x has left its range");
  end AssertError;

  model AssertWarning
    output Real x(start = 0, fixed = true);
  equation
    der(x) = 1;
    assert(x < 0.5, "x is high", AssertionLevel.warning);
  end AssertWarning;

  model AssertAtStart
    parameter Real p = 1;
    output Real x(start = 0, fixed = true);
  equation
    der(x) = p;
    assert(p > 0, "p must be positive");
  end AssertAtStart;

  model Terminating
    output Real x(start = 0, fixed = true);
  equation
    der(x) = 1;
    when x > 0.5 then
      terminate("arrived");
    end when;
  end Terminating;

  model Zeno "Ball whose bounces pile up"
    parameter Real e = 0.5;
    output Real h(start = 1, fixed = true), v(start = 0, fixed = true);
  equation
    der(h) = v;
    der(v) = -9.81;
    when h <= 0 then
      reinit(v, -e*pre(v));
    end when;
  end Zeno;

  model ZenoByMode "Time events that pile up at t = 1"
    discrete output Real next(start = 0.5, fixed = true);
    output Integer n(start = 0, fixed = true);
  equation
    when time >= pre(next) then
      next = 0.5*(1 + time);
      n = pre(n) + 1;
    end when;
  end ZenoByMode;

  model Restless
    output Boolean b(start = false, fixed = true);
  equation
    b = time > 0.5 and not pre(b);
  end Restless;

  model NoSolution "y^2 = 1 - time has no real solution beyond 1 s"
    output Real y(start = 1);
  equation
    y^2 = 1 - time;
  end NoSolution;

  model SingularLoop "The loop has no solution while k = 1"
    parameter Real k = 2;
    Real a;
    output Real b;
  equation
    a = k*b + time;
    b = a - 1;
  end SingularLoop;

  model IndexOutOfRange
    parameter Real table[3] = {1, 2, 3};
    output Integer i;
    output Real y;
  equation
    i = integer(10*time) + 1;
    y = table[i];
  end IndexOutOfRange;

  model RoundedProduct "Product beyond 2^53 inside mod: the rest would be wrong"
    output Integer seed(start = 1, fixed = true);
    discrete Real next(start = 0.01, fixed = true);
  equation
    when time >= pre(next) then
      seed = mod(1103515245*pre(seed) + 12345, 2147483647);
      next = pre(next) + 0.01;
    end when;
  end RoundedProduct;

  model IntegerOverflow
    output Integer n(start = 1, fixed = true);
    discrete Real next(start = 0.01, fixed = true);
  equation
    when time >= pre(next) then
      n = pre(n)*3;
      next = pre(next) + 0.01;
    end when;
  end IntegerOverflow;
end Faults;
