within AxisRig.Validation;
model HeadTouchProbe "A ball at an inclined tool touches a plane while the head turns, and retreats"
  extends Icons.Experiment;
  parameter Units.Angle inclination = 0.3 "Of the normal from z"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Angle azimuth = 0.4 "Of the normal from x"
    annotation(Dialog(group = "Parameters"));
  Sensors.HeadTouchProbe tool(
    tool_length = 60e-3,
    head(
      hd1 = 20e-3,
      hd2 = 35e-3,
      hd3 = 0.05,
      hd4 = -0.07,
      hd5 = 4e-3,
      hd6 = -3e-3,
      hd7 = 1e-3,
      hd8 = 2e-3,
      hd9 = 6e-3,
      reach = 10e-3),
    probe(
      normal_x = sin(inclination)*cos(azimuth),
      normal_y = sin(inclination)*sin(azimuth),
      normal_z = cos(inclination),
      surface = 0.1,
      ball_radius = 2e-3,
      pretravel = 5e-6,
      seat_force = 2.5,
      stylus_length = 50e-3,
      seat_radius = 10e-3,
      seat_angle = 0.1,
      bending_stiffness = 0.2e6,
      axial_stiffness = 2e6,
      trigger_delay = 3e-3))
    "Probe under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position gap "Distance of the ball";
  output Units.Position tcp_x "Centre of the ball: x";
  output Units.Position tcp_y "Centre of the ball: y";
  output Units.Position tcp_z "Centre of the ball: z";
  output Units.Length clearance "To the next edge";
  output Units.Time contact_time "Touch";
  output Units.Angle contact_c "C there";
  output Units.Position contact_z "Z there";
  output Units.Position contact_tcp_y "Centre of the ball there: y";
  output Units.Time rising_time "Edge of the signal";
  output Units.Time falling_time "Edge of the signal";
equation
  tool.step_time = 0;
  tool.step_size = 0.4;
  tool.x_start = 0.01;
  tool.x_rate_start = 0.02;
  tool.x_end = 0.012;
  tool.x_rate_end = -0.01;
  tool.y_start = -0.02;
  tool.y_rate_start = 2e-3;
  tool.y_end = -0.021;
  tool.y_rate_end = -1e-3;
  tool.z_start = 0.2311;
  tool.z_rate_start = -0.05;
  tool.z_end = 0.2311;
  tool.z_rate_end = 0.05;
  tool.c_start = 0.3;
  tool.c_rate_start = 0.1;
  tool.c_end = 0.33;
  tool.c_rate_end = 0.05;
  tool.a_start = -0.4;
  tool.a_rate_start = -0.05;
  tool.a_end = -0.42;
  tool.a_rate_end = -0.02;
  gap = tool.gap;
  tcp_x = tool.tcp_x;
  tcp_y = tool.tcp_y;
  tcp_z = tool.tcp_z;
  clearance = tool.clearance;
  contact_time = tool.contact_time;
  contact_c = tool.contact_c;
  contact_z = tool.contact_z;
  contact_tcp_y = tool.contact_tcp_y;
  rising_time = tool.rising_time;
  falling_time = tool.falling_time;
  annotation(
    experiment(StopTime=0.4, Interval=4.003e-3),
    Documentation(info="<html>
<p>Compared: gap, centre of the ball, clearance, instants of contact and edges, axes and ball at the contact.</p>
</html>"));
end HeadTouchProbe;
