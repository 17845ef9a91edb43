package Circuits "Electrical circuits from components"
  type Voltage = Real(unit = "V");
  type Current = Real(unit = "A");

  connector Pin "Electrical terminal"
    Voltage v;
    flow Current i;
  end Pin;

  partial model TwoPin
    Pin p, n;
    Voltage v;
    Current i;
  equation
    v = p.v - n.v;
    0 = p.i + n.i;
    i = p.i;
  end TwoPin;

  model Ground
    Pin p;
  equation
    p.v = 0;
  end Ground;

  model Resistor
    extends TwoPin;
    parameter Real R(unit = "Ohm") = 1;
  equation
    v = R*i;
  end Resistor;

  model Capacitor
    extends TwoPin;
    parameter Real C(unit = "F") = 1;
  equation
    C*der(v) = i;
  end Capacitor;

  model Inductor
    extends TwoPin;
    parameter Real L(unit = "H") = 1;
  equation
    L*der(i) = v;
  end Inductor;

  model Diode "Exponential diode"
    extends TwoPin;
    parameter Current Is = 1e-9;
    parameter Voltage Vt = 0.04;
  equation
    i = Is*(exp(v/Vt) - 1);
  end Diode;

  model NonlinearResistor "Piecewise linear resistor of Chua's circuit"
    extends TwoPin;
    parameter Real Ga = -0.757576, Gb = -0.409091, Ve = 1;
  equation
    i = if v < -Ve then Gb*(v + Ve) - Ga*Ve else if v > Ve then Gb*(v - Ve) + Ga*Ve else Ga*v;
  end NonlinearResistor;

  model SineVoltage
    extends TwoPin;
    parameter Real V = 1, f = 1;
    constant Real pi = 3.14159265358979323846;
  equation
    v = V*sin(2*pi*f*time);
  end SineVoltage;

  model StepVoltage
    extends TwoPin;
    parameter Real V = 1, t0 = 0;
  equation
    v = if time < t0 then 0 else V;
  end StepVoltage;

  model RC "Charging of a capacitor"
    StepVoltage source(V = 5, t0 = 0.1);
    Resistor r(R = 1000);
    Capacitor c(C = 1e-4, v(start = 0, fixed = true));
    Ground ground;
    output Real vc;
    output Real i;
  equation
    connect(source.p, r.p);
    connect(r.n, c.p);
    connect(c.n, source.n);
    connect(source.n, ground.p);
    vc = c.v;
    i = r.i;
  end RC;

  model RLC "Series circuit at a sine"
    SineVoltage source(V = 10, f = 5);
    Resistor r(R = 2);
    Inductor l(L = 0.1);
    Capacitor c(C = 1e-2);
    Ground ground;
    output Real i, vc;
  equation
    connect(source.p, r.p);
    connect(r.n, l.p);
    connect(l.n, c.p);
    connect(c.n, source.n);
    connect(source.n, ground.p);
    i = l.i;
    vc = c.v;
  end RLC;

  model Divider "Two resistors: one linear loop"
    SineVoltage source(V = 3, f = 1);
    Resistor r1(R = 100), r2(R = 200);
    Ground ground;
    output Real v;
  equation
    connect(source.p, r1.p);
    connect(r1.n, r2.p);
    connect(r2.n, source.n);
    connect(source.n, ground.p);
    v = r2.v;
  end Divider;

  model Bridge "Wheatstone bridge: five resistors, linear system"
    SineVoltage source(V = 3, f = 1);
    Resistor r1(R = 100), r2(R = 220), r3(R = 330), r4(R = 470), r5(R = 50);
    Ground ground;
    output Real i5, i;
  equation
    connect(source.p, r1.p);
    connect(source.p, r2.p);
    connect(r1.n, r3.p);
    connect(r2.n, r4.p);
    connect(r1.n, r5.p);
    connect(r2.n, r5.n);
    connect(r3.n, source.n);
    connect(r4.n, source.n);
    connect(source.n, ground.p);
    i5 = r5.i;
    i = -source.i;
  end Bridge;

  model DiodeClipper "Resistor and exponential diode: a nonlinear loop"
    SineVoltage source(V = 2, f = 1);
    Resistor r(R = 1000);
    Diode d;
    Ground ground;
    output Real vd, id;
  equation
    connect(source.p, r.p);
    connect(r.n, d.p);
    connect(d.n, source.n);
    connect(source.n, ground.p);
    vd = d.v;
    id = d.i;
  end DiodeClipper;

  model Rectifier "Half-wave rectifier with smoothing"
    SineVoltage source(V = 10, f = 50);
    Resistor r(R = 10), load(R = 1000);
    Diode d;
    Capacitor c(C = 1e-4, v(start = 0, fixed = true));
    Ground ground;
    output Real vc;
  equation
    connect(source.p, r.p);
    connect(r.n, d.p);
    connect(d.n, c.p);
    connect(c.p, load.p);
    connect(c.n, source.n);
    connect(load.n, source.n);
    connect(source.n, ground.p);
    vc = c.v;
  end Rectifier;

  model Chua "Chaotic circuit"
    Inductor L(L = 18, i(start = 0, fixed = true));
    Resistor Ro(R = 12.5e-3);
    Resistor G(R = 1/0.565);
    Capacitor C1(C = 10, v(start = 4, fixed = true));
    Capacitor C2(C = 100, v(start = 0, fixed = true));
    NonlinearResistor Nr;
    Ground Gnd;
    output Real v1, v2, iL;
  equation
    connect(L.n, Ro.p);
    connect(C2.p, G.p);
    connect(L.p, G.p);
    connect(G.n, Nr.p);
    connect(C1.p, G.n);
    connect(Ro.n, Gnd.p);
    connect(C1.n, Gnd.p);
    connect(C2.n, Gnd.p);
    connect(Nr.n, Gnd.p);
    v1 = C1.v;
    v2 = C2.v;
    iL = L.i;
  end Chua;

  model Ladder "Chain of RC sections in an array of components"
    parameter Integer n = 5;
    StepVoltage source(V = 1);
    Resistor r[n](each R = 1);
    Capacitor c[n](each C = 0.1);
    Ground ground;
    output Real v_last;
  equation
    connect(source.p, r[1].p);
    for k in 1:n loop
      connect(r[k].n, c[k].p);
      connect(c[k].n, ground.p);
    end for;
    for k in 1:n - 1 loop
      connect(r[k].n, r[k + 1].p);
    end for;
    connect(source.n, ground.p);
    v_last = c[n].v;
  end Ladder;

  model ParallelCapacitors "Higher index: two capacitors side by side"
    StepVoltage source(V = 1);
    Resistor r(R = 1);
    Capacitor c1(C = 1), c2(C = 2);
    Ground ground;
    output Real v;
  equation
    connect(source.p, r.p);
    connect(r.n, c1.p);
    connect(r.n, c2.p);
    connect(c1.n, ground.p);
    connect(c2.n, ground.p);
    connect(source.n, ground.p);
    v = c1.v;
  end ParallelCapacitors;
end Circuits;
