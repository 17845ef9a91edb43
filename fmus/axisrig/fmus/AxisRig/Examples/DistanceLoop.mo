within AxisRig.Examples;
model DistanceLoop "A distance sensor keeps an axis above a sheet that rises"
  extends Icons.Experiment;
  parameter Units.Rate gain = 20 "Velocity per deviation of the distance"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position set_distance = 2e-3 "Distance to keep"
    annotation(Dialog(group = "Parameters"));
  Machines.DistanceSensorOnAxis machine(
    position_start = 0.012,
    coulomb_friction = 0,
    breakaway_friction = 0,
    sensor(
      order = 1,
      bandwidth = 100,
      lift = 2e-3,
      lift_begin = 0.1,
      lift_end = 0.5,
      workpiece(plane(level = 0.01))))
    "Axis with a sensor, 2 mm above the sheet"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  Units.Position position "Axis";
  Units.Position distance "What the sensor gives";
  Units.Position distance_true "Distance";
equation
  machine.reference_position = 0;
  machine.reference_velocity = gain*(set_distance - machine.distance);
  machine.reference_time = 0;
  machine.reference_end = 1e3;
  machine.enabled = true;
  machine.force_limit = 1e9;
  machine.force_limit_positive = 1e9;
  machine.force_limit_negative = 1e9;
  machine.control = 1;
  machine.reference_acceleration = 0;
  machine.reference_force = 0;
  machine.sensor_x = 0;
  machine.sensor_y = 0;
  position = machine.position;
  distance = machine.distance;
  distance_true = machine.distance_true;
  annotation(
    experiment(StopTime = 1, Interval = 4e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>The sheet rises by 2 mm with 5 mm/s from 0.1 to 0.5 s. A proportional loop follows with the steady deviation
v/K = 0.25 mm, and with none once the sheet rests. Reference:
<code>Resources/ReferenceResults/DistanceLoop.csv</code>, integrated from the equations.</p>
</html>"));
end DistanceLoop;
