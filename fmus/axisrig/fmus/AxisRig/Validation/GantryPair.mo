within AxisRig.Validation;
model GantryPair "Gantry with its centre of mass off the middle; one side meets a stop"
  extends Icons.Experiment;
  parameter Units.Position position_start = 1e-4 "Position of both sides at the start"
    annotation(Dialog(group = "Start"));
  parameter Units.Rate kv = 20 "Gain of the position loops"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Share feed_forward = 0.3 "Share of velocity feed-forward"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Frequency velocity_bandwidth = 40
    "Bandwidth of the velocity loops, sets their gain"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time velocity_integral_time = 12e-3 "Integral time of the velocity loops"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time anti_windup_time = 9e-3 "Back-calculation time of the velocity loops"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Frequency current_bandwidth = 800 "Bandwidth of the current loops"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Force force_limit_motor = 900
    "Largest force of each motor, in terms of the slide"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Mass carriage_mass = 60 "Each carriage between screw and beam"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia rotor_inertia = 6e-4 "Each motor with coupling and screw"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Length screw_lead = 0.02 "Travel per revolution"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Mass beam_mass = 400 "Beam with what it carries"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia beam_inertia = 150 "About the vertical through the centre of mass"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Length span = 2 "Between both guideways"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Position mass_offset = 0.2
    "Centre of mass from the middle, towards the first guideway"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Stiffness coupling_stiffness = 150e6 "Between each carriage and the beam"
    annotation(Dialog(group = "Elastic parts"));
  parameter Units.Damping coupling_damping = 20e3 "Between each carriage and the beam"
    annotation(Dialog(group = "Elastic parts"));
  parameter Units.Position stop_position_1 = 0.016
    "Fixed stop of the first side, positive direction"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Position stop_position_2 = 0.0165 "Fixed stop of the second side"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Stiffness stop_stiffness = 20e6 "Stiffness of each stop"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.ContactDamping stop_damping = 20 "Share of the stop's spring force per velocity"
    annotation(Dialog(group = "Fixed stop"));
  Drives.GantryPair axis(
    position_start = position_start,
    kv = kv,
    feed_forward = feed_forward,
    velocity_bandwidth = velocity_bandwidth,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = force_limit_motor,
    carriage_mass = carriage_mass,
    rotor_inertia = rotor_inertia,
    screw_lead = screw_lead,
    beam_mass = beam_mass,
    beam_inertia = beam_inertia,
    span = span,
    mass_offset = mass_offset,
    coupling_stiffness = coupling_stiffness,
    coupling_damping = coupling_damping,
    stop_position_1 = stop_position_1,
    stop_position_2 = stop_position_2,
    stop_stiffness = stop_stiffness,
    stop_damping = stop_damping)
    "Axis under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position position_1 "First end of the beam";
  output Units.Position position_2 "Second end of the beam";
  output Units.Position motor_position_1 "First encoder";
  output Units.Position motor_position_2 "Second encoder";
  output Units.Velocity velocity_1 "First end of the beam";
  output Units.Position skew "First end minus second end";
  output Units.Force force_1 "First motor";
  output Units.Force force_2 "Second motor";
  output Units.Force stop_force_1 "First stop";
  output Units.Force stop_force_2 "Second stop";
equation
  axis.reference_position_1 = if time < 0.7 then 0 else 0.015;
  axis.reference_velocity_1 = if time < 0.7 then 0.04 else -0.03;
  axis.reference_time_1 = if time < 0.7 then 0 else 0.7;
  axis.reference_end_1 = if time < 0.7 then 0.5 else 1;
  axis.enabled_1 = true;
  axis.force_limit_1 = 1e9;
  axis.force_limit_positive_1 = 1e9;
  axis.force_limit_negative_1 = 1e9;
  axis.control_1 = 0;
  axis.reference_acceleration_1 = 0;
  axis.reference_force_1 = 0;
  axis.reference_position_2 = if time < 0.7 then 1e-4 else 0.015;
  axis.reference_velocity_2 = if time < 0.7 then 0.04 else -0.03;
  axis.reference_time_2 = if time < 0.7 then 0 else 0.7;
  axis.reference_end_2 = if time < 0.7 then 0.5 else 1;
  axis.enabled_2 = true;
  axis.force_limit_2 = 800;
  axis.force_limit_positive_2 = 1e9;
  axis.force_limit_negative_2 = 1e9;
  axis.control_2 = 0;
  axis.reference_acceleration_2 = 0;
  axis.reference_force_2 = 0;
  position_1 = axis.position_1;
  position_2 = axis.position_2;
  motor_position_1 = axis.motor_position_1;
  motor_position_2 = axis.motor_position_2;
  velocity_1 = axis.velocity_1;
  skew = axis.skew;
  force_1 = axis.force_1;
  force_2 = axis.force_2;
  stop_force_1 = axis.stop_force_1;
  stop_force_2 = axis.stop_force_2;
  annotation(
    experiment(StopTime=1.3, Interval=0.005),
    Documentation(info="<html>
<p>Forward into the stops, which lie 0.5 mm apart, at the force limits; back and to rest.</p>
</html>"));
end GantryPair;
