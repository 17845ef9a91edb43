within AxisRig.Drives;
model RotaryAxis "Rotary table with drive cascade, friction, imbalance and a fixed stop"
  input Units.Angle reference_position "Demand at reference_time";
  input Units.AngularVelocity reference_velocity "Slope of the demand until reference_end";
  input Units.Time reference_time "Instant of reference_position";
  input Units.Time reference_end "Instant from which the demand rests";
  input Boolean enabled(start = false) "Power stage on; off: no motor torque";
  input Units.Torque force_limit(start = 1e9, min = 0)
    "Further limit of the motor torque, both directions";
  input Units.Torque force_limit_positive(start = 1e9, min = 0)
    "Further limit of the motor torque, positive direction";
  input Units.Torque force_limit_negative(start = 1e9, min = 0)
    "Further limit of the motor torque, negative direction, as an amount";
  input Integer control(start = 0, min = 0, max = 2)
    "What is controlled; 0: position, 1: velocity, 2: torque";
  input Units.AngularAcceleration reference_acceleration
    "Velocity control: the demand is reference_velocity + this*(min(t, end) - time)";
  input Units.Torque reference_force "Control of the torque: demand";

  parameter Units.Angle position_start = 0 "Angle at the start";
  parameter Units.Rate kv(min = 0) = 10 "Gain of the position loop";
  parameter Units.Share feed_forward = 0 "Share of velocity feed-forward";
  parameter Units.Frequency velocity_bandwidth = 60
    "Bandwidth of the velocity loop, sets its gain";
  parameter Units.Time velocity_integral_time(min = 1e-5) = 8e-3
    "Integral time of the velocity loop";
  parameter Units.Time anti_windup_time(min = 1e-5) = 8e-3
    "Back-calculation time of the velocity loop";
  parameter Units.Frequency current_bandwidth(min = 1) = 800 "Bandwidth of the current loop";
  parameter Units.Torque torque_limit_motor(min = 0) = 300 "Largest torque at the table";
  parameter Units.Inertia inertia(min = 1e-6) = 0.5 "Table with what it carries";
  parameter Units.Inertia rotor_inertia = 1.8e-4 "Motor and coupling";
  parameter Units.Ratio gear_ratio = 60 "Turns of the motor per turn of the table";
  parameter Units.Torque imbalance = 0 "Weight times distance of the centre of mass";
  parameter Units.Torque coulomb_friction(min = 0) = 8 "Coulomb friction";
  parameter Units.Torque breakaway_friction(min = 0) = 11 "Breakaway torque";
  parameter Units.AngularVelocity stribeck_velocity(min = 1e-6) = 0.01
    "Angular velocity over which breakaway falls to Coulomb";
  parameter Units.TorsionalDamping viscous_friction = 5 "Viscous friction";
  parameter Units.TorsionalStiffness bristle_stiffness = 5e5 "Stiffness while it sticks";
  parameter Units.TorsionalDamping bristle_damping = 200 "Damping while it sticks";
  parameter Units.Angle stop_position = 1e3 "Fixed stop; the default lies out of reach";
  parameter Integer stop_direction(min = -1, max = 1) = 1
    "1: the stop is met in positive direction, -1: in negative direction";
  parameter Units.AngularVelocity stop_speed(min = -1, max = 1) = 0
    "Of the stop from stop_begin to stop_end; 0: it stands";
  parameter Units.Time stop_begin = 0 "When the stop begins to move";
  parameter Units.Time stop_end = 0 "When it stands again";
  parameter Units.TorsionalStiffness stop_stiffness = 1e6 "Stiffness of the stop";
  parameter Units.TorsionalContactDamping stop_damping = 1
    "Share of the stop's spring torque per angular velocity";
  final parameter Units.Inertia effective_inertia = inertia + rotor_inertia*gear_ratio^2
    "Table and motor, at the table";
  final parameter Units.TorsionalDamping velocity_gain = 2*pi*velocity_bandwidth*effective_inertia
    "Proportional gain of the velocity loop";

  output Units.Angle position "Angle of the table (truth)";
  output Units.AngularVelocity velocity "Angular velocity of the table (truth)";
  output Units.Angle motor_position "Motor encoder, in terms of the table";
  output Units.AngularVelocity motor_velocity "Velocity of the motor encoder, at the table";
  output Units.Angle demand_position "Demand";
  output Units.Torque force "Motor torque at the table";
  output Units.Torque stop_force "Torque between table and stop";
  output Units.Angle stop_face "Where the stop is touched now (truth)";
protected
  constant Real pi = 3.141592653589793;
  constant Units.Length arm = 1 "Radius at which the linear parts act";
  DriveCascade drive(
    kv = kv,
    feed_forward = feed_forward,
    velocity_gain = velocity_gain/arm^2,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = torque_limit_motor/arm);
  Mechanics.Slide rim(mass = effective_inertia/arm^2, position_start = position_start*arm);
  Mechanics.LuGreFriction friction(
    coulomb = coulomb_friction/arm,
    breakaway = breakaway_friction/arm,
    stribeck = stribeck_velocity*arm,
    viscous = viscous_friction/arm^2,
    bristle_stiffness = bristle_stiffness/arm^2,
    bristle_damping = bristle_damping/arm^2);
  Mechanics.FixedStop stop(
    stop_position = stop_position*arm,
    stop_direction = stop_direction,
    stop_speed = stop_speed*arm,
    stop_begin = stop_begin,
    stop_end = stop_end,
    stiffness = stop_stiffness/arm^2,
    damping = stop_damping/arm);
  Mechanics.Load load "Of the imbalance";
equation
  drive.reference_position = reference_position*arm;
  drive.reference_velocity = reference_velocity*arm;
  drive.reference_time = reference_time;
  drive.reference_end = reference_end;
  drive.enabled = enabled;
  drive.force_limit = force_limit/arm;
  drive.force_limit_positive = force_limit_positive/arm;
  drive.force_limit_negative = force_limit_negative/arm;
  drive.control = control;
  drive.reference_acceleration = reference_acceleration*arm;
  drive.reference_force = reference_force/arm;
  load.force = -imbalance/arm*sin(position);
  connect(drive.flange, rim.flange);
  connect(friction.flange, rim.flange);
  connect(stop.flange, rim.flange);
  connect(load.flange, rim.flange);
  position = rim.position/arm;
  velocity = rim.velocity/arm;
  motor_position = position;
  motor_velocity = velocity;
  demand_position = drive.demand_position/arm;
  force = drive.force*arm;
  stop_force = stop.force*arm;
  stop_face = stop.face/arm;
  annotation(
    Documentation(info="<html>
<p>Equation: (I + J i^2) dw/dt = M_motor - M_friction - M_stop - M_u sin(phi). The parts are those
of a linear axis that act at a radius of 1 m, where a force in N is a torque in N.m.</p>
<p>Steady lag in motion with constant w: (1 - f) w/Kv.</p>
<p>Assumptions: rigid gear without play; the angle counts on over full turns. Limits: at zero the
centre of mass lies lowest; no modulo. Source: the parts.</p>
</html>"));
end RotaryAxis;
