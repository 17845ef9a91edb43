within AxisRig.Sensors;
block SensorFilter "Bandwidth of a sensor: first or second order, at rest at the start"
  parameter Integer order(min = 1, max = 2) = 1 "1 or 2";
  parameter Units.Frequency bandwidth(min = 1) = 1000 "Corner or natural frequency";
  parameter Units.DampingRatio damping = 0.7 "Of the second order";
  input Units.Position u "Input";
  output Units.Position y "Output";
protected
  constant Real pi = 3.141592653589793;
  final parameter Real omega(unit = "rad/s") = 2*pi*bandwidth;
  Units.Position first "Output of the first order";
  Units.Position second "Output of the second order";
  Units.Velocity second_rate(start = 0, fixed = true) "Rate of it";
initial equation
  first = u;
  second = u;
equation
  der(first) = omega*(u - first);
  der(second) = second_rate;
  der(second_rate) = omega^2*(u - second) - 2*damping*omega*second_rate;
  y = if order == 1 then first else second;
  annotation(
    Documentation(info="<html>
<p>Equations: dy/dt = w (u - y), or d2y/dt2 = w^2 (u - y) - 2 D w dy/dt, with w = 2 pi f. In steady
motion with the rate v the output lags by v/w or 2 D v/w. The amplitude falls to 1/sqrt(2) at f for
the first order, and for the second one with D = 1/sqrt(2).</p>
<p>Assumption: linear electronics. Limit: none of the sampling inside the sensor. Source: transfer
functions 1/(1 + s/w) and 1/(1 + 2 D s/w + s^2/w^2).</p>
</html>"));
end SensorFilter;
