within AxisRig.Validation;
model ScrewAxis "Two-mass axis with backlash: contact, saturation, release, stick, power off"
  extends Icons.Experiment;
  Examples.Course course "Demand"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  parameter Units.Position position_start = 1e-4 "Position at the start"
    annotation(Dialog(group = "Start"));
  parameter Units.Rate kv = 20 "Gain of the position loop"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Share feed_forward = 0.3 "Share of velocity feed-forward"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Frequency velocity_bandwidth = 60 "Bandwidth of the velocity loop, sets its gain"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time velocity_integral_time = 8e-3 "Integral time of the velocity loop"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time anti_windup_time = 6e-3 "Back-calculation time of the velocity loop"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Frequency current_bandwidth = 800 "Bandwidth of the current loop"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Force force_limit_motor = 550 "Largest motor force, in terms of the slide"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Mass mass = 120 "Slide with what it carries"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia rotor_inertia = 1.8e-4 "Motor, coupling and screw"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Length screw_lead = 0.01 "Travel per revolution"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Position stop_position = 0.015 "Fixed stop; the default lies out of reach"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Stiffness stop_stiffness = 20e6 "Stiffness of the stop"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Exponent stop_exponent = 1.2 "Power of its penetration; 1: straight"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.ContactDamping stop_damping = 20 "Share of the stop's spring force per velocity"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Force weight = 60 "Weight that no counterbalance carries, pulls towards negative"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Stiffness screw_stiffness = 120e6 "Screw, nut and bearing, at the slide"
    annotation(Dialog(group = "Elastic parts"));
  parameter Units.Damping screw_damping = 6e3 "Damping of the screw, at the slide"
    annotation(Dialog(group = "Elastic parts"));
  parameter Units.Damping motor_friction = 100 "Viscous friction of the motor, at the slide"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Length backlash = 10e-6 "Free travel of the nut; 0: preloaded nut"
    annotation(Dialog(group = "Elastic parts"));
  Drives.ScrewAxis axis(
    position_start = position_start,
    kv = kv,
    feed_forward = feed_forward,
    velocity_bandwidth = velocity_bandwidth,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = force_limit_motor,
    mass = mass,
    rotor_inertia = rotor_inertia,
    screw_lead = screw_lead,
    stop_position = stop_position,
    stop_stiffness = stop_stiffness,
    stop_exponent = stop_exponent,
    stop_damping = stop_damping,
    weight = weight,
    screw_stiffness = screw_stiffness,
    screw_damping = screw_damping,
    motor_friction = motor_friction,
    backlash = backlash)
    "Axis under test"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Units.Position position "Slide";
  output Units.Velocity velocity "Slide";
  output Units.Position motor_position "Motor encoder";
  output Units.Force force "Motor force";
  output Units.Force stop_force "Force of the stop";
equation
  connect(course.reference_position, axis.reference_position)
    annotation(Line(points = {{-18, 18}, {18, 18}}, color = {0, 0, 127}));
  connect(course.reference_velocity, axis.reference_velocity)
    annotation(Line(points = {{-18, 11}, {0, 11}, {0, 14}, {18, 14}}, color = {0, 0, 127}));
  connect(course.reference_time, axis.reference_time)
    annotation(Line(points = {{-18, 4}, {0, 4}, {0, 11}, {18, 11}}, color = {0, 0, 127}));
  connect(course.reference_end, axis.reference_end)
    annotation(Line(points = {{-18, -4}, {0, -4}, {0, 7}, {18, 7}}, color = {0, 0, 127}));
  axis.enabled = course.enabled;
  connect(course.force_limit, axis.force_limit)
    annotation(Line(points = {{-18, -18}, {0, -18}, {0, 0}, {18, 0}}, color = {0, 0, 127}));
  axis.force_limit_positive = 1e9;
  axis.force_limit_negative = 1e9;
  axis.control = 0;
  axis.reference_acceleration = 0;
  axis.reference_force = 0;
  position = axis.position;
  velocity = axis.velocity;
  motor_position = axis.motor_position;
  force = axis.force;
  stop_force = axis.stop_force;
  annotation(
    experiment(StopTime=2, Interval=0.005),
    Documentation(info="<html>
<p>Course with contact at the force limit, release, stick and power off, 2 s.</p>
<p>The motor position differs from the slide by half the backlash, with the sign of the load.</p>
</html>"));
end ScrewAxis;
