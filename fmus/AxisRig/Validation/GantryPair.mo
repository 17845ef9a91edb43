within AxisRig.Validation;
model GantryPair "Gantry with its centre of mass off the middle; one side meets a stop"
  Drives.GantryPair axis(
    position_start = 1e-4,
    kv = 20,
    feed_forward = 0.3,
    velocity_bandwidth = 40,
    velocity_integral_time = 12e-3,
    anti_windup_time = 9e-3,
    current_bandwidth = 800,
    force_limit_motor = 900,
    carriage_mass = 60,
    rotor_inertia = 6e-4,
    screw_lead = 0.02,
    beam_mass = 400,
    beam_inertia = 150,
    span = 2,
    mass_offset = 0.2,
    coupling_stiffness = 150e6,
    coupling_damping = 20e3,
    stop_position_1 = 0.016,
    stop_position_2 = 0.0165,
    stop_stiffness = 20e6,
    stop_damping = 20);
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
  axis.reference_position_2 = if time < 0.7 then 1e-4 else 0.015;
  axis.reference_velocity_2 = if time < 0.7 then 0.04 else -0.03;
  axis.reference_time_2 = if time < 0.7 then 0 else 0.7;
  axis.reference_end_2 = if time < 0.7 then 0.5 else 1;
  axis.enabled_2 = true;
  axis.force_limit_2 = 800;
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
