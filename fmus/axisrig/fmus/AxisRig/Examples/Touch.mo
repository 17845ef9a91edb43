within AxisRig.Examples;
model Touch "An axis with a probe runs onto a plane and turns at the edge"
  extends Icons.Experiment;
  parameter Units.Velocity feed = 0.02 "Downwards, and upwards after the edge"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position top = 0.1 "Height of the plane"
    annotation(Dialog(group = "Parameters"));
  Machines.ProbeOnAxis machine(
    position_start = 0.105,
    kv = 40,
    coulomb_friction = 0,
    breakaway_friction = 0,
    probe(surface = top, ball_radius = 1e-3, pretravel = 10e-6, trigger_delay = 2e-3))
    "Axis with probe"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  Units.Position position "Axis";
  Units.Position edge_position "Axis at the edge";
  Units.Time contact_time "Touch";
  Units.Time rising_time "Edge of the touch";
  Units.Time falling_time "Edge of the release";
protected
  Boolean touched "The edge has come";
equation
  touched = machine.rising_count > 0;
  machine.reference_position = if touched then machine.edge_position else 0.105;
  machine.reference_velocity = if touched then feed else -feed;
  machine.reference_time = if touched then machine.rising_time else 0;
  machine.reference_end = 1e3;
  machine.enabled = true;
  machine.force_limit = 1e9;
  machine.force_limit_positive = 1e9;
  machine.force_limit_negative = 1e9;
  machine.control = 0;
  machine.reference_acceleration = 0;
  machine.reference_force = 0;
  machine.probe_x = 0;
  machine.probe_y = 0;
  position = machine.position;
  edge_position = machine.edge_position;
  contact_time = machine.contact_time;
  rising_time = machine.rising_time;
  falling_time = machine.falling_time;
  annotation(
    experiment(StopTime = 0.5, Interval = 2e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>At 20 mm/s the ball of 1 mm touches the plane at 101 mm; the signal comes 10 um and 2 ms later, and the demand
turns at that instant. Reference: <code>Resources/ReferenceResults/Touch.csv</code>, integrated from the
equations of the axis by a script that knows nothing of this model.</p>
</html>"));
end Touch;
