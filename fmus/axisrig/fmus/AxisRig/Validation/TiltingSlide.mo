within AxisRig.Validation;
model TiltingSlide "Slide and tilting axis press on a stop of the tool in turn, and leave it"
  extends Icons.Experiment;
  Drives.TiltingSlide axis(
    position_start_z = 0.2,
    position_start_a = -0.6,
    kv = 20,
    feed_forward = 0.3,
    velocity_integral_time = 8e-3,
    anti_windup_time = 6e-3,
    force_limit_motor_z = 450,
    torque_limit_motor_a = 40,
    lever = 0.18,
    stop_position = 0.04)
    "Axes under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position position_z "Slide";
  output Units.Velocity velocity_z "Slide";
  output Units.Angle position_a "A";
  output Units.AngularVelocity velocity_a "A";
  output Units.Force force_z "Motor of the slide";
  output Units.Torque force_a "Motor of A";
  output Units.Force stop_force_z "Stop, at the slide";
  output Units.Torque stop_force_a "Stop, at A";
  output Units.Position stop_face_z "Where the slide is when the tool touches";
  output Units.Position tip "End of the tool";
equation
  axis.reference_position_z = if time < 0.6 then 0.2 else 0.185;
  axis.reference_velocity_z = if time < 0.6 then -0.04 else 0.03;
  axis.reference_time_z = if time < 0.6 then 0 else 0.6;
  axis.reference_end_z = if time < 0.6 then 0.5 else 0.9;
  axis.enabled_z = true;
  axis.force_limit_z = 1e9;
  axis.force_limit_positive_z = 1e9;
  axis.force_limit_negative_z = 1e9;
  axis.control_z = 0;
  axis.reference_acceleration_z = 0;
  axis.reference_force_z = 0;
  axis.reference_position_a = -0.6;
  axis.reference_velocity_a = 0.4;
  axis.reference_time_a = 0;
  axis.reference_end_a = 0.45;
  axis.enabled_a = true;
  axis.force_limit_a = 1e9;
  axis.force_limit_positive_a = 1e9;
  axis.force_limit_negative_a = 1e9;
  axis.control_a = 0;
  axis.reference_acceleration_a = 0;
  axis.reference_force_a = 0;
  position_z = axis.position_z;
  velocity_z = axis.velocity_z;
  position_a = axis.position_a;
  velocity_a = axis.velocity_a;
  force_z = axis.force_z;
  force_a = axis.force_a;
  stop_force_z = axis.stop_force_z;
  stop_force_a = axis.stop_force_a;
  stop_face_z = axis.stop_face_z;
  tip = axis.tip;
  annotation(
    experiment(StopTime=1, Interval=0.004),
    Documentation(info="<html>
<p>The slide goes down while A straightens the lever. First the torque of A is the weaker one, then the force of
the slide; at last the slide goes up again. Compared: motion, motors, force and torque of the stop.</p>
</html>"));
end TiltingSlide;
