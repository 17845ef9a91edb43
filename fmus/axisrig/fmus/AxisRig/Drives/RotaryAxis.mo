within AxisRig.Drives;
model RotaryAxis "Rotary table with drive cascade, friction, imbalance and a fixed stop"
  Interfaces.AngleInput reference_position "Demand at reference_time"
    annotation(Placement(transformation(extent = {{-116, 82}, {-100, 98}})));
  Interfaces.AngularVelocityInput reference_velocity "Slope of the demand until reference_end"
    annotation(Placement(transformation(extent = {{-116, 64}, {-100, 80}})));
  Interfaces.TimeInput reference_time "Instant of reference_position"
    annotation(Placement(transformation(extent = {{-116, 46}, {-100, 62}})));
  Interfaces.TimeInput reference_end "Instant from which the demand rests"
    annotation(Placement(transformation(extent = {{-116, 28}, {-100, 44}})));
  Interfaces.BooleanInput enabled(start = false) "Power stage on; off: no motor torque"
    annotation(Placement(transformation(extent = {{-116, 10}, {-100, 26}})));
  Interfaces.TorqueInput force_limit(start = 1e9, min = 0)
    "Further limit of the motor torque, both directions"
    annotation(Placement(transformation(extent = {{-116, -8}, {-100, 8}})));
  Interfaces.TorqueInput force_limit_positive(start = 1e9, min = 0)
    "Further limit of the motor torque, positive direction"
    annotation(Placement(transformation(extent = {{-116, -26}, {-100, -10}})));
  Interfaces.TorqueInput force_limit_negative(start = 1e9, min = 0)
    "Further limit of the motor torque, negative direction, as an amount"
    annotation(Placement(transformation(extent = {{-116, -44}, {-100, -28}})));
  Interfaces.IntegerInput control(start = 0, min = 0, max = 2)
    "What is controlled; 0: position, 1: velocity, 2: torque"
    annotation(Placement(transformation(extent = {{-116, -62}, {-100, -46}})));
  Interfaces.AngularAccelerationInput reference_acceleration
    "Velocity control: the demand is reference_velocity + this*(min(t, end) - time)"
    annotation(Placement(transformation(extent = {{-116, -80}, {-100, -64}})));
  Interfaces.TorqueInput reference_force "Control of the torque: demand"
    annotation(Placement(transformation(extent = {{-116, -98}, {-100, -82}})));

  parameter Units.Angle position_start = 0 "Angle at the start"
    annotation(Dialog(group = "Start"));
  parameter Units.Rate kv(min = 0) = 10 "Gain of the position loop"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Share feed_forward = 0 "Share of velocity feed-forward"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Frequency velocity_bandwidth = 60
    "Bandwidth of the velocity loop, sets its gain"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time velocity_integral_time(min = 1e-5) = 8e-3
    "Integral time of the velocity loop"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time anti_windup_time(min = 1e-5) = 8e-3
    "Back-calculation time of the velocity loop"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Frequency current_bandwidth(min = 1) = 800 "Bandwidth of the current loop"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Torque torque_limit_motor(min = 0) = 300 "Largest torque at the table"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Inertia inertia(min = 1e-6) = 0.5 "Table with what it carries"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia rotor_inertia = 1.8e-4 "Motor and coupling"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Ratio gear_ratio = 60 "Turns of the motor per turn of the table"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Torque imbalance = 0 "Weight times distance of the centre of mass"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Torque coulomb_friction(min = 0) = 8 "Coulomb friction"
    annotation(Dialog(group = "Friction"));
  parameter Units.Torque breakaway_friction(min = 0) = 11 "Breakaway torque"
    annotation(Dialog(group = "Friction"));
  parameter Units.AngularVelocity stribeck_velocity(min = 1e-6) = 0.01
    "Angular velocity over which breakaway falls to Coulomb"
    annotation(Dialog(group = "Friction"));
  parameter Units.TorsionalDamping viscous_friction = 5 "Viscous friction"
    annotation(Dialog(group = "Friction"));
  parameter Units.TorsionalStiffness bristle_stiffness = 5e5 "Stiffness while it sticks"
    annotation(Dialog(group = "Friction"));
  parameter Units.TorsionalDamping bristle_damping = 200 "Damping while it sticks"
    annotation(Dialog(group = "Friction"));
  parameter Units.Angle stop_position = 1e3 "Fixed stop; the default lies out of reach"
    annotation(Dialog(group = "Fixed stop"));
  parameter Integer stop_direction(min = -1, max = 1) = 1
    "1: the stop is met in positive direction, -1: in negative direction"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.AngularVelocity stop_speed(min = -1, max = 1) = 0
    "Of the stop from stop_begin to stop_end; 0: it is at rest"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Time stop_begin = 0 "When the stop begins to move"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Time stop_end = 0 "When it is at rest again"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.TorsionalStiffness stop_stiffness = 1e6 "Stiffness of the stop"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.TorsionalContactDamping stop_damping = 1
    "Share of the stop's spring torque per angular velocity"
    annotation(Dialog(group = "Fixed stop"));
  final parameter Units.Inertia effective_inertia = inertia + rotor_inertia*gear_ratio^2
    "Table and motor, at the table";
  final parameter Units.TorsionalDamping velocity_gain
    = 2*Constants.pi*velocity_bandwidth*effective_inertia
    "Proportional gain of the velocity loop";

  Interfaces.AngleOutput position "Angle of the table (truth)"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.AngularVelocityOutput velocity "Angular velocity of the table (truth)"
    annotation(Placement(transformation(extent = {{100, 54}, {120, 74}})));
  Interfaces.AngleOutput motor_position "Motor encoder, in terms of the table"
    annotation(Placement(transformation(extent = {{100, 29}, {120, 49}})));
  Interfaces.AngularVelocityOutput motor_velocity "Velocity of the motor encoder, at the table"
    annotation(Placement(transformation(extent = {{100, 3}, {120, 23}})));
  Interfaces.AngleOutput demand_position "Demand"
    annotation(Placement(transformation(extent = {{100, -23}, {120, -3}})));
  Interfaces.TorqueOutput force "Motor torque at the table"
    annotation(Placement(transformation(extent = {{100, -49}, {120, -29}})));
  Interfaces.TorqueOutput stop_force "Torque between table and stop"
    annotation(Placement(transformation(extent = {{100, -74}, {120, -54}})));
  Interfaces.AngleOutput stop_face "Where the stop is touched now (truth)"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  constant Units.Length arm = 1 "Radius at which the linear parts act";
  DriveCascade drive(
    kv = kv,
    feed_forward = feed_forward,
    velocity_gain = velocity_gain/arm^2,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = torque_limit_motor/arm)
    "Drive"
    annotation(Placement(transformation(extent = {{-72, 21}, {-34, 59}})));
  Mechanics.Slide rim(mass = effective_inertia/arm^2, position_start = position_start*arm)
    "Rotating mass at a radius of 1 m"
    annotation(Placement(transformation(extent = {{-19, 21}, {19, 59}})));
  Mechanics.LuGreFriction friction(
    coulomb = coulomb_friction/arm,
    breakaway = breakaway_friction/arm,
    stribeck = stribeck_velocity*arm,
    viscous = viscous_friction/arm^2,
    bristle_stiffness = bristle_stiffness/arm^2,
    bristle_damping = bristle_damping/arm^2)
    "Friction of the guideway"
    annotation(Placement(transformation(extent = {{34, 21}, {72, 59}})));
  Mechanics.FixedStop stop(
    stop_position = stop_position*arm,
    stop_direction = stop_direction,
    stop_speed = stop_speed*arm,
    stop_begin = stop_begin,
    stop_end = stop_end,
    stiffness = stop_stiffness/arm^2,
    damping = stop_damping/arm)
    "Fixed stop"
    annotation(Placement(transformation(extent = {{-72, -59}, {-34, -21}})));
  Mechanics.Load load "Of the imbalance"
    annotation(Placement(transformation(extent = {{-19, -59}, {19, -21}})));
