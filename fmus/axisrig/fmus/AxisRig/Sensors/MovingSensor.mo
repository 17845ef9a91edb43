within AxisRig.Sensors;
partial model MovingSensor "Sensor on three axes that move on a cubic over the communication step"
  Interfaces.TimeInput step_time "Beginning of the communication step"
    annotation(Placement(transformation(extent = {{-112, 84}, {-100, 96}})));
  Interfaces.TimeInput step_size(start = 1e-3, min = 1e-9) "Length of the communication step"
    annotation(Placement(transformation(extent = {{-112, 70}, {-100, 82}})));
  Interfaces.PositionInput x_start "x at the beginning of the step"
    annotation(Placement(transformation(extent = {{-112, 56}, {-100, 68}})));
  Interfaces.VelocityInput x_rate_start "Rate of x at the beginning of the step"
    annotation(Placement(transformation(extent = {{-112, 42}, {-100, 54}})));
  Interfaces.PositionInput x_end "x at the end of the step"
    annotation(Placement(transformation(extent = {{-112, 29}, {-100, 41}})));
  Interfaces.VelocityInput x_rate_end "Rate of x at the end of the step"
    annotation(Placement(transformation(extent = {{-112, 15}, {-100, 27}})));
  Interfaces.PositionInput y_start "y at the beginning of the step"
    annotation(Placement(transformation(extent = {{-112, 1}, {-100, 13}})));
  Interfaces.VelocityInput y_rate_start "Rate of y at the beginning of the step"
    annotation(Placement(transformation(extent = {{-112, -13}, {-100, -1}})));
  Interfaces.PositionInput y_end "y at the end of the step"
    annotation(Placement(transformation(extent = {{-112, -27}, {-100, -15}})));
  Interfaces.VelocityInput y_rate_end "Rate of y at the end of the step"
    annotation(Placement(transformation(extent = {{-112, -41}, {-100, -29}})));
  Interfaces.PositionInput z_start "z at the beginning of the step"
    annotation(Placement(transformation(extent = {{-112, -54}, {-100, -42}})));
  Interfaces.VelocityInput z_rate_start "Rate of z at the beginning of the step"
    annotation(Placement(transformation(extent = {{-112, -68}, {-100, -56}})));
  Interfaces.PositionInput z_end "z at the end of the step"
    annotation(Placement(transformation(extent = {{-112, -82}, {-100, -70}})));
  Interfaces.VelocityInput z_rate_end "Rate of z at the end of the step"
    annotation(Placement(transformation(extent = {{-112, -96}, {-100, -84}})));
protected
  Real passed(unit = "1") "Share of the step that has passed";
  CubicPath x "Reference point of the sensor: x"
    annotation(Placement(transformation(extent = {{-72, 26}, {-34, 64}})));
  CubicPath y "Reference point of the sensor: y"
    annotation(Placement(transformation(extent = {{-19, 26}, {19, 64}})));
  CubicPath z "Reference point of the sensor: z"
    annotation(Placement(transformation(extent = {{34, 26}, {72, 64}})));
equation
  passed = (time - step_time)/step_size;
  connect(x_start, x.start)
    annotation(Line(points = {{-100, 62}, {-74, 62}}, color = {0, 0, 127}));
  connect(x_rate_start, x.start_rate)
    annotation(Line(points = {{-100, 48}, {-87, 48}, {-87, 55}, {-74, 55}}, color = {0, 0, 127}));
  connect(x_end, x.finish)
    annotation(Line(points = {{-100, 35}, {-87, 35}, {-87, 48}, {-74, 48}}, color = {0, 0, 127}));
  connect(x_rate_end, x.finish_rate)
    annotation(Line(points = {{-100, 21}, {-87, 21}, {-87, 42}, {-74, 42}}, color = {0, 0, 127}));
  connect(step_size, x.span)
    annotation(Line(points = {{-100, 76}, {-87, 76}, {-87, 35}, {-74, 35}}, color = {0, 0, 127}));
  x.passed = passed;
  connect(y_start, y.start)
    annotation(Line(points = {{-100, 7}, {-60, 7}, {-60, 62}, {-21, 62}}, color = {0, 0, 127}));
  connect(y_rate_start, y.start_rate)
    annotation(Line(points = {{-100, -7}, {-60, -7}, {-60, 55}, {-21, 55}}, color = {0, 0, 127}));
  connect(y_end, y.finish)
    annotation(Line(points = {{-100, -21}, {-60, -21}, {-60, 48}, {-21, 48}}, color = {0, 0, 127}));
  connect(y_rate_end, y.finish_rate)
    annotation(Line(points = {{-100, -35}, {-60, -35}, {-60, 42}, {-21, 42}}, color = {0, 0, 127}));
  connect(step_size, y.span)
    annotation(Line(points = {{-100, 76}, {-60, 76}, {-60, 35}, {-21, 35}}, color = {0, 0, 127}));
  y.passed = passed;
  connect(z_start, z.start)
    annotation(Line(points = {{-100, -48}, {-34, -48}, {-34, 62}, {32, 62}}, color = {0, 0, 127}));
  connect(z_rate_start, z.start_rate)
    annotation(Line(points = {{-100, -62}, {-34, -62}, {-34, 55}, {32, 55}}, color = {0, 0, 127}));
  connect(z_end, z.finish)
    annotation(Line(points = {{-100, -76}, {-34, -76}, {-34, 48}, {32, 48}}, color = {0, 0, 127}));
  connect(z_rate_end, z.finish_rate)
    annotation(Line(points = {{-100, -90}, {-34, -90}, {-34, 42}, {32, 42}}, color = {0, 0, 127}));
  connect(step_size, z.span)
    annotation(Line(points = {{-100, 76}, {-34, 76}, {-34, 35}, {32, 35}}, color = {0, 0, 127}));
  z.passed = passed;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -50}, {0, 0}, {80, 50}}, color = {0, 0, 127}),
      Ellipse(extent = {{-15, -15}, {15, 15}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>The motion p(t) of the sensor from position and rate at both ends of the communication step
(CubicPath). Every sensor that reads the axes has these inputs.</p>
<p>Assumption: the sensor does not act back on the axes. Limit: between the ends the motion is a
cubic; see CubicPath for what is left across a step of the acceleration.</p>
</html>"));
end MovingSensor;
