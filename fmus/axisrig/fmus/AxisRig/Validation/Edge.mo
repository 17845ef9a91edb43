within AxisRig.Validation;
model Edge "Distance from the material along a straight path"
  extends Icons.Experiment;
  Workpieces.Edge border(position = 0.0111, azimuth = 0.6) "Straight edge"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position beyond "Distance from the material";
  output Units.Slope beyond_x "Derivative of it by x";
  output Units.Slope beyond_y "Derivative of it by y";
equation
  border.x = -0.05 + 0.1*time;
  border.y = 0.02 - 0.03*time;
  beyond = border.beyond;
  beyond_x = border.beyond_x;
  beyond_y = border.beyond_y;
  annotation(
    experiment(StopTime=1, Interval=1e-2),
    Documentation(info="<html>
<p>A straight edge, crossed. Compared: distance from the material and its derivatives.</p>
</html>"));
end Edge;
