within AxisRig.Validation;
model ScrewAxis "Two-mass axis with backlash: contact, saturation, release, stick, power off"
  Examples.Course course;
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
  parameter Units.Position stop_position = 0.015 "Fixed stop; the default lies out of reach";
  parameter Units.Stiffness stop_stiffness = 20e6 "Stiffness of the stop";
  parameter Units.Exponent stop_exponent = 1.2 "Power of its penetration; 1: straight";
  parameter Units.ContactDamping stop_damping = 20 "Share of the stop's spring force per velocity";
  parameter Units.Force weight = 60 "Weight that no counterbalance carries, pulls towards negative";
  parameter Units.Stiffness screw_stiffness = 120e6 "Screw, nut and bearing, at the slide";
  parameter Units.Damping screw_damping = 6e3 "Damping of the screw, at the slide";
  parameter Units.Damping motor_friction = 100 "Viscous friction of the motor, at the slide";
  parameter Units.Length backlash = 10e-6 "Free travel of the nut; 0: preloaded nut";
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
    backlash = backlash);
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
    experiment(StopTime=2, Interval=0.005),
    Documentation(info="<html>
<p>Course with contact at the force limit, release, stick and power off, 2 s.</p>
<p>The motor position differs from the slide by half the backlash, with the sign of the load.</p>
</html>"));
end ScrewAxis;
