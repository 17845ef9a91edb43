package Process "Heat and flow"
  model TwoTanks "Torricelli: outflow by the root of the level"
    parameter Real A1 = 1, A2 = 1, a1 = 0.05, a2 = 0.04, g = 9.81, inflow = 0.1;
    output Real h1(start = 1, fixed = true), h2(start = 0.5, fixed = true);
    Real q12, q2;
  equation
    q12 = a1*sqrt(2*g*h1);
    q2 = a2*sqrt(2*g*h2);
    A1*der(h1) = inflow - q12;
    A2*der(h2) = q12 - q2;
  end TwoTanks;

  model Emptying "A tank that runs empty: the level is a parabola, then rests"
    parameter Real k = 0.2;
    output Real h(start = 1, fixed = true);
    output Boolean empty(start = false, fixed = true);
  equation
    der(h) = if empty then 0 else -k*sqrt(max(h, 0));
    when h < 1e-6 then
      empty = true;
    end when;
  end Emptying;

  model HeatRod "Rod in sections, array and for-equations"
    parameter Integer n = 8;
    parameter Real a = 0.5 "Diffusivity over length squared of a section";
    output Real T[n](each start = 20);
    parameter Real T_left = 100, T_right = 20;
  equation
    der(T[1]) = a*(T_left - 2*T[1] + T[2]);
    for k in 2:n - 1 loop
      der(T[k]) = a*(T[k - 1] - 2*T[k] + T[k + 1]);
    end for;
    der(T[n]) = a*(T[n - 1] - 2*T[n] + T_right);
  end HeatRod;

  model HeatRodScalar "The same rod with a scalar output"
    parameter Integer n = 8;
    parameter Real a = 0.5;
    Real T[n](each start = 20);
    output Real middle, mean;
  equation
    der(T[1]) = a*(100 - 2*T[1] + T[2]);
    for k in 2:n - 1 loop
      der(T[k]) = a*(T[k - 1] - 2*T[k] + T[k + 1]);
    end for;
    der(T[n]) = a*(T[n - 1] - 2*T[n] + 20);
    middle = T[4];
    mean = sum(T)/n;
  end HeatRodScalar;

  model Thermostat "Room with a heater switched by hysteresis"
    parameter Real T_low = 19, T_high = 21, T_out = 5, tau = 100, gain = 0.4;
    output Real T(start = 15, fixed = true);
    output Boolean heat(start = true, fixed = true);
    output Integer switchings(start = 0, fixed = true);
  equation
    der(T) = (T_out - T)/tau + (if heat then gain else 0);
    when T > T_high then
      heat = false;
      switchings = pre(switchings) + 1;
    elsewhen T < T_low then
      heat = true;
      switchings = pre(switchings) + 1;
    end when;
  end Thermostat;

  model Hysteresis "Relay as one Boolean equation"
    output Real x;
    output Boolean y(start = false, fixed = true);
    discrete output Real t_on(start = 0, fixed = true), t_off(start = 0, fixed = true);
  equation
    x = sin(time);
    y = x > 0.5 or pre(y) and x >= -0.5;
    when y then
      t_on = time;
    end when;
    when not y then
      t_off = time;
    end when;
  end Hysteresis;

  model Reactor "Batch: fill, heat, drain as a state machine of Integers"
    output Integer phase(start = 1, fixed = true) "1 fill, 2 heat, 3 drain, 4 done";
    output Real level(start = 0, fixed = true), T(start = 20, fixed = true);
    discrete output Real t_heat(start = 0, fixed = true), t_drain(start = 0, fixed = true), t_done(start = 0, fixed = true);
  equation
    der(level) = if phase == 1 then 0.1 elseif phase == 3 then -0.25 else 0;
    der(T) = if phase == 2 then 10*level else 0;
    when pre(phase) == 1 and level >= 0.8 then
      phase = 2;
    elsewhen pre(phase) == 2 and T >= 60 then
      phase = 3;
    elsewhen pre(phase) == 3 and level <= 0 then
      phase = 4;
    end when;
    when phase == 2 then
      t_heat = time;
    end when;
    when phase == 3 then
      t_drain = time;
    end when;
    when phase == 4 then
      t_done = time;
    end when;
  end Reactor;

  model Gain "Model with one input"
    input Real u;
    parameter Real T = 0.5, k = 2;
    output Real y(start = 0);
  equation
    T*der(y) = k*u - y;
  end Gain;
end Process;
