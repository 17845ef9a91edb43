within AxisRig.Validation;
model RotaryAxis "Rotary axis with imbalance: steady lag, contact, saturation, release, stick"
  parameter Units.AngularVelocity feed = 0.4 "Forward";
  Drives.RotaryAxis axis(
    position_start = 1e-3,
    kv = 20,
    feed_forward = 0.3,
    velocity_bandwidth = 60,
    velocity_integral_time = 8e-3,
    anti_windup_time = 6e-3,
    current_bandwidth = 800,
    torque_limit_motor = 60,
    inertia = 0.5,
    rotor_inertia = 1.8e-4,
    gear_ratio = 60,
    imbalance = 5,
    coulomb_friction = 8,
    breakaway_friction = 11,
    stribeck_velocity = 0.01,
    viscous_friction = 5,
    bristle_stiffness = 5e5,
    bristle_damping = 200,
    stop_position = 0.15,
    stop_stiffness = 1e6,
    stop_damping = 1);
  output Units.Angle position "Table";
  output Units.AngularVelocity velocity "Table";
  output Units.Angle demand_position "Demand";
  output Units.Torque force "Motor torque";
  output Units.Torque stop_force "Torque of the stop";
equation
  axis.reference_position = if time < 0.8 then 0 else 0.15;
  axis.reference_velocity = if time < 0.8 then feed else -0.3;
  axis.reference_time = if time < 0.8 then 0 else 0.8;
  axis.reference_end = if time < 0.8 then 0.5 else 1.2;
  axis.enabled = true;
  axis.force_limit = if time < 0.6 then 100 else 40;
  position = axis.position;
  velocity = axis.velocity;
  demand_position = axis.demand_position;
  force = axis.force;
  stop_force = axis.stop_force;
  annotation(
    experiment(StopTime=1.6, Interval=0.005),
    Documentation(info="<html>
<p>Forward into the stop at the torque limit, back and to rest.</p>
</html>"));
end RotaryAxis;
