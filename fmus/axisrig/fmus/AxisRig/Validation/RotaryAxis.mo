within AxisRig.Validation;
model RotaryAxis "Rotary axis with imbalance: steady lag, contact, saturation, release, stick"
  extends Icons.Experiment;
  parameter Units.AngularVelocity feed = 0.4 "Forward"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Angle position_start = 1e-3 "Angle at the start"
    annotation(Dialog(group = "Start"));
  parameter Units.Rate kv = 20 "Gain of the position loop"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Share feed_forward = 0.3 "Share of velocity feed-forward"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Frequency velocity_bandwidth = 60 "Bandwidth of the velocity loop, sets its gain"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time velocity_integral_time = 8e-3 "Integral time of the velocity loop"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time anti_windup_time = 6e-3 "Back-calculation time of the velocity loop"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Frequency current_bandwidth = 800 "Bandwidth of the current loop"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Torque torque_limit_motor = 60 "Largest torque at the table"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Inertia inertia = 0.5 "Table with what it carries"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia rotor_inertia = 1.8e-4 "Motor and coupling"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Ratio gear_ratio = 60 "Turns of the motor per turn of the table"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Torque imbalance = 5 "Weight times distance of the centre of mass"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Torque coulomb_friction = 8 "Coulomb friction"
    annotation(Dialog(group = "Friction"));
  parameter Units.Torque breakaway_friction = 11 "Breakaway torque"
    annotation(Dialog(group = "Friction"));
  parameter Units.AngularVelocity stribeck_velocity = 0.01
    "Angular velocity over which breakaway falls to Coulomb"
    annotation(Dialog(group = "Friction"));
  parameter Units.TorsionalDamping viscous_friction = 5 "Viscous friction"
    annotation(Dialog(group = "Friction"));
  parameter Units.TorsionalStiffness bristle_stiffness = 5e5 "Stiffness while it sticks"
    annotation(Dialog(group = "Friction"));
  parameter Units.TorsionalDamping bristle_damping = 200 "Damping while it sticks"
    annotation(Dialog(group = "Friction"));
  parameter Units.Angle stop_position = 0.15 "Fixed stop; the default lies out of reach"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.TorsionalStiffness stop_stiffness = 1e6 "Stiffness of the stop"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.TorsionalContactDamping stop_damping = 1
    "Share of the stop's spring torque per angular velocity"
    annotation(Dialog(group = "Fixed stop"));
  Drives.RotaryAxis axis(
    position_start = position_start,
    kv = kv,
    feed_forward = feed_forward,
    velocity_bandwidth = velocity_bandwidth,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    torque_limit_motor = torque_limit_motor,
    inertia = inertia,
    rotor_inertia = rotor_inertia,
    gear_ratio = gear_ratio,
    imbalance = imbalance,
    coulomb_friction = coulomb_friction,
    breakaway_friction = breakaway_friction,
    stribeck_velocity = stribeck_velocity,
    viscous_friction = viscous_friction,
    bristle_stiffness = bristle_stiffness,
    bristle_damping = bristle_damping,
    stop_position = stop_position,
    stop_stiffness = stop_stiffness,
    stop_damping = stop_damping)
    "Axis under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
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
  axis.force_limit_positive = 1e9;
  axis.force_limit_negative = 1e9;
  axis.control = 0;
  axis.reference_acceleration = 0;
  axis.reference_force = 0;
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
