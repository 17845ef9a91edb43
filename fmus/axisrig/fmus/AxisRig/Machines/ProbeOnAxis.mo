within AxisRig.Machines;
model ProbeOnAxis "Servo axis with a touch probe that moves with it along z"
  extends Drives.ServoAxis;
  Interfaces.PositionInput probe_x "Where the probe is: x"
    annotation(Placement(transformation(origin = {-40, 110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.PositionInput probe_y "Where the probe is: y"
    annotation(Placement(transformation(origin = {40, 110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.BooleanOutput signal "Switching output of the probe"
    annotation(Placement(transformation(origin = {-80, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.TimeOutput rising_time "Instant of the last rising edge of the signal"
    annotation(Placement(transformation(origin = {-60, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.TimeOutput falling_time "Instant of the last falling edge of the signal"
    annotation(Placement(transformation(origin = {-40, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.IntegerOutput rising_count "Rising edges of the signal since the start"
    annotation(Placement(transformation(origin = {-20, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.IntegerOutput falling_count "Falling edges of the signal since the start"
    annotation(Placement(transformation(origin = {0, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.PositionOutput edge_position(start = 0, fixed = true)
    "Motor encoder at the last rising edge of the signal"
    annotation(Placement(transformation(origin = {20, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.BooleanOutput contact "The ball touches the plane (truth)"
    annotation(Placement(transformation(origin = {40, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.TimeOutput contact_time "Last instant at which it began to (truth)"
    annotation(Placement(transformation(origin = {60, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.PositionOutput gap "Distance of the ball from the plane (truth)"
    annotation(Placement(transformation(origin = {80, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Sensors.TouchProbe probe "Probe on the slide"
    annotation(Placement(transformation(extent = {{-20, -80}, {20, -40}})));
equation
  // A step that begins now: its first position and rate are those of the axis.
  probe.step_time = time;
  probe.step_size = 1;
  connect(probe_x, probe.x_start)
    annotation(Line(points = {{-40, 100}, {-40, -50}, {-20, -50}}, color = {0, 0, 127}));
  probe.x_rate_start = 0;
  connect(probe_x, probe.x_end)
    annotation(Line(points = {{-40, 100}, {-40, -50}, {-20, -50}}, color = {0, 0, 127}));
  probe.x_rate_end = 0;
  connect(probe_y, probe.y_start)
    annotation(Line(points = {{40, 100}, {40, -60}, {20, -60}}, color = {0, 0, 127}));
  probe.y_rate_start = 0;
  connect(probe_y, probe.y_end)
    annotation(Line(points = {{40, 100}, {40, -60}, {20, -60}}, color = {0, 0, 127}));
  probe.y_rate_end = 0;
  probe.z_start = position;
  probe.z_rate_start = velocity;
  probe.z_end = position;
  probe.z_rate_end = velocity;
  signal = probe.signal;
  connect(probe.rising_time, rising_time)
    annotation(Line(points = {{0, -80}, {0, -90}, {-60, -90}, {-60, -100}}, color = {0, 0, 127}));
  connect(probe.falling_time, falling_time)
    annotation(Line(points = {{0, -80}, {0, -90}, {-40, -90}, {-40, -100}}, color = {0, 0, 127}));
  rising_count = probe.rising_count;
  falling_count = probe.falling_count;
  contact = probe.contact;
  connect(probe.contact_time, contact_time)
    annotation(Line(points = {{0, -80}, {0, -90}, {60, -90}, {60, -100}}, color = {0, 0, 127}));
  connect(probe.gap, gap)
    annotation(Line(points = {{0, -80}, {0, -90}, {80, -90}, {80, -100}}, color = {0, 0, 127}));
  when probe.signal then
    edge_position = motor_position;
  end when;
  annotation(
    __axisrig(returns_early = "signal"),
    Icon(graphics = {
      Line(points = {{0, 30}, {0, -60}}),
      Ellipse(extent = {{-10, -80}, {10, -60}}, fillColor = {255, 0, 0},
          fillPattern = FillPattern.Solid)}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: those of ServoAxis and TouchProbe; the axis is z, the probe is at (probe_x, probe_y, position).
Parameters of the probe have its name before them: <code>probe.surface</code>.</p>
<p>An edge is given as level, instant, number and the motor encoder at it. An importer of FMI 3.0 that allows
it gets control back at each edge of the signal (early return); for others nothing is lost.</p>
<p>Assumption: the axis gives the z of the probe, at every instant; probe_x and probe_y rest between two
communication points. Limit: one axis moves. Source: the parts.</p>
</html>"));
end ProbeOnAxis;
