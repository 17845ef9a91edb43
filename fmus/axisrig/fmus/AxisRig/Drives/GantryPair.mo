within AxisRig.Drives;
model GantryPair "Two drives that move one beam on two guideways"
  input Units.Position reference_position_1 "Demand at reference_time_1";
  input Units.Velocity reference_velocity_1 "Slope of the demand until reference_end_1";
  input Units.Time reference_time_1 "Instant of reference_position_1";
  input Units.Time reference_end_1 "Instant from which the demand rests";
  input Boolean enabled_1(start = false) "Power stage on; off: no motor force";
  input Units.Force force_limit_1(start = 1e9, min = 0)
    "Further limit of the motor force, both directions";
  input Units.Force force_limit_positive_1(start = 1e9, min = 0)
    "Further limit of the motor force, positive direction";
  input Units.Force force_limit_negative_1(start = 1e9, min = 0)
    "Further limit of the motor force, negative direction, as an amount";
  input Integer control_1(start = 0, min = 0, max = 2)
    "What is controlled; 0: position, 1: velocity, 2: force";
  input Units.Acceleration reference_acceleration_1
    "Velocity control: the demand is reference_velocity + this*(min(t, end) - time)";
  input Units.Force reference_force_1 "Control of the force: demand";
  input Units.Position reference_position_2 "Demand at reference_time_2";
  input Units.Velocity reference_velocity_2 "Slope of the demand until reference_end_2";
  input Units.Time reference_time_2 "Instant of reference_position_2";
  input Units.Time reference_end_2 "Instant from which the demand rests";
  input Boolean enabled_2(start = false) "Power stage on; off: no motor force";
  input Units.Force force_limit_2(start = 1e9, min = 0)
    "Further limit of the motor force, both directions";
  input Units.Force force_limit_positive_2(start = 1e9, min = 0)
    "Further limit of the motor force, positive direction";
  input Units.Force force_limit_negative_2(start = 1e9, min = 0)
    "Further limit of the motor force, negative direction, as an amount";
  input Integer control_2(start = 0, min = 0, max = 2)
    "What is controlled; 0: position, 1: velocity, 2: force";
  input Units.Acceleration reference_acceleration_2
    "Velocity control: the demand is reference_velocity + this*(min(t, end) - time)";
  input Units.Force reference_force_2 "Control of the force: demand";

  parameter Units.Position position_start = 0 "Position of both sides at the start";
  parameter Units.Rate kv(min = 0) = 10 "Gain of the position loops";
  parameter Units.Share feed_forward = 0 "Share of velocity feed-forward";
  parameter Units.Frequency velocity_bandwidth = 40
    "Bandwidth of the velocity loops, sets their gain";
  parameter Units.Time velocity_integral_time(min = 1e-5) = 12e-3
    "Integral time of the velocity loops";
  parameter Units.Time anti_windup_time(min = 1e-5) = 12e-3
    "Back-calculation time of the velocity loops";
  parameter Units.Frequency current_bandwidth(min = 1) = 800 "Bandwidth of the current loops";
  parameter Units.Force force_limit_motor(min = 0) = 4000
    "Largest force of each motor, in terms of the slide";
  parameter Units.Mass carriage_mass(min = 1e-3) = 60 "Each carriage between screw and beam";
  parameter Units.Inertia rotor_inertia = 6e-4 "Each motor with coupling and screw";
  parameter Units.Length screw_lead(min = 1e-4) = 0.02 "Travel per revolution";
  parameter Units.Mass beam_mass(min = 1e-3) = 400 "Beam with what it carries";
  parameter Units.Inertia beam_inertia(min = 1e-6) = 150
    "About the vertical through the centre of mass";
  parameter Units.Length span(min = 1e-3) = 2 "Between both guideways";
  parameter Units.Position mass_offset = 0
    "Centre of mass from the middle, towards the first guideway";
  parameter Units.Stiffness coupling_stiffness = 150e6 "Between each carriage and the beam";
  parameter Units.Damping coupling_damping = 20e3 "Between each carriage and the beam";
  parameter Units.Position stop_position_1 = 1e3
    "Fixed stop of the first side; the default lies out of reach";
  parameter Integer stop_direction_1(min = -1, max = 1) = 1
    "1: this stop is met in positive direction, -1: in negative direction";
  parameter Units.Velocity stop_speed_1(min = -1, max = 1) = 0
    "Of the stop of the first side from stop_begin_1 to stop_end_1; 0: it stands";
  parameter Units.Time stop_begin_1 = 0 "When this stop begins to move";
  parameter Units.Time stop_end_1 = 0 "When it stands again";
  parameter Units.Position stop_position_2 = 1e3 "Fixed stop of the second side";
  parameter Integer stop_direction_2(min = -1, max = 1) = 1
    "1: this stop is met in positive direction, -1: in negative direction";
  parameter Units.Velocity stop_speed_2(min = -1, max = 1) = 0
    "Of the stop of the second side from stop_begin_2 to stop_end_2; 0: it stands";
  parameter Units.Time stop_begin_2 = 0 "When this stop begins to move";
  parameter Units.Time stop_end_2 = 0 "When it stands again";
  parameter Units.Stiffness stop_stiffness = 20e6 "Stiffness of each stop";
  parameter Units.ContactDamping stop_damping = 20
    "Share of the stop's spring force per velocity";
  final parameter Units.Mass drive_mass = carriage_mass + rotor_inertia*(2*pi/screw_lead)^2
    "Each carriage and its rotating parts";
  final parameter Units.Damping velocity_gain = 2*pi*velocity_bandwidth*(drive_mass + beam_mass/2)
    "Proportional gain of the velocity loops";

  output Units.Position position_1 "First end of the beam (truth)";
  output Units.Velocity velocity_1 "Velocity of the first end";
  output Units.Position motor_position_1 "Motor encoder of the first side";
  output Units.Velocity motor_velocity_1 "Velocity of the motor encoder of the first side";
  output Units.Position demand_position_1 "Position demand of the first side";
  output Units.Force force_1 "Motor force of the first side";
  output Units.Force stop_force_1 "Force between beam and stop, first side";
  output Units.Position stop_face_1 "Where the stop of the first side is touched now";
  output Units.Position position_2 "Second end of the beam (truth)";
  output Units.Velocity velocity_2 "Velocity of the second end";
  output Units.Position motor_position_2 "Motor encoder of the second side";
  output Units.Velocity motor_velocity_2 "Velocity of the motor encoder of the second side";
  output Units.Position demand_position_2 "Position demand of the second side";
  output Units.Force force_2 "Motor force of the second side";
  output Units.Force stop_force_2 "Force between beam and stop, second side";
  output Units.Position stop_face_2 "Where the stop of the second side is touched now";
  output Units.Position skew "How far the first end of the beam is ahead";
