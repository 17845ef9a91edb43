within AxisRig.Validation;
model SampledServoAxis "Sampled velocity loop: contact, saturation, release, stick, power off"
  Examples.Course course(
    forward_end = 0.20003,
    back_start = 0.35003,
    back_position = 0.005,
    back_end = 0.55003,
    off = 0.85003);
  parameter Units.Position position_start = 1e-4 "Position at the start";
  parameter Units.Rate kv = 20 "Gain of the position loop";
  parameter Units.Share feed_forward = 0.3 "Share of velocity feed-forward";
  parameter Units.Frequency velocity_bandwidth = 60 "Bandwidth of the velocity loop, sets its gain";
  parameter Units.Time velocity_integral_time = 8e-3 "Integral time of the velocity loop";
  parameter Units.Time anti_windup_time = 6e-3 "Back-calculation time of the velocity loop";
  parameter Units.Frequency current_bandwidth = 800 "Bandwidth of the current loop";
  parameter Units.Force force_limit_motor = 550 "Largest motor force, in terms of the slide";
  parameter Units.Mass mass = 120 "Slide with what it carries";
  parameter Units.Inertia rotor_inertia = 1.8e-4 "Motor, coupling and screw";
  parameter Units.Length screw_lead = 0.01 "Travel per revolution";
  parameter Units.Position stop_position = 0.005 "Fixed stop; the default lies out of reach";
  parameter Units.Stiffness stop_stiffness = 20e6 "Stiffness of the stop";
  parameter Units.ContactDamping stop_damping = 20 "Share of the stop's spring force per velocity";
  parameter Units.Force weight = 60 "Weight that no counterbalance carries, pulls towards negative";
  parameter Units.Time sample_period = 62.5e-6 "Cycle of the velocity loop";
  parameter Units.TorqueConstant torque_constant = 0.49 "Torque per current";
  parameter Units.Resistance resistance = 3.07 "Of the motor winding";
  parameter Units.Inductance inductance = 6.57e-3 "Of the motor winding";
  parameter Units.Voltage voltage_limit = 20 "What the inverter can give";
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
    voltage_limit = voltage_limit);
  output Units.Position position "Slide";
  output Units.Velocity velocity "Slide";
  output Units.Position motor_position "Motor encoder";
  output Units.Force force "Motor force";
  output Units.Force stop_force "Force of the stop";
equation
  axis.reference_position = course.reference_position;
  axis.reference_velocity = course.reference_velocity;
  axis.reference_time = course.reference_time;
  axis.reference_end = course.reference_end;
  axis.enabled = course.enabled;
  axis.force_limit = course.force_limit;
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
