within AxisRig.Validation;
model TouchProbe "A ball touches an inclined plane and retreats"
  extends Icons.Experiment;
  parameter Units.Angle inclination = 0.3 "Of the normal from z"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Angle azimuth = 0.4 "Of the normal from x"
    annotation(Dialog(group = "Parameters"));
  Sensors.TouchProbe probe(
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
    trigger_delay = 3e-3)
    "Probe under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position gap "Distance of the ball";
  output Units.Length clearance "To the next edge";
  output Units.Time contact_time "Touch";
  output Units.Position contact_z "z there";
  output Units.Time rising_time "Edge of the signal";
  output Units.Time falling_time "Edge of the signal";
equation
  probe.step_time = 0;
  probe.step_size = 0.4;
  probe.x_start = 0.01;
  probe.x_rate_start = 0.02;
  probe.x_end = 0.012;
  probe.x_rate_end = -0.01;
  probe.y_start = -0.02;
  probe.y_rate_start = 0;
  probe.y_end = -0.021;
  probe.y_rate_end = 0;
  probe.z_start = 0.108;
  probe.z_rate_start = -0.05;
  probe.z_end = 0.108;
  probe.z_rate_end = 0.05;
  gap = probe.gap;
  clearance = probe.clearance;
  contact_time = probe.contact_time;
  contact_z = probe.contact_z;
  rising_time = probe.rising_time;
  falling_time = probe.falling_time;
  annotation(
    experiment(StopTime=0.4, Interval=4.003e-3),
    Documentation(info="<html>
<p>Compared: gap, clearance, instants of contact and edges, place of the contact.</p>
</html>"));
end TouchProbe;
