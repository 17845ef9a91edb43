within AxisRig.Validation;
model RobotDistanceSensor "A robot carries a sensor over a wavy sheet that rises to the tool"
  extends Icons.Experiment;
  Sensors.RobotDistanceSensor sensor(
    tool_length = 82e-3,
    quantity = 1,
    range = 0.4,
    workpiece_tilt_x = 0.05,
    workpiece_tilt_y = 0.07,
    workpiece_z = 0.71,
    lift = 60e-3,
    lift_begin = 0.0503,
    lift_end = 0.2207,
    workpiece(sine(amplitude = 0.9e-3, wavelength = 0.08, phase = 0.4, azimuth = 0.3)),
    robot(reach = 11e-3, hd1 = 50e-3, hd2 = 4e-3, hd3 = -5e-3, hd4 = 0.03, hd5 = -0.02, hd6 = 0.3, hd7 = 0.45,
      hd8 = 0.6, hd9 = 0.64, hd10 = 0.1, hd11 = 0.15, hd12 = 0.1, hd14 = 0.02, hd15 = -0.03))
    "Sensor under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position distance "What the sensor reports";
  output Units.Position distance_true "Orthogonal distance";
  output Units.Position distance_along "Distance along the tool";
  output Units.Position clamping_x "Clamping point: x";
  output Units.Position clamping_y "Clamping point: y";
  output Units.Position clamping_z "Clamping point: z";
  output Units.Position tcp_x "Tool centre point: x";
  output Units.Position tcp_y "Tool centre point: y";
  output Units.Position tcp_z "Tool centre point: z";
  output Units.Angle tilt "Inclination of the tool";
  output Boolean valid "There is a reading";
  output Boolean touching "The surface is at the clamping point";
  output Units.Time touch_time "Last touch";
equation
  sensor.step_time = 0;
  sensor.step_size = 0.3;
  sensor.j1_start = 0;
  sensor.j1_rate_start = 1;
  sensor.j1_end = 0.3;
  sensor.j1_rate_end = 1.2;
  sensor.j2_start = 0;
  sensor.j2_rate_start = 0.3;
  sensor.j2_end = 0.05;
  sensor.j2_rate_end = 0.1;
  sensor.j3_start = 0;
  sensor.j3_rate_start = -0.2;
  sensor.j3_end = -0.05;
  sensor.j3_rate_end = 0.1;
  sensor.j4_start = 0.02;
  sensor.j4_rate_start = 1;
  sensor.j4_end = 0.2;
  sensor.j4_rate_end = 0.8;
  sensor.j5_start = 1.4;
  sensor.j5_rate_start = 0.5;
  sensor.j5_end = 1.5;
  sensor.j5_rate_end = 0.4;
  sensor.j6_start = 0;
  sensor.j6_rate_start = 1;
  sensor.j6_end = 0.4;
  sensor.j6_rate_end = 1.1;
  distance = sensor.distance;
  distance_true = sensor.distance_true;
  distance_along = sensor.distance_along;
  clamping_x = sensor.clamping_x;
  clamping_y = sensor.clamping_y;
  clamping_z = sensor.clamping_z;
  tcp_x = sensor.tcp_x;
  tcp_y = sensor.tcp_y;
  tcp_z = sensor.tcp_z;
  tilt = sensor.tilt;
  valid = sensor.valid;
  touching = sensor.touching;
  touch_time = sensor.touch_time;
  annotation(
    experiment(StopTime=0.3, Interval=1.5037e-3),
    Documentation(info="<html>
<p>All six joints move. Compared: the place of the tool, the distance along it and to the nearest point of a wave, touch.</p>
</html>"));
end RobotDistanceSensor;