protected
  constant Real pi = 3.141592653589793;
  DriveCascade drive_1(
    kv = kv,
    feed_forward = feed_forward,
    velocity_gain = velocity_gain,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = force_limit_motor);
  DriveCascade drive_2(
    kv = kv,
    feed_forward = feed_forward,
    velocity_gain = velocity_gain,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = force_limit_motor);
  Mechanics.Slide carriage_1(mass = drive_mass, position_start = position_start);
  Mechanics.Slide carriage_2(mass = drive_mass, position_start = position_start);
  Mechanics.LuGreFriction friction_1;
  Mechanics.LuGreFriction friction_2;
  Mechanics.ElasticJoint coupling_1(stiffness = coupling_stiffness, damping = coupling_damping);
  Mechanics.ElasticJoint coupling_2(stiffness = coupling_stiffness, damping = coupling_damping);
  Mechanics.CrossBeam beam(
    mass = beam_mass,
    inertia = beam_inertia,
    span = span,
    offset = mass_offset,
    position_start = position_start);
  Mechanics.FixedStop stop_1(
    stop_position = stop_position_1,
    stop_direction = stop_direction_1,
    stop_speed = stop_speed_1,
    stop_begin = stop_begin_1,
    stop_end = stop_end_1,
    stiffness = stop_stiffness,
    damping = stop_damping);
  Mechanics.FixedStop stop_2(
    stop_position = stop_position_2,
    stop_direction = stop_direction_2,
    stop_speed = stop_speed_2,
    stop_begin = stop_begin_2,
    stop_end = stop_end_2,
    stiffness = stop_stiffness,
    damping = stop_damping);
equation
  drive_1.reference_position = reference_position_1;
  drive_1.reference_velocity = reference_velocity_1;
  drive_1.reference_time = reference_time_1;
  drive_1.reference_end = reference_end_1;
  drive_1.enabled = enabled_1;
  drive_1.force_limit = force_limit_1;
  drive_1.force_limit_positive = force_limit_positive_1;
  drive_1.force_limit_negative = force_limit_negative_1;
  drive_1.control = control_1;
  drive_1.reference_acceleration = reference_acceleration_1;
  drive_1.reference_force = reference_force_1;
  drive_2.reference_position = reference_position_2;
  drive_2.reference_velocity = reference_velocity_2;
  drive_2.reference_time = reference_time_2;
  drive_2.reference_end = reference_end_2;
  drive_2.enabled = enabled_2;
  drive_2.force_limit = force_limit_2;
  drive_2.force_limit_positive = force_limit_positive_2;
  drive_2.force_limit_negative = force_limit_negative_2;
  drive_2.control = control_2;
  drive_2.reference_acceleration = reference_acceleration_2;
  drive_2.reference_force = reference_force_2;
  connect(drive_1.flange, carriage_1.flange);
  connect(friction_1.flange, carriage_1.flange);
  connect(carriage_1.flange, coupling_1.flange_a);
  connect(coupling_1.flange_b, beam.flange_1);
  connect(stop_1.flange, beam.flange_1);
  connect(drive_2.flange, carriage_2.flange);
  connect(friction_2.flange, carriage_2.flange);
  connect(carriage_2.flange, coupling_2.flange_a);
  connect(coupling_2.flange_b, beam.flange_2);
  connect(stop_2.flange, beam.flange_2);
  position_1 = beam.flange_1.s;
  velocity_1 = der(beam.flange_1.s);
  motor_position_1 = carriage_1.position;
  motor_velocity_1 = carriage_1.velocity;
  demand_position_1 = drive_1.demand_position;
  force_1 = drive_1.force;
  stop_force_1 = stop_1.force;
  stop_face_1 = stop_1.face;
  position_2 = beam.flange_2.s;
  velocity_2 = der(beam.flange_2.s);
  motor_position_2 = carriage_2.position;
  motor_velocity_2 = carriage_2.velocity;
  demand_position_2 = drive_2.demand_position;
  force_2 = drive_2.force;
  stop_force_2 = stop_2.force;
  stop_face_2 = stop_2.face;
  skew = position_1 - position_2;
  annotation(
    Documentation(info="<html>
<p>Equations: two cascades as in ServoAxis, each with a carriage (mass and rotor), LuGre friction
and an elastic joint to one end of CrossBeam. The encoders sit on the motors, position_1 and
position_2 are the ends of the beam, skew is their difference.</p>
<p>With both drives at the same demand a centre of mass off the middle gives a skew only while the
speed changes; a difference of the demands gives the same skew at rest.</p>
<p>Assumptions: rigid beam, small yaw. Limits: no bending, no guideway forces across. The numbers
are chosen, not measured. Source: the parts.</p>
</html>"));
end GantryPair;
