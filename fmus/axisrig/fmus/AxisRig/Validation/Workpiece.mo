within AxisRig.Validation;
model Workpiece "All surfaces and borders at once along a straight path"
  extends Icons.Experiment;
  Workpieces.Workpiece workpiece(
    plane(level = 0.0123),
    thickness(deviation = 0.26e-3),
    inclined(azimuth = 0.4, angle = 0.1, origin = 3e-3),
    ramp(azimuth = -0.3, rise = 2e-3, start = -0.0201, length = 0.0305),
    step(azimuth = 0.3, rise = -2.8e-3, start = -0.0201, flank = 6.03e-3, width = 0.0307),
    sine(azimuth = 0.7, amplitude = 0.2e-3, wavelength = 0.03, phase = 0.5),
    waviness(azimuth = -0.5, amplitude = {0.1e-3, 0.3e-3, 0.5e-3, 0.8e-3},
      wavelength = {0.017, 0.031, 0.053, 0.11}, phase = {0.3, 1, 2, 3}),
    cylinder(azimuth = 0.2, radius = 0.0302, axis = 4e-3, round = 0.9),
    border(position = 0.0251, azimuth = 0.6),
    hole(center_x = 4e-3, center_y = 2e-3, radius = 6.3e-3))
    "What lies below"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position height "Height on the path";
  output Units.Slope slope_x "Derivative of it by x";
  output Units.Slope slope_y "Derivative of it by y";
  output Units.Slope steepest "Bound of the slope";
  output Units.Position beyond "Distance from the material";
  output Units.Slope beyond_x "Derivative of it by x";
  output Units.Slope beyond_y "Derivative of it by y";
  output Boolean present "There is material";
equation
  workpiece.x[1] = -0.05 + 0.1*time;
  workpiece.y[1] = 0.02 - 0.03*time;
  height = workpiece.height[1];
  slope_x = workpiece.slope_x[1];
  slope_y = workpiece.slope_y[1];
  steepest = workpiece.steepest;
  beyond = workpiece.beyond;
  beyond_x = workpiece.beyond_x;
  beyond_y = workpiece.beyond_y;
  present = workpiece.present;
  annotation(
    experiment(StopTime=1, Interval=1e-2),
    Documentation(info="<html>
<p>Over a ramp, an obstacle, a sine, waves and a bar, across a hole, and off an edge. Compared:
height, slopes, distance from the material, its derivatives and presence.</p>
</html>"));
end Workpiece;
