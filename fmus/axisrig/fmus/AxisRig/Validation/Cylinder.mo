within AxisRig.Validation;
model Cylinder "Height and slopes along a straight path"
  extends Icons.Experiment;
  Workpieces.Cylinder surface(azimuth = 0.2, radius = 0.0302, axis = 4e-3, round = 0.9)
    "Surface that is looked at"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position height "Height on the path";
  output Units.Slope slope_x "Derivative of it by x";
  output Units.Slope slope_y "Derivative of it by y";
  output Units.Slope steepest "Bound of the slope";
  output Units.Position beyond "Distance from the side";
  output Units.Slope beyond_x "Derivative of it by x";
  output Units.Slope beyond_y "Derivative of it by y";
equation
  surface.x[1] = -0.05 + 0.1*time;
  surface.y[1] = 0.02 - 0.03*time;
  height = surface.height[1];
  slope_x = surface.slope_x[1];
  slope_y = surface.slope_y[1];
  steepest = surface.steepest;
  beyond = surface.beyond;
  beyond_x = surface.beyond_x;
  beyond_y = surface.beyond_y;
  annotation(
    experiment(StopTime=1, Interval=1e-2),
    Documentation(info="<html>
<p>A bar, crossed from side to side and past both. Compared: height and both slopes, distance from the
side with its derivatives, and the bound of the slope.</p>
</html>"));
end Cylinder;
