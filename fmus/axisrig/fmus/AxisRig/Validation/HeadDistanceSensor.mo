within AxisRig.Validation;
model HeadDistanceSensor "A head turns and tilts above an inclined sheet that moves"
  extends Icons.Experiment;
  Sensors.HeadDistanceSensor sensor(
    tool_length = 82e-3,
    quantity = 2,
    range = 0.4,
    electrode_radius = 3e-3,
    tilt_factor = 5,
    residual = 0.01,
    order = 2,
    bandwidth = 200,
    damping = 0.6,
    noise = 4e-6,
    noise_distance = 90e-3,
    noise_period = 130e-6,
    seed = 7,
    workpiece_tilt_x = 0.1,
    workpiece_tilt_y = -0.15,
    workpiece_x = 11e-3,
    workpiece_y = -7e-3,
    workpiece_z = 23e-3,
    lift = 4e-3,
    lift_begin = 0.0503,
    lift_end = 0.1207,
    lift_2 = -3e-3,
    lift_2_begin = 0.1011,
    lift_2_end = 0.2203,
    sway = 0.9e-3,
    sway_frequency = 7,
    sway_begin = 0.2503,
    lost_begin = 0.3001,
    lost_end = 0.3209,
    workpiece(plane(level = 1.4e-3), inclined(angle = 0.2, azimuth = 0.4, origin = 5e-3)),
    head(reach = 51e-3, hd1 = 21e-3, hd2 = 17e-3, hd3 = 0.05, hd4 = -0.07, hd5 = 8e-3, hd6 = -6e-3,
      hd7 = 4e-3, hd8 = 3e-3, hd9 = 12e-3),
    extension(hd2 = 0.3, hd3 = 0.6))
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
  output Units.Length virtual_length "Length of the tool with its extension";
  output Boolean valid "There is a reading";
equation
  sensor.step_time = 0;
  sensor.step_size = 0.4;
  sensor.x_start = 0;
  sensor.x_rate_start = 0.1;
  sensor.x_end = 0.05;
  sensor.x_rate_end = 0.15;
  sensor.y_start = 0.01;
  sensor.y_rate_start = -0.05;
  sensor.y_end = -0.02;
  sensor.y_rate_end = -0.1;
  sensor.z_start = 0.3;
  sensor.z_rate_start = -0.1;
  sensor.z_end = 0.27;
  sensor.z_rate_end = 0.1;
  sensor.c_start = 0.2;
  sensor.c_rate_start = 1;
  sensor.c_end = 0.9;
  sensor.c_rate_end = 2;
  sensor.a_start = -0.3;
  sensor.a_rate_start = 2;
  sensor.a_end = 0.8;
  sensor.a_rate_end = 3;
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
  virtual_length = sensor.virtual_length;
  valid = sensor.valid;
  annotation(
    experiment(StopTime=0.4, Interval=1.0037e-3),
    Documentation(info="<html>
<p>All five axes move. Compared: the place of the tool, the distance along it and to the nearest point, what an electrode
gives with tilt, nonlinearity, filter and noise; the extension of the tool; loss.</p>
</html>"));
end HeadDistanceSensor;
