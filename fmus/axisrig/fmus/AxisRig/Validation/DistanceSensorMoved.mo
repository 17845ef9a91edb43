within AxisRig.Validation;
model DistanceSensorMoved "A nozzle at rest above a sheet that moves; the signal is lost"
  extends Icons.Experiment;
  Sensors.DistanceSensor sensor(
    range = 8e-3,
    order = 0,
    lift = 1.1e-3,
    lift_begin = 0.0503,
    lift_end = 0.1207,
    lift_2 = 2.6e-3,
    lift_2_begin = 0.1011,
    lift_2_end = 0.2203,
    sway = 0.9e-3,
    sway_frequency = 7,
    sway_begin = 0.2503,
    lost_begin = 0.3301,
    lost_end = 0.3609,
    workpiece(plane(level = 0.4e-3)))
    "Sensor under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position distance "What the sensor reports";
  output Units.Position distance_true "Straight down";
  output Boolean valid "There is a signal";
  output Boolean touching "The sheet is on the nozzle";
equation
  sensor.step_time = 0;
  sensor.step_size = 0.5;
  sensor.x_start = 0;
  sensor.x_rate_start = 0;
  sensor.x_end = 0;
  sensor.x_rate_end = 0;
  sensor.y_start = 0;
  sensor.y_rate_start = 0;
  sensor.y_end = 0;
  sensor.y_rate_end = 0;
  sensor.z_start = 4.7e-3;
  sensor.z_rate_start = 0;
  sensor.z_end = 4.7e-3;
  sensor.z_rate_end = 0;
  distance = sensor.distance;
  distance_true = sensor.distance_true;
  valid = sensor.valid;
  touching = sensor.touching;
  annotation(
    experiment(StopTime=0.5, Interval=1.0037e-3),
    Documentation(info="<html>
<p>The sheet rises by two ramps, sways, and touches the nozzle with each wave; one touch falls into the time
without signal. Compared: what a sensor without filter reports; the true distance; loss; touch.</p>
</html>"));
end DistanceSensorMoved;
