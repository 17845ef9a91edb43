within AxisRig.Validation;
model DistanceSensor "A nozzle over a ramp, a hole and an edge, and down on the sheet"
  extends Icons.Experiment;
  Sensors.DistanceSensor sensor(
    range = 8e-3,
    electrode_radius = 2e-3,
    tilt_factor = 5,
    residual = 0.01,
    order = 2,
    bandwidth = 300,
    damping = 0.7,
    noise = 3e-6,
    noise_distance = 1.1e-3,
    noise_period = 130e-6,
    seed = 99,
    workpiece(
      plane(level = 0.4e-3),
      ramp(azimuth = 0.2, rise = 1.5e-3, start = 5e-3, length = 20e-3),
      border(position = 70e-3, azimuth = 0.1),
      hole(center_x = 50e-3, center_y = 0.5e-3, radius = 3e-3)))
    "Sensor under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position distance "What the sensor reports";
  output Units.Position distance_true "Straight down";
  output Boolean valid "Within the range";
  output Boolean touching "On the sheet";
  output Units.Time touch_time "Last touch";
  output Units.Length clearance "Lower bound of the way to a touch";
equation
  sensor.step_time = 0;
  sensor.step_size = 0.5;
  sensor.x_start = 0;
  sensor.x_rate_start = 0.16;
  sensor.x_end = 80e-3;
  sensor.x_rate_end = 0.16;
  sensor.y_start = 0;
  sensor.y_rate_start = 0;
  sensor.y_end = 0;
  sensor.y_rate_end = 0;
  sensor.z_start = 4.2e-3;
  sensor.z_rate_start = -2e-3;
  sensor.z_end = 1.2e-3;
  sensor.z_rate_end = -3e-3;
  distance = sensor.distance;
  distance_true = sensor.distance_true;
  valid = sensor.valid;
  touching = sensor.touching;
  touch_time = sensor.touch_time;
  clearance = sensor.clearance;
  annotation(
    experiment(StopTime=0.5, Interval=1.0037e-3),
    Documentation(info="<html>
<p>Compared: what the sensor reports with tilt, nonlinearity, filter and noise; the true distance; loss
over hole and edge; touch.</p>
</html>"));
end DistanceSensor;
