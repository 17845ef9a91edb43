within AxisRig.Validation;
model ServoAxis "Rigid axis: contact, saturation, release, stick, power off"
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
  parameter Units.ContactDamping stop_damping = 20 "Share of the stop's spring force per velocity";
  parameter Units.Force weight = 60 "Weight that no counterbalance carries, pulls towards negative";
  parameter Units.Force coulomb_friction = 120 "Coulomb friction";
  parameter Units.Force breakaway_friction = 160 "Breakaway force";
  parameter Units.Velocity stribeck_velocity = 5e-3
    "Velocity over which breakaway falls to Coulomb";
  parameter Units.Damping viscous_friction = 800 "Viscous friction";
  parameter Units.Velocity friction_slope_velocity = 1e-4
    "Velocity over which friction changes its sign";
  Drives.ServoAxis axis(
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
    coulomb_friction = coulomb_friction,
    breakaway_friction = breakaway_friction,
    stribeck_velocity = stribeck_velocity,
    viscous_friction = viscous_friction,
    friction_slope_velocity = friction_slope_velocity);
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
</html>"));
end ServoAxis;
