within AxisRig.Sensors;
block SensorFilter "Bandwidth of a sensor: none, first or second order, at rest at the start"
  parameter Integer number(min = 0, max = 2) = 1 "0: no filter, 1 or 2"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Frequency corner(min = 1) = 1000 "Corner or natural frequency"
    annotation(Dialog(group = "Parameters"));
  parameter Units.DampingRatio damping_ratio = 0.7 "Of the second order"
    annotation(Dialog(group = "Parameters"));
  Interfaces.PositionInput u "Input"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.PositionOutput y "Output"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
protected
  final parameter Real omega(unit = "rad/s") = 2*Constants.pi*corner
    "Corner or natural angular frequency";
  Units.Position at_start(start = 0, fixed = true) "Input at the start";
  Units.Position first(start = 0, fixed = true) "Output of the first order since the start";
  Units.Position second(start = 0, fixed = true) "Output of the second order since the start";
  Units.Velocity second_rate(start = 0, fixed = true) "Rate of it";
  Units.Position driven "Input since the start; 0 without a filter: its states then rest";
equation
  when initial() then
    at_start = u;
  end when;
  // Without a filter u need not be known within a step. Compilers fix parameters that alone decide
  // an if: a state is beside it here, and below are weights that are 1 for one number, 0 for others.
  driven = noEvent(if number*(1 + first^2) > 0 then u - at_start else 0);
  der(first) = omega*(driven - first);
  der(second) = second_rate;
  der(second_rate) = omega^2*(driven - second) - 2*damping_ratio*omega*second_rate;
  y = at_start + 0.5*(1 - number)*(2 - number)*(u - at_start) + number*(2 - number)*first
    + 0.5*number*(number - 1)*second;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, 40}, {0, 40}, {30, 30}, {80, -60}}, color = {0, 0, 127}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: y = u, dy/dt = w (u - y), or d2y/dt2 = w^2 (u - y) - 2 D w dy/dt, with w = 2 pi f. In steady
motion with the rate v the output lags by v/w or 2 D v/w. The amplitude falls to 1/sqrt(2) at f for
the first order, and for the second one with D = 1/sqrt(2).</p>
<p>Assumption: linear electronics. Limit: none of the sampling inside the sensor. Source: transfer
functions 1/(1 + s/w) and 1/(1 + 2 D s/w + s^2/w^2).</p>
</html>"));
end SensorFilter;
