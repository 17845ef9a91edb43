within AxisRig.Examples;
model TiltingTouch "A probe touches a plane while its head tilts and goes down"
  extends Icons.Experiment;
  parameter Units.Velocity feed = 0.02 "Downwards"
    annotation(Dialog(group = "Parameters"));
  parameter Units.AngularVelocity turn = 0.4 "Of the A axis"
    annotation(Dialog(group = "Parameters"));
  Sensors.HeadTouchProbe tool(
    tool_length = 80e-3,
    head(reach = 100e-3),
    probe(surface = 0, ball_radius = 1e-3, trigger_delay = 2e-3))
    "Probe at the head"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  Units.Position tcp_y "Centre of the ball: y";
  Units.Position tcp_z "Centre of the ball: z";
  Units.Time contact_time "Touch";
  Units.Angle contact_a "A axis at the touch";
  Units.Time rising_time "Edge of the touch";
equation
  tool.step_time = 0;
  tool.step_size = 0.5;
  tool.x_start = 0;
  tool.x_rate_start = 0;
  tool.x_end = 0;
  tool.x_rate_end = 0;
  tool.y_start = 0;
  tool.y_rate_start = 0;
  tool.y_end = 0;
  tool.y_rate_end = 0;
  tool.z_start = 0.187;
  tool.z_rate_start = -feed;
  tool.z_end = 0.187 - 0.5*feed;
  tool.z_rate_end = -feed;
  tool.c_start = 0;
  tool.c_rate_start = 0;
  tool.c_end = 0;
  tool.c_rate_end = 0;
  tool.a_start = -0.3;
  tool.a_rate_start = turn;
  tool.a_end = -0.3 + 0.5*turn;
  tool.a_rate_end = turn;
  tcp_y = tool.tcp_y;
  tcp_z = tool.tcp_z;
  contact_time = tool.contact_time;
  contact_a = tool.contact_a;
  rising_time = tool.rising_time;
  annotation(
    experiment(StopTime = 0.5, Interval = 2e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>The lever of 180 mm straightens with 0.4 rad/s while the A axis goes down with 20 mm/s, and the ball of 1 mm meets
the plane z = 0. Reference: <code>Resources/ReferenceResults/TiltingTouch.csv</code>, a root of
z - L cos(a) - r by a script that knows nothing of this model.</p>
</html>"));
end TiltingTouch;
