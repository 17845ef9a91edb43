within AxisRig.Workpieces;
block Workpiece "Sum of all surfaces, with edge and hole; by default a plane at height 0"
  extends Surface;
  Plane plane(points = points, slopes = slopes) "Level plane"
    annotation(Placement(transformation(extent = {{-74, 39}, {-46, 67}})));
  ThicknessOffset thickness(points = points, slopes = slopes, deviation = 0)
    "Deviation of the thickness"
    annotation(Placement(transformation(extent = {{-34, 39}, {-6, 67}})));
  InclinedPlane inclined(points = points, slopes = slopes, angle = 0) "Inclined plane"
    annotation(Placement(transformation(extent = {{6, 39}, {34, 67}})));
  Ramp ramp(points = points, slopes = slopes, rise = 0) "Ramp"
    annotation(Placement(transformation(extent = {{46, 39}, {74, 67}})));
  Step step(points = points, slopes = slopes, rise = 0) "Obstacle"
    annotation(Placement(transformation(extent = {{-74, -14}, {-46, 14}})));
  Sine sine(points = points, slopes = slopes, amplitude = 0) "Sine"
    annotation(Placement(transformation(extent = {{-34, -14}, {-6, 14}})));
  Waviness waviness(points = points, slopes = slopes, amplitude = {0, 0, 0, 0}) "Sum of sines"
    annotation(Placement(transformation(extent = {{6, -14}, {34, 14}})));
  Cylinder cylinder(points = points, slopes = slopes) "Round bar"
    annotation(Placement(transformation(extent = {{46, -14}, {74, 14}})));
  Edge border "Straight edge"
    annotation(Placement(transformation(extent = {{-74, -67}, {-46, -39}})));
  Hole hole "Hole"
    annotation(Placement(transformation(extent = {{-34, -67}, {-6, -39}})));
  Interfaces.PositionOutput beyond
    "From point 1 to the material in the plane x, y; negative: inside it"
    annotation(Placement(transformation(origin = {-72, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.SlopeOutput beyond_x "Derivative of it by x"
    annotation(Placement(transformation(origin = {-24, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.SlopeOutput beyond_y "Derivative of it by y"
    annotation(Placement(transformation(origin = {24, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.BooleanOutput present "There is material at point 1"
    annotation(Placement(transformation(origin = {72, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
equation
  connect(x, plane.x)
    annotation(Line(points = {{-100, 90}, {-88, 90}, {-88, 66}, {-75, 66}}, color = {0, 0, 127}));
  connect(y, plane.y)
    annotation(Line(points = {{-100, -90}, {-88, -90}, {-88, 40}, {-75, 40}}, color = {0, 0, 127}));
  connect(x, thickness.x)
    annotation(Line(points = {{-100, 90}, {-68, 90}, {-68, 66}, {-35, 66}}, color = {0, 0, 127}));
  connect(y, thickness.y)
    annotation(Line(points = {{-100, -90}, {-68, -90}, {-68, 40}, {-35, 40}}, color = {0, 0, 127}));
  connect(x, inclined.x)
    annotation(Line(points = {{-100, 90}, {-48, 90}, {-48, 66}, {5, 66}}, color = {0, 0, 127}));
  connect(y, inclined.y)
    annotation(Line(points = {{-100, -90}, {-48, -90}, {-48, 40}, {5, 40}}, color = {0, 0, 127}));
  connect(x, ramp.x)
    annotation(Line(points = {{-100, 90}, {-28, 90}, {-28, 66}, {45, 66}}, color = {0, 0, 127}));
  connect(y, ramp.y)
    annotation(Line(points = {{-100, -90}, {-28, -90}, {-28, 40}, {45, 40}}, color = {0, 0, 127}));
  connect(x, step.x)
    annotation(Line(points = {{-100, 90}, {-88, 90}, {-88, 13}, {-75, 13}}, color = {0, 0, 127}));
  connect(y, step.y)
    annotation(Line(points = {{-100, -90}, {-88, -90}, {-88, -13}, {-75, -13}}, color = {0, 0, 127}));
  connect(x, sine.x)
    annotation(Line(points = {{-100, 90}, {-68, 90}, {-68, 13}, {-35, 13}}, color = {0, 0, 127}));
  connect(y, sine.y)
    annotation(Line(points = {{-100, -90}, {-68, -90}, {-68, -13}, {-35, -13}}, color = {0, 0, 127}));
  connect(x, waviness.x)
    annotation(Line(points = {{-100, 90}, {-48, 90}, {-48, 13}, {5, 13}}, color = {0, 0, 127}));
  connect(y, waviness.y)
    annotation(Line(points = {{-100, -90}, {-48, -90}, {-48, -13}, {5, -13}}, color = {0, 0, 127}));
  connect(x, cylinder.x)
    annotation(Line(points = {{-100, 90}, {-28, 90}, {-28, 13}, {45, 13}}, color = {0, 0, 127}));
  connect(y, cylinder.y)
    annotation(Line(points = {{-100, -90}, {-28, -90}, {-28, -13}, {45, -13}}, color = {0, 0, 127}));
  for i in 1:points loop
    height[i] = plane.height[i] + thickness.height[i] + inclined.height[i] + ramp.height[i]
      + step.height[i] + sine.height[i] + waviness.height[i] + cylinder.height[i];
  end for;
  for i in 1:slopes loop
    slope_x[i] = inclined.slope_x[i] + ramp.slope_x[i] + step.slope_x[i] + sine.slope_x[i]
      + waviness.slope_x[i] + cylinder.slope_x[i];
    slope_y[i] = inclined.slope_y[i] + ramp.slope_y[i] + step.slope_y[i] + sine.slope_y[i]
      + waviness.slope_y[i] + cylinder.slope_y[i];
  end for;
  steepest = inclined.steepest + ramp.steepest + step.steepest + sine.steepest + waviness.steepest
    + cylinder.steepest;
  connect(x[1], border.x)
    annotation(Line(points = {{-100, 90}, {-88, 90}, {-88, -40}, {-75, -40}}, color = {0, 0, 127}));
  connect(y[1], border.y)
    annotation(Line(points = {{-100, -90}, {-88, -90}, {-88, -66}, {-75, -66}}, color = {0, 0, 127}));
  connect(x[1], hole.x)
    annotation(Line(points = {{-100, 90}, {-68, 90}, {-68, -40}, {-35, -40}}, color = {0, 0, 127}));
  connect(y[1], hole.y)
    annotation(Line(points = {{-100, -90}, {-68, -90}, {-68, -66}, {-35, -66}}, color = {0, 0, 127}));
  beyond = max(border.beyond, max(hole.beyond, cylinder.beyond));
  beyond_x = noEvent(if border.beyond >= max(hole.beyond, cylinder.beyond) then border.beyond_x
    elseif hole.beyond >= cylinder.beyond then hole.beyond_x else cylinder.beyond_x);
  beyond_y = noEvent(if border.beyond >= max(hole.beyond, cylinder.beyond) then border.beyond_y
    elseif hole.beyond >= cylinder.beyond then hole.beyond_y else cylinder.beyond_y);
  present = beyond <= 0;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, 1}, {-70, -7}, {-60, -14}, {-50, -18}, {-40, -20}, {-30,
          -19}, {-20, -14}, {-10, 17}, {0, 25}, {10, 33}, {20, 14}, {30, 19}, {40, 20}, {50, 18},
          {60, 14}, {70, 7}, {80, -1}, {80, -80}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: h = sum of the heights, slopes likewise; the bound of the slope is the sum of the
bounds. The distance from the material is the largest of the distances from edge, hole and side of
the cylinder. So one FMU shows any of the surfaces, and mixtures, by its start values.</p>
<p>Assumption: the surfaces do not disturb each other. Limit: where two borders meet, the distance is
a lower bound. Source: superposition.</p>
</html>"));
end Workpiece;
