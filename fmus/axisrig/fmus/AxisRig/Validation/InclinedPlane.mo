within AxisRig.Validation;
model InclinedPlane "Height and slopes along a straight path"
  extends Icons.Experiment;
  Workpieces.InclinedPlane surface(azimuth = 0.4, angle = -0.5, origin = 3e-3)
    "Surface that is looked at"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position height "Height on the path";
  output Units.Slope slope_x "Derivative of it by x";
  output Units.Slope slope_y "Derivative of it by y";
  output Units.Slope steepest "Bound of the slope";
equation
  surface.x[1] = -0.05 + 0.1*time;
  surface.y[1] = 0.02 - 0.03*time;
  height = surface.height[1];
  slope_x = surface.slope_x[1];
  slope_y = surface.slope_y[1];
  steepest = surface.steepest;
  annotation(
    experiment(StopTime=1, Interval=1e-2),
    Documentation(info="<html>
<p>A plane that falls. Compared: height and both slopes, and the bound of the slope.</p>
</html>"));
end InclinedPlane;
