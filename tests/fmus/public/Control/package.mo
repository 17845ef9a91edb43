package Control "Controllers and signals"
  model StateSpace "Linear system with matrices"
    parameter Real A[2, 2] = [0, 1; -4, -0.4];
    parameter Real B[2, 1] = [0; 1];
    parameter Real C[1, 2] = [1, 0.5];
    parameter Real D[1, 1] = [0.1];
    Real x[2](each start = 0, each fixed = true);
    Real u[1], y[1];
    output Real out;
  equation
    u[1] = sin(3*time);
    der(x) = A*x + B*u;
    y = C*x + D*u;
    out = y[1];
  end StateSpace;

  model PIDSampled "First-order plant under a sampled PI controller"
    parameter Real Ts = 0.1, kp = 2, ki = 1.5, r = 1;
    output Real x(start = 0, fixed = true);
    discrete output Real u(start = 0, fixed = true);
    discrete Real sum(start = 0, fixed = true);
  equation
    der(x) = -x + u;
    when sample(0, Ts) then
      sum = pre(sum) + Ts*(r - x);
      u = kp*(r - x) + ki*sum;
    end when;
  end PIDSampled;

  model TwoRates "Two samplers, 20 ms and 30 ms, that meet every 60 ms"
    output Integer a(start = 0, fixed = true), b(start = 0, fixed = true), both(start = 0, fixed = true);
  equation
    when sample(0.01, 0.02) then
      a = pre(a) + 1;
    end when;
    when sample(0.01, 0.03) then
      b = pre(b) + 1;
    end when;
    when sample(0.01, 0.06) then
      both = pre(both) + 1;
    end when;
  end TwoRates;

  model SampledInput "Sample and hold of an input"
    input Real u(start = 0);
    discrete output Real held(start = -1, fixed = true);
    output Integer n(start = 0, fixed = true);
  equation
    when sample(0.05, 0.1) then
      held = u;
      n = pre(n) + 1;
    end when;
  end SampledInput;

  model RelayControl "Double integrator switched by a delayed relay: limit cycle"
    parameter Real h = 0.1;
    output Real x(start = 1, fixed = true), v(start = 0, fixed = true);
    output Integer u(start = -1, fixed = true);
  equation
    der(x) = v;
    der(v) = u;
    when x + v > h then
      u = -1;
    elsewhen x + v < -h then
      u = 1;
    end when;
  end RelayControl;

  model Chattering "Bang-bang control without hysteresis: slides"
    output Real x(start = 1, fixed = true);
  equation
    der(x) = if x + 0.1*sin(time) > 0 then -1 else 1;
  end Chattering;

  model Limiter "Clipped sine, integrated"
    parameter Real limit = 0.5;
    output Real y, area(start = 0, fixed = true);
  equation
    y = max(-limit, min(limit, sin(time)));
    der(area) = abs(y);
  end Limiter;

  model SmoothLimiter "The same with noEvent and smooth"
    parameter Real limit = 0.5;
    Real s;
    output Real y, area(start = 0, fixed = true);
  equation
    s = sin(time);
    y = smooth(0, noEvent(if s > limit then limit elseif s < -limit then -limit else s));
    der(area) = noEvent(abs(y));
  end SmoothLimiter;

  model Cascade "Position and velocity loop with limits"
    parameter Real kp = 10, kv = 20, a_max = 5;
    output Real x(start = 0, fixed = true), v(start = 0, fixed = true);
    Real v_ref, a;
  equation
    v_ref = kp*((if time < 0.2 then 0 else 1) - x);
    a = max(-a_max, min(a_max, kv*(v_ref - v)));
    der(x) = v;
    der(v) = a;
  end Cascade;

  model CascadeWithEvents "The same, limited by an if-expression"
    parameter Real kp = 10, kv = 20, a_max = 5;
    output Real x(start = 0, fixed = true), v(start = 0, fixed = true);
    Real v_ref, demand, a;
  equation
    v_ref = kp*((if time < 0.2 then 0 else 1) - x);
    demand = kv*(v_ref - v);
    a = if demand > a_max then a_max elseif demand < -a_max then -a_max else demand;
    der(x) = v;
    der(v) = a;
  end CascadeWithEvents;

  model AntiWindup "PI with a saturated actuator"
    parameter Real kp = 2, Ti = 0.5, u_max = 1.2;
    output Real x(start = 0, fixed = true), i(start = 0, fixed = true);
    Real e, u_raw, u;
  equation
    e = 1 - x;
    u_raw = kp*e + i;
    u = if u_raw > u_max then u_max else if u_raw < -u_max then -u_max else u_raw;
    der(i) = kp/Ti*e + (u - u_raw)/0.1;
    der(x) = u - x;
  end AntiWindup;

  model AlgebraicFeedback "Gain in a loop without delay"
    parameter Real k = 3;
    Real e;
    output Real y;
  equation
    e = sin(time) - y;
    y = k*e;
  end AlgebraicFeedback;

  model SaturatedFeedback "Loop without delay around a limiter: the relation depends on the loop"
    Real e;
    output Real y;
  equation
    e = 2*sin(time) - y;
    y = if e > 0.5 then 0.5 + 0.1*(e - 0.5) elseif e < -0.5 then -0.5 + 0.1*(e + 0.5) else e;
  end SaturatedFeedback;

  model CubicLoop "y + y^3 = u"
    output Real y;
  equation
    y + y^3 = 2*sin(time);
  end CubicLoop;

  model TwoUnknowns "Intersection of a circle of growing radius and a line"
    output Real x(start = 1), y(start = 0);
  equation
    x^2 + y^2 = (1 + time)^2;
    y = 0.5*x;
  end TwoUnknowns;

  model DelayedSine "delay() with a fixed time"
    output Real y;
    Real u;
  equation
    u = sin(time);
    y = delay(u, 0.3);
  end DelayedSine;

  model Steps "Sum of steps at exact multiples of 0.1 s"
    output Real x(start = 0, fixed = true);
    Real rate;
  equation
    rate = (if time >= 0.1 then 1 else 0) + (if time >= 0.2 then 1 else 0) + (if time >= 0.3 then 1 else 0)
      + (if time > 0.4 then 1 else 0);
    der(x) = rate;
  end Steps;

  model Pulse "Next time event computed by the model"
    parameter Real width = 0.3, period = 1;
    discrete output Real next(start = 0.3, fixed = true);
    output Boolean high(start = true, fixed = true);
    output Real x(start = 0, fixed = true);
    output Integer n(start = 0, fixed = true);
  equation
    when time >= pre(next) then
      high = not pre(high);
      next = pre(next) + (if high then width else period - width);
      n = pre(n) + 1;
    end when;
    der(x) = if high then 1 else 0;
  end Pulse;
end Control;
