within AxisRig.Examples;
model InclinedTool "A head tilts its tool about the tool centre point, with a virtual extension"
  extends Icons.Experiment;
  parameter Units.Angle turn = 0.5 "Where C is"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Angle last_tilt = 1.4 "Where A is in the end"
    annotation(Dialog(group = "Parameters"));
  Sensors.HeadDistanceSensor sensor(
    tool_length = 80e-3,
    head(reach = 100e-3),
    extension(hd2 = 0.8726646259971648, hd3 = 1.2217304763960306))
    "Sensor at the tool, over a level sheet at height 0"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  Kinematics.ToolExtension extension(
    nominal = 80e-3,
    hd2 = 0.8726646259971648,
    hd3 = 1.2217304763960306)
    "What the control does with the length of the tool: 50 and 70 degrees"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  output Units.Position distance "Distance along the tool";
  output Units.Position distance_true "Orthogonal distance";
  output Units.Position tcp_x "Tool centre point: x";
  output Units.Position tcp_z "Tool centre point: z";
  output Units.Position clamping_z "Height of the clamping point";
  output Units.Angle tilt "Inclination";
protected
  Units.Position lever "From the A axis to the tool centre point";
equation
  tilt = last_tilt*time^2*(3 - 2*time);
  extension.tilt = tilt;
  lever = 100e-3 + extension.length;
  sensor.step_time = time;
  sensor.step_size = 1;
  sensor.x_start = lever*sin(turn)*sin(tilt);
  sensor.y_start = -lever*cos(turn)*sin(tilt);
  sensor.z_start = lever*cos(tilt);
  sensor.c_start = turn;
  sensor.a_start = tilt;
  sensor.x_rate_start = 0;
  sensor.y_rate_start = 0;
  sensor.z_rate_start = 0;
  sensor.c_rate_start = 0;
  sensor.a_rate_start = 0;
  sensor.x_end = 0;
  sensor.y_end = 0;
  sensor.z_end = 0;
  sensor.c_end = 0;
  sensor.a_end = 0;
  sensor.x_rate_end = 0;
  sensor.y_rate_end = 0;
  sensor.z_rate_end = 0;
  sensor.c_rate_end = 0;
  sensor.a_rate_end = 0;
  distance = sensor.distance;
  distance_true = sensor.distance_true;
  tcp_x = sensor.tcp_x;
  tcp_z = sensor.tcp_z;
  clamping_z = sensor.clamping_z;
  annotation(
    experiment(StopTime = 1, Interval = 1e-2, Tolerance = 1e-9),
    Documentation(info="<html>
<p>The tool centre point stays on the sheet while A goes from 0 to 80 degrees. Up to 50 degrees the clamping point
comes down with L cos t, from there to 70 degrees it keeps its height since the tool is extended virtually, then it
comes down again with the length frozen. The sensor gives the extended length along the tool.</p>
</html>"));
end InclinedTool;
