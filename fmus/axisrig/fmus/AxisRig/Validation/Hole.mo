within AxisRig.Validation;
model Hole "Distance from the material along a straight path"
  extends Icons.Experiment;
  Workpieces.Hole border(center_x = 4e-3, center_y = 2e-3, radius = 0.0203) "Straight edge"
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
<p>A round hole, crossed. Compared: distance from the material and its derivatives.</p>
</html>"));
end Hole;
