within AxisRig.Drives;
partial model PartialAxis "Inputs, outputs, drive and fixed stop of a linear axis"
  input Units.Position reference_position "Demand at reference_time";
  input Units.Velocity reference_velocity "Slope of the demand until reference_end";
  input Units.Time reference_time "Instant of reference_position";
  input Units.Time reference_end "Instant from which the demand rests";
  input Boolean enabled(start = false) "Power stage on; off: no motor force";
  input Units.Force force_limit(start = 1e9, min = 0)
    "Further limit of the motor force, both directions";
  input Units.Force force_limit_positive(start = 1e9, min = 0)
    "Further limit of the motor force, positive direction";
  input Units.Force force_limit_negative(start = 1e9, min = 0)
    "Further limit of the motor force, negative direction, as an amount";
  input Integer control(start = 0, min = 0, max = 2)
    "What is controlled; 0: position, 1: velocity, 2: force";
  input Units.Acceleration reference_acceleration
    "Velocity control: the demand is reference_velocity + this*(min(t, end) - time)";
  input Units.Force reference_force "Control of the force: demand";

  parameter Units.Position position_start = 0 "Position at the start";
  parameter Units.Rate kv(min = 0) = 10 "Gain of the position loop";
  parameter Units.Share feed_forward = 0 "Share of velocity feed-forward";
  parameter Units.Frequency velocity_bandwidth = 60
    "Bandwidth of the velocity loop, sets its gain";
  parameter Units.Time velocity_integral_time(min = 1e-5) = 8e-3
    "Integral time of the velocity loop";
  parameter Units.Time anti_windup_time(min = 1e-5) = 8e-3
    "Back-calculation time of the velocity loop";
  parameter Units.Frequency current_bandwidth(min = 1) = 800 "Bandwidth of the current loop";
  parameter Units.Force force_limit_motor(min = 0) = 4000
    "Largest motor force, in terms of the slide";
  parameter Units.Mass mass(min = 1e-3) = 120 "Slide with what it carries";
  parameter Units.Inertia rotor_inertia = 1.8e-4 "Motor, coupling and screw";
  parameter Units.Length screw_lead(min = 1e-4) = 0.01 "Travel per revolution";
  parameter Units.Position stop_position = 1e3 "Fixed stop; the default lies out of reach";
  parameter Integer stop_direction(min = -1, max = 1) = 1
    "1: the stop is met in positive direction, -1: in negative direction";
  parameter Units.Velocity stop_speed(min = -1, max = 1) = 0
    "Of the stop from stop_begin to stop_end; 0: it stands";
  parameter Units.Time stop_begin = 0 "When the stop begins to move";
  parameter Units.Time stop_end = 0 "When it stands again";
  parameter Units.Stiffness stop_stiffness = 20e6 "Stiffness of the stop";
  parameter Units.Exponent stop_exponent = 1 "Power of its penetration; 1: straight";
  parameter Units.ContactDamping stop_damping = 20
    "Share of the stop's spring force per velocity";
  final parameter Units.Mass rotor_mass = rotor_inertia*(2*pi/screw_lead)^2
    "Rotating parts, in terms of the slide";
  final parameter Units.Mass effective_mass = mass + rotor_mass
    "Slide and rotating parts, in terms of the slide";
  final parameter Units.Damping velocity_gain = 2*pi*velocity_bandwidth*effective_mass
    "Proportional gain of the velocity loop";

  output Units.Position position "Position of the slide (truth)";
  output Units.Velocity velocity "Velocity of the slide (truth)";
  output Units.Position motor_position "Motor encoder, in terms of the slide";
  output Units.Velocity motor_velocity "Velocity of the motor encoder, in terms of the slide";
  output Units.Position demand_position "Position demand";
  output Units.Force force "Motor force on the slide";
  output Units.Force stop_force "Force between slide and stop";
  output Units.Position stop_face "Where the stop is touched now (truth)";
protected
  constant Real pi = 3.141592653589793;
  replaceable DriveCascade drive(
    kv = kv,
    feed_forward = feed_forward,
    velocity_gain = velocity_gain,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = force_limit_motor)
    constrainedby PartialCascade(
      kv = kv,
      feed_forward = feed_forward,
      velocity_gain = velocity_gain,
      velocity_integral_time = velocity_integral_time,
      anti_windup_time = anti_windup_time,
      current_bandwidth = current_bandwidth,
      force_limit_motor = force_limit_motor);
  Mechanics.FixedStop stop(
    stop_position = stop_position,
    stop_direction = stop_direction,
    stop_speed = stop_speed,
    stop_begin = stop_begin,
    stop_end = stop_end,
    stiffness = stop_stiffness,
    exponent = stop_exponent,
    damping = stop_damping);
equation
  drive.reference_position = reference_position;
  drive.reference_velocity = reference_velocity;
  drive.reference_time = reference_time;
  drive.reference_end = reference_end;
  drive.enabled = enabled;
  drive.force_limit = force_limit;
  drive.force_limit_positive = force_limit_positive;
  drive.force_limit_negative = force_limit_negative;
  drive.control = control;
  drive.reference_acceleration = reference_acceleration;
  drive.reference_force = reference_force;
  motor_position = drive.flange.s;
  motor_velocity = drive.motor_velocity;
  demand_position = drive.demand_position;
  force = drive.force;
  stop_force = stop.force;
  stop_face = stop.face;
  annotation(
    Documentation(info="<html>
<p>Equation: m_eff = m + J (2 pi/h)^2 with the screw lead h; gain of the velocity loop
2 pi f_v m_eff. A model that extends this one adds what lies between motor and slide.</p>
<p>Assumption: one motor on one screw. Limit: without the parts of the extending model it is
incomplete. Source: H. Gross et al., Electrical Feed Drives in Automation.</p>
</html>"));
end PartialAxis;
