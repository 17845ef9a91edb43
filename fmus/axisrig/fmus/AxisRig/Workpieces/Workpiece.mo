within AxisRig.Workpieces;
block Workpiece "Sum of all surfaces, with edge and hole; by default a plane at height 0"
  extends Surface;
  Plane plane(points = points, slopes = slopes);
  ThicknessOffset thickness(points = points, slopes = slopes, deviation = 0);
  InclinedPlane inclined(points = points, slopes = slopes, angle = 0);
  Ramp ramp(points = points, slopes = slopes, rise = 0);
  Step step(points = points, slopes = slopes, rise = 0);
  Sine sine(points = points, slopes = slopes, amplitude = 0);
  Waviness waviness(points = points, slopes = slopes, amplitude = {0, 0, 0, 0});
  Cylinder cylinder(points = points, slopes = slopes);
  Edge edge;
  Hole hole;
  output Units.Position beyond "From point 1 to the material in the plane x, y; negative: inside it";
  output Units.Slope beyond_x "Derivative of it by x";
  output Units.Slope beyond_y "Derivative of it by y";
  output Boolean present "There is material at point 1";
equation
  plane.x = x;
  plane.y = y;
  thickness.x = x;
  thickness.y = y;
  inclined.x = x;
  inclined.y = y;
  ramp.x = x;
  ramp.y = y;
  step.x = x;
  step.y = y;
  sine.x = x;
  sine.y = y;
  waviness.x = x;
  waviness.y = y;
  cylinder.x = x;
  cylinder.y = y;
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
  edge.x = x[1];
  edge.y = y[1];
  hole.x = x[1];
  hole.y = y[1];
  beyond = max(edge.beyond, max(hole.beyond, cylinder.beyond));
  beyond_x = noEvent(if edge.beyond >= max(hole.beyond, cylinder.beyond) then edge.beyond_x
    elseif hole.beyond >= cylinder.beyond then hole.beyond_x else cylinder.beyond_x);
  beyond_y = noEvent(if edge.beyond >= max(hole.beyond, cylinder.beyond) then edge.beyond_y
    elseif hole.beyond >= cylinder.beyond then hole.beyond_y else cylinder.beyond_y);
  present = beyond <= 0;
  annotation(
    Documentation(info="<html>
<p>Equations: h = sum of the heights, slopes likewise; the bound of the slope is the sum of the
bounds. The distance from the material is the largest of the distances from edge, hole and side of
the cylinder. So one FMU shows any of the surfaces, and mixtures, by its start values.</p>
<p>Assumption: the surfaces do not disturb each other. Limit: where two borders meet, the distance is
a lower bound. Source: superposition.</p>
</html>"));
end Workpiece;
