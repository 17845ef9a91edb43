within AxisRig.Validation;
model ProbeAtWalls "A ball beside an edge, around its corner, and in a hole"
  extends Icons.Experiment;
  Sensors.WorkpieceProbe outside(
    ball_radius = 3e-3,
    workpiece(
      plane(level = 4e-3),
      border(position = 11e-3, azimuth = 0.3)))
    "Probe beside the material"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Sensors.WorkpieceProbe inside(
    ball_radius = 3e-3,
    workpiece(
      plane(level = 4e-3),
      hole(center_x = 1e-3, center_y = 2e-3, radius = 8e-3)))
    "Probe in the hole"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Units.Position outside_gap "Distance of the ball at the edge";
  output Units.Length outside_clearance "To the next edge of the signal";
  output Units.Position inside_gap "Distance of the ball in the hole";
  output Integer inside_count "Contacts in the hole";
equation
  outside.switched_on = true;
  outside.step_time = 0;
  outside.step_size = 1;
  outside.x_start = 14.3e-3;
  outside.x_rate_start = 0;
  outside.x_end = 9e-3;
  outside.x_rate_end = -0.02;
  outside.y_start = 0;
  outside.y_rate_start = 0;
  outside.y_end = 0;
  outside.y_rate_end = 0;
  outside.z_start = 0;
  outside.z_rate_start = 0.02;
  outside.z_end = 8e-3;
  outside.z_rate_end = 0;
  inside.switched_on = true;
  inside.step_time = 0;
  inside.step_size = 1;
  inside.x_start = 1e-3;
  inside.x_rate_start = 0;
  inside.x_end = 5e-3;
  inside.x_rate_end = 0;
  inside.y_start = 2e-3;
  inside.y_rate_start = 0;
  inside.y_end = 6e-3;
  inside.y_rate_end = 0;
  inside.z_start = -1e-3;
  inside.z_rate_start = 0;
  inside.z_end = -1e-3;
  inside.z_rate_end = 0;
  outside_gap = outside.gap;
  outside_clearance = outside.clearance;
  inside_gap = inside.gap;
  inside_count = inside.contact_count;
  annotation(
    experiment(StopTime=1, Interval=1e-2),
    Documentation(info="<html>
<p>Compared: distance from wall, corner and top, and from the wall of the hole.</p>
</html>"));
end ProbeAtWalls;
