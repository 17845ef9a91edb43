within AxisRig.Validation;
model GravityAxis "Vertical axis: brake opens, contact, release, brake catches it, brake opened by hand"
  Examples.Course course;
  Drives.GravityAxis axis(
    position_start = 1e-4,
    kv = 20,
    feed_forward = 0.3,
    velocity_bandwidth = 60,
    velocity_integral_time = 8e-3,
    anti_windup_time = 6e-3,
    current_bandwidth = 800,
    force_limit_motor = 550,
    mass = 120,
    rotor_inertia = 1.8e-4,
    screw_lead = 0.01,
    stop_position = 0.015,
    stop_stiffness = 20e6,
    stop_damping = 20,
    counterbalance = 877,
    brake_opening_time = 60e-3,
    brake_closing_time = 20e-3,
    brake_force = 2000,
    brake_stiffness = 100e6);
  output Units.Position position "Slide";
  output Units.Velocity velocity "Slide";
  output Units.Position motor_position "Motor encoder";
  output Units.Force force "Motor force";
  output Units.Force stop_force "Force of the stop";
  output Boolean brake_open "The brake has no force";
equation
  axis.brake_released = time > 1.9;
  axis.reference_position = course.reference_position;
  axis.reference_velocity = course.reference_velocity;
  axis.reference_time = course.reference_time;
  axis.reference_end = course.reference_end;
  axis.enabled = course.enabled;
  axis.force_limit = course.force_limit;
  position = axis.position;
  velocity = axis.velocity;
  motor_position = axis.motor_position;
  force = axis.force;
  stop_force = axis.stop_force;
  brake_open = axis.brake_open;
  annotation(
    experiment(StopTime=2, Interval=0.0051),
    Documentation(info="<html>
<p>Course with contact at the force limit, release, stick and power off, 2 s; the brake is released by
hand at 1.9 s.</p>
</html>"));
end GravityAxis;
