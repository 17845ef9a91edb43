package Classics "Differential equations of textbooks"
  model Dahlquist "Exponential decay"
    parameter Real k = 1 "Rate";
    output Real x(start = 1, fixed = true);
  equation
    der(x) = -k*x;
  end Dahlquist;

  model VanDerPol "Relaxation oscillator"
    parameter Real mu = 1;
    output Real x(start = 2);
    output Real y(start = 0);
  equation
    der(x) = y;
    der(y) = mu*(1 - x^2)*y - x;
  end VanDerPol;

  model LotkaVolterra "Rabbits and foxes"
    parameter Real alpha = 0.1 "Reproduction of prey";
    parameter Real beta = 0.02 "Mortality of prey per predator";
    parameter Real gamma = 0.4 "Mortality of predator";
    parameter Real delta = 0.02 "Reproduction of predator per prey";
    parameter Real rabbits_start = 10;
    parameter Real foxes_start = 10;
    output Real rabbits(start = rabbits_start, fixed = true);
    output Real foxes(start = foxes_start, fixed = true);
  equation
    der(rabbits) = rabbits*(alpha - beta*foxes);
    der(foxes) = foxes*(delta*rabbits - gamma);
  end LotkaVolterra;

  model Lorenz "Strange attractor"
    parameter Real sigma = 10, rho = 28, beta = 8/3;
    output Real x(start = 1), y(start = 1), z(start = 1);
  equation
    der(x) = sigma*(y - x);
    der(y) = x*(rho - z) - y;
    der(z) = x*y - beta*z;
  end Lorenz;

  model Robertson "Stiff chemical reaction"
    output Real y1(start = 1, fixed = true);
    output Real y2(start = 0, fixed = true);
    output Real y3;
  equation
    der(y1) = -0.04*y1 + 1e4*y2*y3;
    der(y2) = 0.04*y1 - 1e4*y2*y3 - 3e7*y2^2;
    1 = y1 + y2 + y3;
  end Robertson;

  model Duffing "Forced oscillator with cubic spring"
    parameter Real d = 0.3, a = -1, b = 1, f = 0.5, w = 1.2;
    output Real x(start = 1), v(start = 0);
  equation
    v = der(x);
    der(v) + d*v + a*x + b*x^3 = f*cos(w*time);
  end Duffing;

  model Brusselator
    parameter Real A = 1, B = 3;
    output Real X(start = 1.2), Y(start = 3.1);
  equation
    der(X) = A + X^2*Y - B*X - X;
    der(Y) = B*X - X^2*Y;
  end Brusselator;

  model StiffDecay "A fast and a slow mode; the fast one is far beyond the internal step"
    parameter Real fast = 1e6;
    output Real x(start = 1), y(start = 0);
  equation
    der(x) = -fast*(x - cos(time));
    der(y) = x - y;
  end StiffDecay;

  model Resonance "Exact solution t*sin(t)/2"
    output Real x(start = 0), v(start = 0);
  equation
    der(x) = v;
    der(v) = -x + cos(time);
  end Resonance;

  model BlowUp "x' = x^2, singular at t = 1"
    output Real x(start = 1);
  equation
    der(x) = x^2;
  end BlowUp;
end Classics;
