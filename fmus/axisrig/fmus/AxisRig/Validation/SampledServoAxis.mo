within AxisRig.Validation;
model SampledServoAxis "Sampled velocity loop: contact, saturation, release, stick, power off"
  extends Icons.Experiment;
  Examples.Course course(
    forward_end = 0.20003,
    back_start = 0.35003,
    back_position = 0.005,
    back_end = 0.55003,
    off = 0.85003)
    "Demand"
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
  parameter Units.Position stop_position = 0.005 "Fixed stop; the default lies out of reach"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Stiffness stop_stiffness = 20e6 "Stiffness of the stop"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.ContactDamping stop_damping = 20 "Share of the stop's spring force per velocity"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Force weight = 60 "Weight that no counterbalance carries, pulls towards negative"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Time sample_period = 62.5e-6 "Cycle of the velocity loop"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.TorqueConstant torque_constant = 0.49 "Torque per current"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Resistance resistance = 3.07 "Of the motor winding"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Inductance inductance = 6.57e-3 "Of the motor winding"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Voltage voltage_limit = 20 "What the inverter can give"
    annotation(Dialog(group = "Motor and current loop"));
  Drives.SampledServoAxis axis(
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
    stop_damping = stop_damping,
    weight = weight,
    sample_period = sample_period,
    torque_constant = torque_constant,
    resistance = resistance,
    inductance = inductance,
    voltage_limit = voltage_limit)
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
    experiment(StopTime=2, Interval=0.00502),
    Documentation(info="<html>
<p>Course with contact at the force limit, release, stick and power off, 1 s. No instant of the course is one of the samples.</p>
</html>"));
end SampledServoAxis;
