package Logic "Events and discrete variables"
  model Edges "edge, change and pre"
    Boolean b;
    output Integer rising(start = 0, fixed = true), changes(start = 0, fixed = true), falling(start = 0, fixed = true);
  equation
    b = sin(10*time) > 0.3;
    when edge(b) then
      rising = pre(rising) + 1;
    end when;
    when change(b) then
      changes = pre(changes) + 1;
    end when;
    when not b then
      falling = pre(falling) + 1;
    end when;
  end Edges;

  model FlipFlop "Set-reset, reset dominant"
    Boolean s, r;
    output Boolean q(start = false, fixed = true);
  equation
    s = sin(time) > 0.9;
    r = sin(time) < -0.9;
    q = (s or pre(q)) and not r;
  end FlipFlop;

  model BinaryCounter "Three toggling stages: each falling edge clocks the next"
    Boolean clock;
    output Boolean b0(start = false, fixed = true), b1(start = false, fixed = true), b2(start = false, fixed = true);
    output Integer value;
  equation
    clock = sin(20*time) > 0;
    when clock then
      b0 = not pre(b0);
    end when;
    when not b0 then
      b1 = not pre(b1);
    end when;
    when not b1 then
      b2 = not pre(b2);
    end when;
    value = (if b0 then 1 else 0) + (if b1 then 2 else 0) + (if b2 then 4 else 0);
  end BinaryCounter;

  model Debounce "Output follows after 20 ms of rest"
    parameter Real t_rest = 0.02;
    Boolean raw;
    discrete Real t_change(start = -1, fixed = true);
    output Boolean clean(start = false, fixed = true);
    output Integer n(start = 0, fixed = true);
  equation
    raw = (time > 0.1 and time < 0.105) or (time > 0.11 and time < 0.112) or (time > 0.12 and time < 0.5);
    when change(raw) then
      t_change = time;
    end when;
    when time >= t_change + t_rest and raw <> pre(clean) then
      clean = raw;
      n = pre(n) + 1;
    end when;
  end Debounce;

  model TrafficLight "Red 3 s, red-amber 1 s, green 4 s, amber 1 s"
    output Integer state(start = 1, fixed = true);
    discrete output Real t_next(start = 3, fixed = true);
  equation
    when time >= pre(t_next) then
      state = if pre(state) == 1 then 2 elseif pre(state) == 2 then 3 elseif pre(state) == 3 then 4 else 1;
      t_next = pre(t_next) + (if state == 1 then 3 elseif state == 2 then 1 elseif state == 3 then 4 else 1);
    end when;
  end TrafficLight;

  model WhenElsewhen "Priority of the first branch when both become true"
    output Integer first(start = 0, fixed = true), second(start = 0, fixed = true);
  equation
    when time >= 1 then
      first = 1;
      second = 10;
    elsewhen time >= 1 then
      first = 2;
      second = 20;
    elsewhen time >= 2 then
      first = 3;
      second = 30;
    end when;
  end WhenElsewhen;

  model Vector "when with a list of conditions"
    output Integer n(start = 0, fixed = true);
  equation
    when {time > 1, sin(time) > 0.99, time > 3} then
      n = pre(n) + 1;
    end when;
  end Vector;

  model Simultaneous "Two relations that cross at the very same instant"
    Real a, b;
    output Integer na(start = 0, fixed = true), nb(start = 0, fixed = true), together(start = 0, fixed = true);
    output Real x(start = 0, fixed = true);
  equation
    a = sin(3*time);
    b = -2*sin(3*time);
    der(x) = if a > 0 then 1 else -1;
    when a < 0 then
      na = pre(na) + 1;
    end when;
    when b > 0 then
      nb = pre(nb) + 1;
    end when;
    when a < 0 and b > 0 then
      together = pre(together) + 1;
    end when;
  end Simultaneous;

  model CascadeOfEvents "One event triggers the next at the same instant"
    output Integer a(start = 0, fixed = true), b(start = 0, fixed = true), c(start = 0, fixed = true), d(start = 0, fixed = true);
    discrete output Real t_d(start = 0, fixed = true);
  equation
    when time >= 0.5 then
      a = pre(a) + 1;
    end when;
    when a > 0 then
      b = pre(b) + a;
    end when;
    when pre(b) > 0 then
      c = pre(c) + 1;
    end when;
    when pre(c) > 0 then
      d = pre(d) + 1;
      t_d = time;
    end when;
  end CascadeOfEvents;

  model CloseEvents "Two events 1e-9 s apart"
    parameter Real t1 = 0.3333333, gap = 1e-9;
    output Real x(start = 0, fixed = true);
    output Integer n(start = 0, fixed = true), order(start = 0, fixed = true);
    discrete output Real ta(start = 0, fixed = true), tb(start = 0, fixed = true);
  equation
    der(x) = 1;
    when x > t1 then
      ta = time;
    end when;
    when x > t1 + gap then
      tb = time;
    end when;
    when {x > t1, x > t1 + gap} then
      n = pre(n) + 1;
    end when;
    when tb > 0 then
      order = if pre(ta) > 0 then 1 else 2;
    end when;
  end CloseEvents;

  model AtCommunicationPoint "State event exactly where the master stops"
    output Real x(start = 0, fixed = true);
    output Integer n(start = 0, fixed = true);
    discrete output Real t_event(start = 0, fixed = true);
  equation
    der(x) = 1;
    when x >= 0.5 then
      n = pre(n) + 1;
      t_event = time;
    end when;
  end AtCommunicationPoint;

  model TouchOnly "A parabola that touches zero without crossing it"
    output Real z;
    output Integer n(start = 0, fixed = true);
  equation
    z = (time - 0.5)^2;
    when z < 0 then
      n = pre(n) + 1;
    end when;
  end TouchOnly;

  model BooleanAlgebra
    Boolean a, b, c;
    output Boolean andor, xor_, implies, nested;
    output Integer word;
  equation
    a = sin(time) > 0;
    b = sin(2*time) > 0;
    c = cos(3*time) < 0.2;
    andor = a and b or not c and (a or b);
    xor_ = a <> b;
    implies = not a or b;
    nested = not (a == b) and (if c then a else not b);
    word = (if andor then 1 else 0) + (if xor_ then 2 else 0) + (if implies then 4 else 0) + (if nested then 8 else 0);
  end BooleanAlgebra;

  model BooleanInput "Counts rising edges of an input"
    input Boolean u(start = false);
    input Integer k(start = 1);
    output Integer n(start = 0, fixed = true);
  equation
    when u then
      n = pre(n) + k;
    end when;
  end BooleanInput;

  model Algorithmic "when in an algorithm section"
    output Integer n(start = 0, fixed = true), m(start = 0, fixed = true);
  algorithm
    when time > 0.25 then
      n := pre(n) + 1;
    elsewhen time > 0.75 then
      n := 10*pre(n);
    end when;
    if n > 5 then
      m := 2*n;
    else
      m := -n;
    end if;
  end Algorithmic;

  model LaterWins "Two when-clauses of an algorithm assign one variable"
    output Integer n(start = 0, fixed = true);
  algorithm
    when time > 0.25 then
      n := pre(n) + 1;
      n := n*10;
    end when;
    when time > 0.75 then
      n := n + 5;
    end when;
  end LaterWins;

  model SameInstant "What happens at one instant is seen by all at that instant"
    Real x(start = 0, fixed = true);
    output Integer a(start = 0, fixed = true), b(start = 0, fixed = true), c(start = 0, fixed = true), d;
    discrete output Real s(start = -1, fixed = true), w(start = -1, fixed = true);
  equation
    der(x) = 1;
    when x > 0.5 then
      b = 10*a + c;
      c = a + 1;
      a = pre(a) + 1;
    end when;
    when 2*x > 1 then
      w = 2*s + a;
      s = x;
    end when;
    d = a + b;
  end SameInstant;

  model ShiftRegister "Three stages clocked by time events"
    output Integer n(start = 0, fixed = true), q1(start = 0, fixed = true), q2(start = 0, fixed = true), q3(start = 0, fixed = true);
    discrete Real next(start = 0.25, fixed = true);
  equation
    when time >= pre(next) then
      next = pre(next) + 0.25;
      q1 = n;
      q2 = pre(q1);
      q3 = pre(q2);
      n = pre(n) + 1;
    end when;
  end ShiftRegister;

  model InitiallyTrue "A when-condition that is true from the start fires never, then again"
    output Integer n(start = 0, fixed = true);
  equation
    when cos(time) > 0 then
      n = pre(n) + 1;
    end when;
  end InitiallyTrue;

  model InitialEvent "when initial()"
    output Integer n(start = 0, fixed = true);
    discrete output Real t(start = -1, fixed = true);
  equation
    when {initial(), time > 0.5} then
      n = pre(n) + 1;
      t = time;
    end when;
  end InitialEvent;

  model Sequence "Relation on a discrete variable and a moving limit"
    output Real x(start = 0, fixed = true);
    discrete output Real limit(start = 1, fixed = true);
  equation
    der(x) = 1;
    when x >= pre(limit) then
      limit = pre(limit)*2;
    end when;
  end Sequence;
end Logic;
