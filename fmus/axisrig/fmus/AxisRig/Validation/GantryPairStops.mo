within AxisRig.Validation;
model GantryPairStops "Gantry whose ends meet moving stops, one in each direction"
  extends Icons.Experiment;
  Drives.GantryPair axis(
    kv = 20,
    feed_forward = 0.3,
    velocity_integral_time = 12e-3,
    anti_windup_time = 9e-3,
    force_limit_motor = 900,
    mass_offset = 0.2,
    stop_position_1 = -3e-3,
    stop_direction_1 = -1,
    stop_speed_1 = -0.02,
    stop_begin_1 = 0.22,
    stop_end_1 = 0.31,
    stop_position_2 = 9e-3,
    stop_speed_2 = -0.045,
    stop_begin_2 = 0.06,
    stop_end_2 = 0.38)
    "Axis under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position position_1 "First end of the beam";
  output Units.Position position_2 "Second end of the beam";
  output Units.Force force_1 "First motor";
  output Units.Force force_2 "Second motor";
  output Units.Force stop_force_1 "First stop";
  output Units.Force stop_force_2 "Second stop";
  output Units.Position stop_face_1 "Where the first stop is touched";
  output Units.Position stop_face_2 "Where the second stop is touched";
equation
  axis.reference_position_1 = 0;
  axis.reference_velocity_1 = -0.02;
  axis.reference_time_1 = 0;
  axis.reference_end_1 = 0.2;
  axis.enabled_1 = true;
  axis.force_limit_1 = 700;
  axis.force_limit_positive_1 = 1e9;
  axis.force_limit_negative_1 = 1e9;
  axis.control_1 = 0;
  axis.reference_acceleration_1 = 0;
  axis.reference_force_1 = 0;
  axis.reference_position_2 = 0;
  axis.reference_velocity_2 = -0.02;
  axis.reference_time_2 = 0;
  axis.reference_end_2 = 0.2;
  axis.enabled_2 = true;
  axis.force_limit_2 = 1e9;
  axis.force_limit_positive_2 = 1e9;
  axis.force_limit_negative_2 = 1e9;
  axis.control_2 = 0;
  axis.reference_acceleration_2 = 0;
  axis.reference_force_2 = 0;
  position_1 = axis.position_1;
  position_2 = axis.position_2;
  force_1 = axis.force_1;
  force_2 = axis.force_2;
  stop_force_1 = axis.stop_force_1;
  stop_force_2 = axis.stop_force_2;
  stop_face_1 = axis.stop_face_1;
  stop_face_2 = axis.stop_face_2;
  annotation(
    experiment(StopTime=0.5, Interval=0.0025),
    Documentation(info="<html>
<p>Both sides run 4 mm backward. The first end meets its stop, which then yields; the stop of the
second comes from ahead and pushes it further. Compared: ends, forces, places of the stops.</p>
</html>"));
end GantryPairStops;
