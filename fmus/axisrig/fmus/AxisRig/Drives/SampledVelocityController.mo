within AxisRig.Drives;
block SampledVelocityController "PI velocity loop as a digital drive computes it"
  parameter Units.Time period(min = 1e-6) = 62.5e-6 "Cycle of the velocity loop"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Damping gain = 1e4 "Force per velocity error"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time integral_time(min = 1e-5) = 8e-3 "Integral time"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time anti_windup_time(min = 1e-5) = 8e-3 "How fast the integral part is led back"
    annotation(Dialog(group = "Velocity loop"));
  Interfaces.VelocityInput velocity_reference "Demand"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.VelocityInput velocity "Velocity of the motor encoder"
    annotation(Placement(transformation(extent = {{-120, 50}, {-100, 70}})));
  Interfaces.ForceInput limit_positive "Largest force in positive direction"
    annotation(Placement(transformation(extent = {{-120, 20}, {-100, 40}})));
  Interfaces.ForceInput limit_negative "Largest force in negative direction, as an amount"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.BooleanInput enabled "False: no force and an empty integral part"
    annotation(Placement(transformation(extent = {{-120, -40}, {-100, -20}})));
  Interfaces.BooleanInput force_control "The demand is a force: the loop is open"
    annotation(Placement(transformation(extent = {{-120, -70}, {-100, -50}})));
  Interfaces.ForceInput force_demand "Demand then"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.ForceOutput force_reference(start = 0, fixed = true)
    "Demand for the current loop, held"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
  discrete Units.Force integral(start = 0, fixed = true) "Integral part";
protected
  discrete Units.Force proportional(start = 0, fixed = true) "Proportional part";
  discrete Units.Force unlimited(start = 0, fixed = true) "Force that the controller asks for";
  discrete Units.Force limited(start = 0, fixed = true) "Force within the limit";
equation
  when sample(0, period) then
    proportional = gain*(velocity_reference - velocity);
    unlimited = if force_control then force_demand else proportional + pre(integral);
    limited = if unlimited > limit_positive then limit_positive
      elseif unlimited < -limit_negative then -limit_negative else unlimited;
    integral = if not enabled then 0
      elseif force_control then limited
      else pre(integral) + period*(proportional/integral_time
        + (limited - unlimited)/anti_windup_time);
    force_reference = if enabled then limited else 0;
  end when;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-80, 0}, {80, 60}}, textString = "PI"),
      Line(points = {{-80, -60}, {-40, -60}, {-40, -30}, {0, -30}, {0, -10}, {40, -10}, {40, -40},
          {80, -40}}, color = {0, 0, 127}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation, at t = k T: u = K e + I(k), F(k) = sat(u),
I(k+1) = I(k) + T (K e/T_n + (F(k) - u)/T_a); F rests until the next instant.
While a force is demanded it passes within the limits and I takes its value.</p>
<p>Assumption: computing takes no time. Limit: reference and velocity are taken at the instant, not
as means over a cycle. Source: K. J. Astrom, B. Wittenmark, Computer-Controlled Systems, section
8.5.</p>
</html>"));
end SampledVelocityController;
