within AxisRig.Drives;
model ServoAxis "Servo axis with position, velocity and current loop, friction and a fixed stop"
  input Units.Position reference_position "Demand at reference_time";
  input Units.Velocity reference_velocity "Slope of the demand until reference_end";
  input Units.Time reference_time "Instant of reference_position";
  input Units.Time reference_end "Instant from which the demand rests";
  input Boolean enabled(start = false) "Power stage on; off: no motor force";
  input Units.Force force_limit(start = 1e9, min = 0) "Further limit of the motor force";

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
  parameter Units.Force weight = 0 "Weight that no counterbalance carries, pulls towards negative";
  parameter Units.Force coulomb_friction(min = 0) = 120 "Coulomb friction";
  parameter Units.Force breakaway_friction(min = 0) = 160 "Breakaway force";
  parameter Units.Velocity stribeck_velocity(min = 1e-6) = 5e-3
    "Velocity over which breakaway falls to Coulomb";
  parameter Units.Damping viscous_friction = 800 "Viscous friction";
  parameter Units.Velocity friction_slope_velocity(min = 1e-6) = 1e-4
    "Velocity over which friction changes its sign";
  parameter Units.Position stop_position = 1e3 "Fixed stop; the default lies out of reach";
  parameter Integer stop_direction(min = -1, max = 1) = 1
    "1: the stop is met in positive direction, -1: in negative direction";
  parameter Units.Stiffness stop_stiffness = 20e6 "Stiffness of the stop";
  parameter Units.ContactDamping stop_damping = 20
    "Share of the stop's spring force per velocity";
  final parameter Units.Mass effective_mass = mass + rotor_inertia*(2*pi/screw_lead)^2
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
protected
  constant Real pi = 3.141592653589793;
  Setpoint setpoint;
  PositionController position_controller(kv = kv, feed_forward = feed_forward);
  VelocityController velocity_controller(
    gain = velocity_gain,
    integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time);
  ForceActuator actuator(bandwidth = current_bandwidth);
  Mechanics.Slide slide(mass = effective_mass, weight = weight, position_start = position_start);
  Mechanics.GuidewayFriction friction(
    coulomb = coulomb_friction,
    breakaway = breakaway_friction,
    stribeck = stribeck_velocity,
    viscous = viscous_friction,
    slope = friction_slope_velocity);
  Mechanics.FixedStop stop(
    stop_position = stop_position,
    stop_direction = stop_direction,
    stiffness = stop_stiffness,
    damping = stop_damping);
equation
  setpoint.reference_position = reference_position;
  setpoint.reference_velocity = reference_velocity;
  setpoint.reference_time = reference_time;
  setpoint.reference_end = reference_end;
  position_controller.demand_position = setpoint.position;
  position_controller.demand_velocity = setpoint.velocity;
  position_controller.position = motor_position;
  velocity_controller.velocity_reference = position_controller.velocity_reference;
  velocity_controller.velocity = motor_velocity;
  velocity_controller.limit = min(force_limit, force_limit_motor);
  velocity_controller.enabled = enabled;
  actuator.force_reference = velocity_controller.force_reference;
  connect(actuator.flange, slide.flange);
  connect(friction.flange, slide.flange);
  connect(stop.flange, slide.flange);
  position = slide.position;
  velocity = slide.velocity;
  motor_position = slide.position;
  motor_velocity = slide.velocity;
  demand_position = setpoint.position;
  force = actuator.force;
  stop_force = stop.force;
  annotation(
    Documentation(info="<html>
<p>The cascade: straight setpoint, P position loop, PI velocity loop with force limit and
anti-windup, first-order current loop; then one rigid mass with friction, a weight and a fixed stop.
The parts hold the equations. Effective mass: m + J (2 pi/h)^2 with the screw lead h.</p>
<p>Steady lag in motion with constant v: (1 - f) v/Kv. Contact at standstill with the stop at the
force limit: penetration (F_lim - F_g)/k.</p>
<p>Limits: rigid between motor and slide (motor_position = position), no backlash, no brake;
continuous controllers. The default values describe a 2.2 Nm motor on a 10 mm screw.</p>
</html>"));
end ServoAxis;
