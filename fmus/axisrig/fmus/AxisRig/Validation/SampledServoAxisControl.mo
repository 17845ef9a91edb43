within AxisRig.Validation;
model SampledServoAxisControl "Rigid axis in velocity, force and position control, unequal limits"
  Examples.ControlCourse course;
  Drives.SampledServoAxis axis(
    position_start = 1e-4,
    kv = 20,
    feed_forward = 0.3,
    anti_windup_time = 6e-3,
    force_limit_motor = 550,
    stop_position = 0.009,
    weight = 60);
  output Units.Position position "Slide";
  output Units.Velocity velocity "Slide";
  output Units.Position demand_position "Position demand, the motor encoder without one";
  output Units.Force force "Motor force";
  output Units.Force stop_force "Force of the stop";
equation
  axis.reference_position = course.reference_position;
  axis.reference_velocity = course.reference_velocity;
  axis.reference_time = course.reference_time;
  axis.reference_end = course.reference_end;
  axis.enabled = course.enabled;
  axis.force_limit = course.force_limit;
  axis.force_limit_positive = course.force_limit_positive;
  axis.force_limit_negative = course.force_limit_negative;
  axis.control = course.control;
  axis.reference_acceleration = course.reference_acceleration;
  axis.reference_force = course.reference_force;
  position = axis.position;
  velocity = axis.velocity;
  demand_position = axis.demand_position;
  force = axis.force;
  stop_force = axis.stop_force;
  annotation(
    experiment(StopTime=0.6, Interval=0.00101),
    Documentation(info="<html>
<p>Changes between the kinds of control at speed, contact with the stop under a demanded force, limits
of each direction.</p>
</html>"));
end SampledServoAxisControl;
