within AxisRig.Machines;
model DistanceSensorOnAxis "Servo axis with a distance sensor that moves with it along z"
  extends Drives.ServoAxis;
  Interfaces.PositionInput sensor_x "Where the sensor is: x"
    annotation(Placement(transformation(origin = {-40, 110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.PositionInput sensor_y "Where the sensor is: y"
    annotation(Placement(transformation(origin = {40, 110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.PositionOutput distance "What the sensor gives"
    annotation(Placement(transformation(origin = {-75, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.PositionOutput distance_true "From the nozzle straight down to the surface (truth)"
    annotation(Placement(transformation(origin = {-45, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.BooleanOutput valid "Within the range, not over an edge, and not lost"
    annotation(Placement(transformation(origin = {-15, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.BooleanOutput touching "The nozzle touches the workpiece"
    annotation(Placement(transformation(origin = {15, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.TimeOutput touch_time "Last instant at which it began to"
    annotation(Placement(transformation(origin = {45, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.IntegerOutput touch_count "How often it has touched"
    annotation(Placement(transformation(origin = {75, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Sensors.DistanceSensor sensor "Sensor on the slide"
    annotation(Placement(transformation(extent = {{-20, -80}, {20, -40}})));
equation
  // A step that begins now: its first position and rate are those of the axis.
  sensor.step_time = time;
  sensor.step_size = 1;
  connect(sensor_x, sensor.x_start)
    annotation(Line(points = {{-40, 100}, {-40, -50}, {-20, -50}}, color = {0, 0, 127}));
  sensor.x_rate_start = 0;
  connect(sensor_x, sensor.x_end)
    annotation(Line(points = {{-40, 100}, {-40, -50}, {-20, -50}}, color = {0, 0, 127}));
  sensor.x_rate_end = 0;
  connect(sensor_y, sensor.y_start)
    annotation(Line(points = {{40, 100}, {40, -60}, {20, -60}}, color = {0, 0, 127}));
  sensor.y_rate_start = 0;
  connect(sensor_y, sensor.y_end)
    annotation(Line(points = {{40, 100}, {40, -60}, {20, -60}}, color = {0, 0, 127}));
  sensor.y_rate_end = 0;
  sensor.z_start = position;
  sensor.z_rate_start = velocity;
  sensor.z_end = position;
  sensor.z_rate_end = velocity;
  connect(sensor.distance, distance)
    annotation(Line(points = {{0, -80}, {0, -90}, {-75, -90}, {-75, -100}}, color = {0, 0, 127}));
  connect(sensor.distance_true, distance_true)
    annotation(Line(points = {{0, -80}, {0, -90}, {-45, -90}, {-45, -100}}, color = {0, 0, 127}));
  valid = sensor.valid;
  touching = sensor.touching;
  connect(sensor.touch_time, touch_time)
    annotation(Line(points = {{0, -80}, {0, -90}, {45, -90}, {45, -100}}, color = {0, 0, 127}));
  touch_count = sensor.touch_count;
  annotation(
    __axisrig(returns_early = "touching"),
    Icon(graphics = {
      Line(points = {{0, 30}, {0, -60}}),
      Polygon(points = {{-20, -40}, {20, -40}, {8, -70}, {-8, -70}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid)}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: those of ServoAxis and DistanceSensor; the axis is z, the nozzle is at
(sensor_x, sensor_y, position). Parameters of the sensor and its workpiece have its name before them:
<code>sensor.range</code>, <code>sensor.workpiece.plane.level</code>.</p>
<p>An importer of FMI 3.0 that allows it gets control back when the nozzle begins or ends to touch (early
return).</p>
<p>Assumption: the axis gives the z of the sensor, at every instant; sensor_x and sensor_y rest between two
communication points. Limit: one axis moves within a step. Source: the parts.</p>
</html>"));
end DistanceSensorOnAxis;
