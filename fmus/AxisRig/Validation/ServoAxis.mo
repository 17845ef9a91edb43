within AxisRig.Validation;
model ServoAxis "Rigid axis: contact, saturation, release, stick, power off"
  Examples.Course course;
  Drives.ServoAxis axis(
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
    weight = 60,
    coulomb_friction = 120,
    breakaway_friction = 160,
    stribeck_velocity = 5e-3,
    viscous_friction = 800,
    friction_slope_velocity = 1e-4);
  output Units.Position position "Slide";
  output Units.Velocity velocity "Slide";
  output Units.Position motor_position "Motor encoder";
  output Units.Force force "Motor force";
  output Units.Force stop_force "Force of the stop";
equation
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
  annotation(
    experiment(StopTime=2, Interval=0.005),
    Documentation(info="<html>
<p>Course with contact at the force limit, release, stick and power off, 2 s.</p>
</html>"));
end ServoAxis;
