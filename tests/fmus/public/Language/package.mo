package Language "Constructs of the language"
  function polynomial "Value and slope by Horner's rule"
    input Real c[:];
    input Real x;
    output Real value;
    output Real slope;
  algorithm
    value := 0;
    slope := 0;
    for k in 1:size(c, 1) loop
      slope := slope*x + value;
      value := value*x + c[k];
    end for;
  end polynomial;

  function heron "Square root by iteration with while and local variables"
    input Real a;
    output Real x;
  protected
    Real old;
    Integer count;
  algorithm
    x := if a > 1 then a else 1;
    old := 0;
    count := 0;
    while abs(x - old) > 1e-14*x and count < 50 loop
      old := x;
      x := 0.5*(x + a/x);
      count := count + 1;
    end while;
  end heron;

  function classify
    input Real u;
    output Integer k;
  algorithm
    if u < -0.5 then
      k := -1;
    elseif u < 0.5 then
      k := 0;
    else
      k := 1;
    end if;
  end classify;

  function table "Linear look-up with arrays"
    input Real u;
    output Real y;
  protected
    Real xs[4] = {0, 1, 2, 4};
    Real ys[4] = {0, 10, 15, 5};
    Integer i;
  algorithm
    i := 1;
    while i < 3 and u > xs[i + 1] loop
      i := i + 1;
    end while;
    y := ys[i] + (u - xs[i])*(ys[i + 1] - ys[i])/(xs[i + 1] - xs[i]);
  end table;

  function factorial "Recursion"
    input Integer n;
    output Integer f;
  algorithm
    f := if n <= 1 then 1 else n*factorial(n - 1);
  end factorial;

  model Functions "Loop over an array of any size, two results"
    output Real value, slope;
  equation
    (value, slope) = polynomial({1, -2, 3, -4}, time);
  end Functions;

  model WhileFunction "Iteration with while"
    output Real root;
  equation
    root = heron(1 + time);
  end WhileFunction;

  model TableFunction "Search in a local array"
    output Real t;
  equation
    t = table(time);
  end TableFunction;

  model IntegerFunction "A whole number that jumps without an event"
    output Integer k;
  equation
    k = classify(sin(3*time));
  end IntegerFunction;

  model ScalarFunction "One scalar function in a derivative"
    function f
      input Real x;
      output Real y;
    algorithm
      y := x/(1 + x*x);
    end f;
    output Real x(start = 1, fixed = true);
  equation
    der(x) = -f(x);
  end ScalarFunction;

  model RecursiveFunction
    output Integer f;
  equation
    f = factorial(if time < 0.5 then 3 else 6);
  end RecursiveFunction;

  model IfEquations
    parameter Boolean fast = false;
    output Real x(start = 0, fixed = true), y;
  equation
    if fast then
      der(x) = 10 - x;
    else
      der(x) = 1 - x;
    end if;
    if time < 1 then
      y = x;
    elseif time < 2 then
      y = 2*x;
    else
      y = -x;
    end if;
  end IfEquations;

  type Mode = enumeration(off, slow, fast);

  model Enumeration
    output Mode mode(start = Mode.off, fixed = true);
    output Real x(start = 0, fixed = true);
  equation
    when time >= 2 then
      mode = Mode.fast;
    elsewhen time >= 1 then
      mode = Mode.slow;
    end when;
    der(x) = if mode == Mode.off then 0 elseif mode == Mode.slow then 1 else 3;
  end Enumeration;

  record Point
    Real x;
    Real y;
  end Point;

  model Records
    Point p(x(start = 1), y(start = 0));
    parameter Point c = Point(x = 2, y = 3);
    output Real distance, x;
  equation
    der(p.x) = -p.y;
    der(p.y) = p.x;
    distance = sqrt((p.x - c.x)^2 + (p.y - c.y)^2);
    x = p.x;
  end Records;

  model Surroundings
    parameter Real g = 1.62;
  end Surroundings;

  model Faller
    outer Surroundings world;
    Real h(start = 100, fixed = true), v(start = 0, fixed = true);
  equation
    der(h) = v;
    der(v) = -world.g;
  end Faller;

  model InnerOuter
    inner Surroundings world(g = 3.7);
    Faller a;
    Faller b(h(start = 50));
    output Real ha, hb;
  equation
    ha = a.h;
    hb = b.h;
  end InnerOuter;

  partial model Law
    Real u, y;
  end Law;

  model Linear
    extends Law;
    parameter Real k = 2;
  equation
    y = k*u;
  end Linear;

  model Quadratic
    extends Law;
    parameter Real k = 2;
  equation
    y = k*u^2;
  end Quadratic;

  model Plant
    replaceable model Spring = Linear constrainedby Law;
    Spring spring;
    output Real y;
  equation
    spring.u = sin(time);
    y = spring.y;
  end Plant;

  model Redeclared
    extends Plant(redeclare model Spring = Quadratic, spring(k = 5));
  end Redeclared;

  model Conditional
    parameter Boolean with_second = true;
    Linear one(k = 1);
    Linear two(k = 10) if with_second;
    output Real y;
  equation
    one.u = time;
    if with_second then
      two.u = 2*time;
      y = two.y;
    else
      y = one.y;
    end if;
  end Conditional;

  model Base
    parameter Real a = 1, b = 2*a;
    output Real x(start = a + b, fixed = true);
  equation
    der(x) = -a*x;
  end Base;

  model Extended "Modification of an inherited parameter; the others follow"
    extends Base(a = 3);
  end Extended;

  model ParameterChain "Parameters and start values that follow parameters"
    parameter Real m = 2;
    parameter Real k = 4*m;
    parameter Real w = sqrt(k/m);
    parameter Real x0 = 1/w;
    final parameter Real T = 6.283185307179586/w;
    output Real x(start = x0, fixed = true), v(start = -x0*w, fixed = true);
  equation
    der(x) = v;
    der(v) = -w^2*x;
  end ParameterChain;

  model ArrayOfComponents
    Linear g[3](k = {1, 2, 3});
    output Real s;
  equation
    for i in 1:3 loop
      g[i].u = i*sin(time);
    end for;
    s = g[1].y + g[2].y + g[3].y;
  end ArrayOfComponents;

  model SteadyStart "Initial equation der(x) = 0"
    parameter Real q = 3, k = 0.5;
    output Real x;
  initial equation
    der(x) = 0;
  equation
    der(x) = q - k*x + (if time > 1 then 1 else 0);
  end SteadyStart;

  model InitialValues "Initial equations by names and of a discrete variable"
    parameter Real p = 4;
    output Real x, y;
    discrete output Real d;
  initial equation
    x = p/2;
    y + x = 10;
    pre(d) = 7*p;
  equation
    der(x) = 1;
    der(y) = x;
    when time > 1 then
      d = 0;
    end when;
  end InitialValues;

  model NonlinearInitial "Steady state of a nonlinear system"
    output Real T(start = 300);
    parameter Real q = 500;
  initial equation
    der(T) = 0;
  equation
    10*der(T) = q - 5.67e-8*(T^4 - 280^4);
  end NonlinearInitial;

  model InitialAlgorithm
    parameter Integer n = 10;
    output Real x;
    Real s;
  initial algorithm
    s := 0;
    for k in 1:n loop
      s := s + k;
    end for;
    x := s;
  equation
    der(x) = -x;
    der(s) = 0;
  end InitialAlgorithm;

  model IntegerArithmetic
    output Integer a, b, c, d, e;
  equation
    a = integer(10*time) - 5;
    b = div(a, 3);
    c = mod(a, 3);
    d = rem(a, 3);
    e = if a < 0 then -a else a;
  end IntegerArithmetic;

  model Rounding
    output Real f, c, s, m, r;
    output Integer i;
    output Real x(start = 0, fixed = true);
    Real u;
  equation
    u = 3*sin(time);
    f = floor(u);
    c = ceil(u);
    i = integer(u + 0.5);
    s = sign(u);
    m = mod(u, 1.25);
    r = rem(u, 1.25);
    der(x) = f;
  end Rounding;

  model AbsSign
    output Real x(start = 0, fixed = true), y(start = 0, fixed = true);
  equation
    der(x) = abs(cos(3*time));
    der(y) = if cos(3*time) > 0 then 1 else -1;
  end AbsSign;

  model Random "Linear congruential generator, exact in Integers"
    output Integer seed(start = 12345, fixed = true);
    output Integer n(start = 0, fixed = true);
    discrete Real next(start = 0.01, fixed = true);
    discrete output Real u(start = 0, fixed = true);
  equation
    when time >= pre(next) then
      seed = mod(16807*mod(pre(seed), 127773) - 2836*div(pre(seed), 127773) + 2147483647, 2147483647);
      n = pre(n) + 1;
      next = pre(next) + 0.01;
      u = seed/2147483647;
    end when;
  end Random;

  model SampledRandom "The same generator under sample(), small modulus"
    output Integer seed(start = 1, fixed = true);
  equation
    when sample(0.005, 0.01) then
      seed = mod(1664*pre(seed) + 1013, 65536);
    end when;
  end SampledRandom;

  model TableByIf
    output Real y;
    Real u;
  equation
    u = 2 + 2*sin(time);
    y = if u < 1 then 10*u elseif u < 2 then 10 + 5*(u - 1) elseif u < 4 then 15 - 5*(u - 2) else 5;
  end TableByIf;

  model Arrays "Sums, products, slices, comprehension"
    parameter Integer n = 4;
    Real v[n], w[n], M[2, 2];
    output Real s, p, dot, biggest, trace, second;
  equation
    for k in 1:n loop
      v[k] = k*time;
    end for;
    w = {sin(k*time) for k in 1:n};
    s = sum(v[2:n]);
    p = product(v);
    dot = v*w;
    biggest = max(w);
    M = [1, time; -time, 2];
    trace = M[1, 1] + M[2, 2];
    second = (M*{1, 1})*{0, 1};
  end Arrays;

  model ImplicitDerivative "Derivative appears inside a product and on the left"
    output Real x(start = 1, fixed = true);
  equation
    (1 + x^2)*der(x) + x = 0;
  end ImplicitDerivative;

  model CoupledDerivatives "Mass matrix"
    output Real x(start = 1, fixed = true), y(start = 0, fixed = true);
  equation
    2*der(x) + der(y) = -x;
    der(x) + 3*der(y) = -y;
  end CoupledDerivatives;

  model Special "Functions of the language"
    output Real a, b, c, d, e, f;
  equation
    a = atan2(sin(time), cos(time));
    b = sinh(time) + cosh(time) + tanh(time);
    c = log(1 + time) + log10(1 + time);
    d = asin(0.9*sin(time)) + acos(0.9*cos(time));
    e = (1 + time)^2.5 + 2^time + time^3;
    f = exp(-time)*tan(0.5*time);
  end Special;

  model Scoped
    import Language.factorial;
    constant Real pi = 2*asin(1.0);
    parameter Real r = 2;
    output Real area;
  protected
    Real hidden;
  equation
    hidden = r^2;
    area = pi*hidden;
  end Scoped;

  model Homotopy
    output Real y;
  equation
    y = homotopy(actual = sin(time), simplified = 0);
  end Homotopy;

  model SemiLinear
    output Real y;
  equation
    y = semiLinear(sin(time), 2, 5);
  end SemiLinear;
end Language;
