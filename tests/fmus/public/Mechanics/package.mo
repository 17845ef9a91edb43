package Mechanics "Machines and moving bodies"
  model BouncingBall "Ball on a floor, velocity reversed by reinit"
    parameter Real e = 0.8 "Coefficient of restitution";
    parameter Real g = 9.81;
    output Real h(start = 1, fixed = true) "Height";
    output Real v(start = 0, fixed = true);
    output Integer bounces(start = 0, fixed = true);
  equation
    der(h) = v;
    der(v) = -g;
    when h <= 0 then
      reinit(v, -e*pre(v));
      bounces = pre(bounces) + 1;
    end when;
  end BouncingBall;

  model RestingBall "Ball that comes to rest below a velocity"
    parameter Real e = 0.7, g = 9.81;
    output Real h(start = 1, fixed = true), v(start = 0, fixed = true);
    output Boolean flying(start = true, fixed = true);
    Boolean impact;
    Real v_new(start = 0);
  equation
    impact = h <= 0.0;
    der(v) = if flying then -g else 0;
    der(h) = v;
    when {h <= 0.0 and v <= 0.0, impact} then
      v_new = if edge(impact) then -e*pre(v) else 0;
      flying = v_new > 0;
      reinit(v, v_new);
    end when;
  end RestingBall;

  model Pendulum "Length and angle; tension follows algebraically"
    parameter Real m = 1, L = 1, g = 9.81;
    output Real phi(start = 1, fixed = true), w(start = 0, fixed = true);
    output Real F "Tension";
    output Real x, y;
  equation
    der(phi) = w;
    m*L*der(w) = -m*g*sin(phi);
    F = m*L*w^2 + m*g*cos(phi);
    x = L*sin(phi);
    y = -L*cos(phi);
  end Pendulum;

  model CartesianPendulum "The classical index-3 formulation"
    parameter Real m = 1, L = 1, g = 9.81;
    output Real x(start = 0.6), y(start = -0.8);
    Real vx, vy, F;
  equation
    m*der(vx) = -x/L*F;
    m*der(vy) = -y/L*F - m*g;
    der(x) = vx;
    der(y) = vy;
    x^2 + y^2 = L^2;
  end CartesianPendulum;

  model QuarterCar "Wheel and body over a bump"
    parameter Real ms = 250, mu = 40, ks = 15000, cs = 1000, kt = 180000;
    output Real zs(start = 0), zu(start = 0);
    output Real vs(start = 0), vu(start = 0);
    Real road, f;
  equation
    road = if time > 0.5 and time < 0.6 then 0.05*sin(31.41592653589793*(time - 0.5)) else 0;
    f = ks*(zu - zs) + cs*(vu - vs);
    der(zs) = vs;
    der(zu) = vu;
    ms*der(vs) = f;
    mu*der(vu) = kt*(road - zu) - f;
  end QuarterCar;

  connector Flange
    Real s;
    flow Real f;
  end Flange;

  model Mass
    parameter Real m = 1;
    Flange flange;
    Real v(start = 0);
  equation
    v = der(flange.s);
    m*der(v) = flange.f;
  end Mass;

  model SpringDamper
    parameter Real c = 1, d = 0, s_rel0 = 0;
    Flange a, b;
    Real s_rel;
    Real f;
  equation
    s_rel = b.s - a.s;
    f = c*(s_rel - s_rel0) + d*der(s_rel);
    a.f = -f;
    b.f = f;
  end SpringDamper;

  model Fixed
    parameter Real s0 = 0;
    Flange flange;
  equation
    flange.s = s0;
  end Fixed;

  model MassSpringChain "Wall, spring, mass, spring, mass"
    Fixed wall;
    SpringDamper s1(c = 100, d = 1, s_rel0 = 1), s2(c = 50, d = 0.5, s_rel0 = 1);
    Mass m1(m = 1, flange(s(start = 1.2, fixed = true))), m2(m = 2, flange(s(start = 2, fixed = true)));
    output Real x1, x2;
  equation
    connect(wall.flange, s1.a);
    connect(s1.b, m1.flange);
    connect(m1.flange, s2.a);
    connect(s2.b, m2.flange);
    x1 = m1.flange.s;
    x2 = m2.flange.s;
  end MassSpringChain;

  model StickSlip "Block on a belt with Coulomb friction and a stuck state"
    parameter Real m = 1, k = 100, vb = 0.1, Fs = 5, Fc = 3;
    output Real x(start = 0, fixed = true);
    output Real v(start = 0.1, fixed = true);
    output Boolean stuck(start = true, fixed = true);
    output Integer slips(start = 0, fixed = true);
  equation
    der(x) = if stuck then vb else v;
    der(v) = if stuck then 0 else (Fc - k*x)/m;
    when k*x > Fs then
      stuck = false;
      slips = pre(slips) + 1;
    elsewhen not pre(stuck) and v > vb then
      stuck = true;
      slips = pre(slips);
      reinit(v, vb);
    end when;
  end StickSlip;

  model TwoBalls "Two balls that meet elastically, events at the same instant with the walls"
    output Real x1(start = 0.25, fixed = true), x2(start = 0.75, fixed = true);
    output Real v1(start = 1, fixed = true), v2(start = -1, fixed = true);
    output Integer hits(start = 0, fixed = true);
  equation
    der(x1) = v1;
    der(x2) = v2;
    der(v1) = 0;
    der(v2) = 0;
    when x1 >= x2 then
      reinit(v1, pre(v2));
      reinit(v2, pre(v1));
      hits = pre(hits) + 1;
    elsewhen x1 <= 0 or x2 >= 1 then
      reinit(v1, if x1 <= 0 then abs(pre(v1)) else pre(v1));
      reinit(v2, if x2 >= 1 then -abs(pre(v2)) else pre(v2));
      hits = pre(hits) + 1;
    end when;
  end TwoBalls;

  model CoulombBlock "Block that slides to rest under Coulomb friction written with sign()"
    parameter Real mu = 0.2, g = 9.81;
    output Real x(start = 0, fixed = true), v(start = 2, fixed = true);
  equation
    der(x) = v;
    der(v) = -mu*g*sign(v);
  end CoulombBlock;

  model SmoothFriction "The same block with a regularised friction"
    parameter Real mu = 0.2, g = 9.81, vd = 0.01;
    output Real x(start = 0, fixed = true), v(start = 2, fixed = true);
  equation
    der(x) = v;
    der(v) = -mu*g*tanh(v/vd);
  end SmoothFriction;

  model Gears "Two shafts joined rigidly: the inertias add up through an algebraic loop"
    parameter Real J1 = 1, J2 = 4, ratio = 2;
    output Real w1(start = 0, fixed = true);
    Real w2, tau1, tau2;
  equation
    w1 = ratio*w2;
    J1*der(w1) = sin(time) - tau1;
    J2*der(w2) = tau2;
    tau2 = ratio*tau1;
  end Gears;
end Mechanics;
