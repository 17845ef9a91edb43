within AxisRig.Sensors;
model PositionSwitch "Switch that a cam of one axis closes: limit switch, home switch"
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
  parameter Units.Position low = 0 "Lower end of the cam"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position high = 1e3 "Upper end of the cam; the default lies out of reach"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length hysteresis = 20e-6 "The switch opens this far outside the cam"
    annotation(Dialog(group = "Signal"));
  parameter Boolean inverted = false "Signal is true off the cam (normally closed contact)"
    annotation(Dialog(group = "Signal"));
  Interfaces.BooleanOutput signal "Switching output"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.TimeOutput rising_time "Instant of the last rising edge of the signal"
    annotation(Placement(transformation(extent = {{100, 44}, {120, 64}})));
  Interfaces.TimeOutput falling_time "Instant of the last falling edge of the signal"
    annotation(Placement(transformation(extent = {{100, 8}, {120, 28}})));
  Interfaces.IntegerOutput rising_count "Rising edges of the signal since the start"
    annotation(Placement(transformation(extent = {{100, -28}, {120, -8}})));
  Interfaces.IntegerOutput falling_count "Falling edges of the signal since the start"
    annotation(Placement(transformation(extent = {{100, -64}, {120, -44}})));
  Interfaces.LengthOutput clearance "Distance that the axis can move without any edge"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  constant Units.Length rounding = 1e-13 "By how much two steps may disagree where they meet";
  Real passed(unit = "1") "Share of the step that has passed";
  CubicPath x "Position of the axis"
    annotation(Placement(transformation(extent = {{-60, 20}, {-20, 60}})));
  Units.Length outside "How far off the cam it stays closed";
  Boolean closed "On the cam";
  EdgeCounter rising "Counts rising edges"
    annotation(Placement(transformation(extent = {{20, 20}, {60, 60}})));
  EdgeCounter falling "Counts falling edges"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
equation
  passed = (time - step_time)/step_size;
  connect(x_start, x.start)
    annotation(Line(points = {{-100, 18}, {-81, 18}, {-81, 58}, {-62, 58}}, color = {0, 0, 127}));
  connect(x_rate_start, x.start_rate)
    annotation(Line(points = {{-100, -18}, {-81, -18}, {-81, 51}, {-62, 51}}, color = {0, 0, 127}));
  connect(x_end, x.finish)
    annotation(Line(points = {{-100, -54}, {-81, -54}, {-81, 44}, {-62, 44}}, color = {0, 0, 127}));
  connect(x_rate_end, x.finish_rate)
    annotation(Line(points = {{-100, -90}, {-81, -90}, {-81, 36}, {-62, 36}}, color = {0, 0, 127}));
  connect(step_size, x.span)
    annotation(Line(points = {{-100, 54}, {-81, 54}, {-81, 29}, {-62, 29}}, color = {0, 0, 127}));
  x.passed = passed;
  outside = if hysteresis > rounding then hysteresis else rounding;
  closed = x.position >= low - (if pre(closed) then outside else 0)
    and x.position <= high + (if pre(closed) then outside else 0);
  clearance = min(
    min(abs(x.position - low), abs(x.position - low + outside)),
    min(abs(x.position - high), abs(x.position - high - outside)));
  signal = closed <> inverted;
  rising.u = signal;
  falling.u = not signal;
  connect(rising.last, rising_time)
    annotation(Line(points = {{62, 22}, {81, 22}, {81, 54}, {100, 54}}, color = {0, 0, 127}));
  rising_count = rising.count;
  connect(falling.last, falling_time)
    annotation(Line(points = {{-18, -58}, {41, -58}, {41, 18}, {100, 18}}, color = {0, 0, 127}));
  falling_count = falling.count;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, 0}, {-30, 0}}, color = {0, 0, 0}),
      Line(points = {{-30, 0}, {30, 35}}, color = {0, 0, 0}),
      Line(points = {{30, 0}, {80, 0}}, color = {0, 0, 0}),
      Ellipse(extent = {{-36, -6}, {-24, 6}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{24, -6}, {36, 6}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: closes at low &lt;= x &lt;= high, opens below low - h and above high + h. A limit switch of the
positive end has its cam from its place to out of reach; a home switch a short one.</p>
<p>clearance is the way to the nearest of the four places where the level can change.</p>
<p>Assumption: the place of an edge does not depend on speed. Limits: no bounce, no delay (the drive
has an input filter); the level at the start is not an edge; a cam shorter than the way within an
internal step can be missed. Source: definition; hysteresis of inductive switches is up to 15 % of
their range, IEC 60947-5-2.</p>
</html>"));
end PositionSwitch;
