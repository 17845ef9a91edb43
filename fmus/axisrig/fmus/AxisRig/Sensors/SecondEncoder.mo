within AxisRig.Sensors;
model SecondEncoder "Linear encoder at the load of one axis"
  Interfaces.TimeInput step_time "Beginning of the communication step"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.TimeInput step_size(start = 1e-3, min = 1e-9) "Length of the communication step"
    annotation(Placement(transformation(extent = {{-120, 44}, {-100, 64}})));
  Interfaces.PositionInput x_start "Position of the axis at the beginning of the step"
    annotation(Placement(transformation(extent = {{-120, 8}, {-100, 28}})));
  Interfaces.VelocityInput x_rate_start "Rate of it at the beginning of the step"
    annotation(Placement(transformation(extent = {{-120, -28}, {-100, -8}})));
  Interfaces.PositionInput x_end "Position of the axis at the end of the step"
    annotation(Placement(transformation(extent = {{-120, -64}, {-100, -44}})));
  Interfaces.VelocityInput x_rate_end "Rate of it at the end of the step"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  parameter Real scale(unit = "1") = 1 "Measured length over true length"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position offset = 0 "Reading at the axis position 0"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position periodic_error = 0 "Amplitude of the error within a signal period"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length signal_period(min = 1e-9) = 20e-6 "Length of a signal period"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Angle periodic_phase = 0 "Phase of the periodic error at the reading 0"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length resolution(min = 1e-12) = 1e-9 "Length of a count"
    annotation(Dialog(group = "Parameters"));
  Interfaces.PositionOutput position "Reading in whole counts"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.PositionOutput position_true "Position of the axis"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
  Interfaces.VelocityOutput velocity "Rate of the reading, not quantised"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  Real passed(unit = "1") "Share of the step that has passed";
  Units.Position scaled "Reading of an encoder without periodic error";
  Units.Velocity rate "Rate of the axis";
  Real number(unit = "rad/m") "Phase per length";
  Units.Angle counted "Reading as an angle that turns once in a count";
  Units.Position reading "Reading before it is quantised";
  CubicPath x "Position of the axis"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
equation
  number = 2*Constants.pi/signal_period;
  passed = (time - step_time)/step_size;
  connect(x_start, x.start)
    annotation(Line(points = {{-100, 18}, {-22, 18}}, color = {0, 0, 127}));
  connect(x_rate_start, x.start_rate)
    annotation(Line(points = {{-100, -18}, {-61, -18}, {-61, 11}, {-22, 11}}, color = {0, 0, 127}));
  connect(x_end, x.finish)
    annotation(Line(points = {{-100, -54}, {-61, -54}, {-61, 4}, {-22, 4}}, color = {0, 0, 127}));
  connect(x_rate_end, x.finish_rate)
    annotation(Line(points = {{-100, -90}, {-61, -90}, {-61, -4}, {-22, -4}}, color = {0, 0, 127}));
  connect(step_size, x.span)
    annotation(Line(points = {{-100, 54}, {-61, 54}, {-61, -11}, {-22, -11}}, color = {0, 0, 127}));
  x.passed = passed;
  rate = x_rate_start + passed*(2*(3*(x_end - x_start)/step_size - (2*x_rate_start + x_rate_end))
    + passed*3*(2*(x_start - x_end)/step_size + (x_rate_start + x_rate_end)));
  connect(x.position, position_true)
    annotation(Line(points = {{22, 0}, {100, 0}}, color = {0, 0, 127}));
  scaled = offset + scale*x.position;
  reading = scaled + periodic_error*sin(number*scaled + periodic_phase);
  // The nearest whole count without floor(): an event at each count would stop the simulation some
  // hundred thousand times a second.
  counted = 2*Constants.pi*reading/resolution;
  position = reading - resolution/(2*Constants.pi)*atan2(sin(counted), cos(counted));
  velocity = scale*rate*(1 + periodic_error*number*cos(number*scaled + periodic_phase));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-80, -20}, {80, 20}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-72, -20}, {-72, 0}}, color = {0, 0, 0}),
      Line(points = {{-64, -20}, {-64, 0}}, color = {0, 0, 0}),
      Line(points = {{-56, -20}, {-56, 0}}, color = {0, 0, 0}),
      Line(points = {{-48, -20}, {-48, 0}}, color = {0, 0, 0}),
      Line(points = {{-40, -20}, {-40, 0}}, color = {0, 0, 0}),
      Line(points = {{-32, -20}, {-32, 0}}, color = {0, 0, 0}),
      Line(points = {{-24, -20}, {-24, 0}}, color = {0, 0, 0}),
      Line(points = {{-16, -20}, {-16, 0}}, color = {0, 0, 0}),
      Line(points = {{-8, -20}, {-8, 0}}, color = {0, 0, 0}),
      Line(points = {{0, -20}, {0, 0}}, color = {0, 0, 0}),
      Line(points = {{8, -20}, {8, 0}}, color = {0, 0, 0}),
      Line(points = {{16, -20}, {16, 0}}, color = {0, 0, 0}),
      Line(points = {{24, -20}, {24, 0}}, color = {0, 0, 0}),
      Line(points = {{32, -20}, {32, 0}}, color = {0, 0, 0}),
      Line(points = {{40, -20}, {40, 0}}, color = {0, 0, 0}),
      Line(points = {{48, -20}, {48, 0}}, color = {0, 0, 0}),
      Line(points = {{56, -20}, {56, 0}}, color = {0, 0, 0}),
      Line(points = {{64, -20}, {64, 0}}, color = {0, 0, 0}),
      Line(points = {{72, -20}, {72, 0}}, color = {0, 0, 0}),
      Rectangle(extent = {{-20, 20}, {20, 50}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: s = offset + scale x; reading = s + A sin(2 pi s/p + phi); position = q round(reading/q).
The rate is the derivative of the reading. Only the output is quantised: nothing inside depends on
whole counts, and no events come from them. The rounding is done by angles, x - q/(2 pi)
atan2(sin(2 pi x/q), cos(2 pi x/q)), which is exact to 1e-8 of a count.</p>
<p>Assumptions: the scale grows evenly (temperature, inclination); one harmonic of the periodic error.
Limit: no own elasticity between table and scale. Source: the signal of a linear encoder is
interpolated within its period (20 um), unequal amplitudes and phases of its two tracks leave a
periodic error.</p>
</html>"));
end SecondEncoder;
