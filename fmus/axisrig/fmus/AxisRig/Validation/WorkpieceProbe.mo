within AxisRig.Validation;
model WorkpieceProbe "A ball scans down on waves, retreats, and is switched off"
  extends Icons.Experiment;
  Sensors.WorkpieceProbe probe(
    ball_radius = 3e-3,
    pretravel = 15e-6,
    pretravel_scatter = 4e-6,
    first_touch = 3e-6,
    drift = 2e-6,
    seat_force = 2.5,
    stylus_length = 50e-3,
    seat_radius = 10e-3,
    seat_angle = 0.1,
    bending_stiffness = 0.2e6,
    axial_stiffness = 2e6,
    contact_modulus = 1e11,
    trigger_delay = 1e-3,
    radio_delay = 9e-3,
    radio_jitter = 2e-3,
    seed = 5,
    bounce_count = 2,
    release_bounce_count = 1,
    bounce_time = 1.2e-3,
    switch_on_time = 0.0319,
    workpiece(
      inclined(azimuth = 0.3, angle = 0.2, origin = 1e-3),
      sine(azimuth = 0.1, amplitude = 0.3e-3, wavelength = 0.05, phase = 0.4)))
    "Probe under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position gap "Distance of the ball";
  output Units.Time contact_time "Touch";
  output Units.Position contact_x "x there";
  output Units.Length total_pretravel "In the direction of the surface";
  output Units.Time rising_time "Last edge of the signal";
  output Units.Time falling_time "Last edge of the signal";
  output Integer rising_count "Edges of the signal";
  output Boolean ready "Switched on for long enough";
  output Units.Length clearance "Lower bound of the way to the next edge";
equation
  probe.switched_on = time < 0.37;
  probe.step_time = 0;
  probe.step_size = 0.4;
  probe.x_start = 0.01;
  probe.x_rate_start = 0.02;
  probe.x_end = 0.018;
  probe.x_rate_end = 0.03;
  probe.y_start = -0.02;
  probe.y_rate_start = 0.01;
  probe.y_end = -0.016;
  probe.y_rate_end = 0.015;
  probe.z_start = 6.5e-3;
  probe.z_rate_start = -0.05;
  probe.z_end = 7.5e-3;
  probe.z_rate_end = 0.05;
  gap = probe.gap;
  contact_time = probe.contact_time;
  contact_x = probe.contact_x;
  total_pretravel = probe.total_pretravel;
  rising_time = probe.rising_time;
  falling_time = probe.falling_time;
  rising_count = probe.rising_count;
  ready = probe.ready;
  clearance = probe.clearance;
  annotation(
    experiment(StopTime=0.4, Interval=4.003e-3),
    Documentation(info="<html>
<p>Inclined plane with a sine across. Compared: gap, pre-travel by direction, clearance, instants and
numbers of contact and edges, and readiness.</p>
</html>"));
end WorkpieceProbe;