equation
  drive.reference_position = reference_position*arm;
  drive.reference_velocity = reference_velocity*arm;
  connect(reference_time, drive.reference_time)
    annotation(Line(points = {{-100, 54}, {-87, 54}, {-87, 50}, {-74, 50}}, color = {0, 0, 127}));
  connect(reference_end, drive.reference_end)
    annotation(Line(points = {{-100, 36}, {-87, 36}, {-87, 47}, {-74, 47}}, color = {0, 0, 127}));
  drive.enabled = enabled;
  drive.force_limit = force_limit/arm;
  drive.force_limit_positive = force_limit_positive/arm;
  drive.force_limit_negative = force_limit_negative/arm;
  drive.control = control;
  drive.reference_acceleration = reference_acceleration*arm;
  drive.reference_force = reference_force/arm;
  load.force = -imbalance/arm*sin(position);
  connect(drive.flange, rim.flange)
    annotation(Line(points = {{-53, 21}, {0, 21}}, color = {0, 127, 0}));
  connect(friction.flange, rim.flange)
    annotation(Line(points = {{53, 21}, {0, 21}}, color = {0, 127, 0}));
  connect(stop.flange, rim.flange)
    annotation(Line(points = {{-53, -59}, {-26, -59}, {-26, 21}, {0, 21}}, color = {0, 127, 0}));
  connect(load.flange, rim.flange)
    annotation(Line(points = {{0, -59}, {0, -59}, {0, 21}, {0, 21}}, color = {0, 127, 0}));
  position = rim.position/arm;
  velocity = rim.velocity/arm;
  motor_position = position;
  motor_velocity = velocity;
  demand_position = drive.demand_position/arm;
  force = drive.force*arm;
  stop_force = stop.force*arm;
  stop_face = stop.face/arm;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-60, -60}, {60, 60}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-10, -10}, {10, 10}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 0}, {42, 42}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equation: (I + J i^2) dw/dt = M_motor - M_friction - M_stop - M_u sin(phi). The parts are those
of a linear axis that act at a radius of 1 m, where a force in N is a torque in N.m.</p>
<p>Steady lag in motion with constant w: (1 - f) w/Kv.</p>
<p>Assumptions: rigid gear without play; the angle counts on over full turns. Limits: at zero the
centre of mass lies lowest; no modulo. Source: the parts.</p>
</html>"));
end RotaryAxis;
