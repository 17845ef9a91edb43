within AxisRig.Drives;
partial model PartialAxis "Inputs, outputs, drive and fixed stop of a linear axis"
  Interfaces.PositionInput reference_position "Demand at reference_time"
    annotation(Placement(transformation(extent = {{-116, 82}, {-100, 98}})));
  Interfaces.VelocityInput reference_velocity "Slope of the demand until reference_end"
    annotation(Placement(transformation(extent = {{-116, 64}, {-100, 80}})));
  Interfaces.TimeInput reference_time "Instant of reference_position"
    annotation(Placement(transformation(extent = {{-116, 46}, {-100, 62}})));
  Interfaces.TimeInput reference_end "Instant from which the demand rests"
    annotation(Placement(transformation(extent = {{-116, 28}, {-100, 44}})));
  Interfaces.BooleanInput enabled(start = false) "Power stage on; off: no motor force"
    annotation(Placement(transformation(extent = {{-116, 10}, {-100, 26}})));
  Interfaces.ForceInput force_limit(start = 1e9, min = 0)
    "Further limit of the motor force, both directions"
    annotation(Placement(transformation(extent = {{-116, -8}, {-100, 8}})));
  Interfaces.ForceInput force_limit_positive(start = 1e9, min = 0)
    "Further limit of the motor force, positive direction"
    annotation(Placement(transformation(extent = {{-116, -26}, {-100, -10}})));
  Interfaces.ForceInput force_limit_negative(start = 1e9, min = 0)
    "Further limit of the motor force, negative direction, as an amount"
    annotation(Placement(transformation(extent = {{-116, -44}, {-100, -28}})));
  Interfaces.IntegerInput control(start = 0, min = 0, max = 2)
    "What is controlled; 0: position, 1: velocity, 2: force"
    annotation(Placement(transformation(extent = {{-116, -62}, {-100, -46}})));
  Interfaces.AccelerationInput reference_acceleration
    "Velocity control: the demand is reference_velocity + this*(min(t, end) - time)"
    annotation(Placement(transformation(extent = {{-116, -80}, {-100, -64}})));
  Interfaces.ForceInput reference_force "Control of the force: demand"
    annotation(Placement(transformation(extent = {{-116, -98}, {-100, -82}})));

  parameter Units.Position position_start = 0 "Position at the start"
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
  parameter Units.Force force_limit_motor(min = 0) = 4000
    "Largest motor force, in terms of the slide"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Mass mass(min = 1e-3) = 120 "Slide with what it carries"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia rotor_inertia = 1.8e-4 "Motor, coupling and screw"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Length screw_lead(min = 1e-4) = 0.01 "Travel per revolution"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Position stop_position = 1e3 "Fixed stop; the default lies out of reach"
    annotation(Dialog(group = "Fixed stop"));
  parameter Integer stop_direction(min = -1, max = 1) = 1
    "1: the stop is met in positive direction, -1: in negative direction"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Velocity stop_speed(min = -1, max = 1) = 0
    "Of the stop from stop_begin to stop_end; 0: it is at rest"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Time stop_begin = 0 "When the stop begins to move"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Time stop_end = 0 "When it is at rest again"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Stiffness stop_stiffness = 20e6 "Stiffness of the stop"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Exponent stop_exponent = 1 "Power of its penetration; 1: straight"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.ContactDamping stop_damping = 20
    "Share of the stop's spring force per velocity"
    annotation(Dialog(group = "Fixed stop"));
  final parameter Units.Mass rotor_mass = rotor_inertia*(2*Constants.pi/screw_lead)^2
    "Rotating parts, in terms of the slide";
  final parameter Units.Mass effective_mass = mass + rotor_mass
    "Slide and rotating parts, in terms of the slide";
  final parameter Units.Damping velocity_gain = 2*Constants.pi*velocity_bandwidth*effective_mass
    "Proportional gain of the velocity loop";

  Interfaces.PositionOutput position "Position of the slide (truth)"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.VelocityOutput velocity "Velocity of the slide (truth)"
    annotation(Placement(transformation(extent = {{100, 54}, {120, 74}})));
  Interfaces.PositionOutput motor_position "Motor encoder, in terms of the slide"
    annotation(Placement(transformation(extent = {{100, 29}, {120, 49}})));
  Interfaces.VelocityOutput motor_velocity "Velocity of the motor encoder, in terms of the slide"
    annotation(Placement(transformation(extent = {{100, 3}, {120, 23}})));
  Interfaces.PositionOutput demand_position "Position demand"
    annotation(Placement(transformation(extent = {{100, -23}, {120, -3}})));
  Interfaces.ForceOutput force "Motor force on the slide"
    annotation(Placement(transformation(extent = {{100, -49}, {120, -29}})));
  Interfaces.ForceOutput stop_force "Force between slide and stop"
    annotation(Placement(transformation(extent = {{100, -74}, {120, -54}})));
  Interfaces.PositionOutput stop_face "Where the stop is touched now (truth)"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  replaceable DriveCascade drive(
    kv = kv,
    feed_forward = feed_forward,
    velocity_gain = velocity_gain,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = force_limit_motor)
    "Drive"
    annotation(Placement(transformation(extent = {{-60, 25}, {-20, 65}})))
    constrainedby PartialCascade(
      kv = kv,
      feed_forward = feed_forward,
      velocity_gain = velocity_gain,
      velocity_integral_time = velocity_integral_time,
      anti_windup_time = anti_windup_time,
      current_bandwidth = current_bandwidth,
      force_limit_motor = force_limit_motor);
  Mechanics.FixedStop stop(
    stop_position = stop_position,
    stop_direction = stop_direction,
    stop_speed = stop_speed,
    stop_begin = stop_begin,
    stop_end = stop_end,
    stiffness = stop_stiffness,
    exponent = stop_exponent,
    damping = stop_damping)
    "Fixed stop"
    annotation(Placement(transformation(extent = {{20, 25}, {60, 65}})));
equation
  connect(reference_position, drive.reference_position)
    annotation(Line(points = {{-100, 90}, {-81, 90}, {-81, 63}, {-62, 63}}, color = {0, 0, 127}));
  connect(reference_velocity, drive.reference_velocity)
    annotation(Line(points = {{-100, 72}, {-81, 72}, {-81, 59}, {-62, 59}}, color = {0, 0, 127}));
  connect(reference_time, drive.reference_time)
    annotation(Line(points = {{-100, 54}, {-81, 54}, {-81, 56}, {-62, 56}}, color = {0, 0, 127}));
  connect(reference_end, drive.reference_end)
    annotation(Line(points = {{-100, 36}, {-81, 36}, {-81, 52}, {-62, 52}}, color = {0, 0, 127}));
  drive.enabled = enabled;
  connect(force_limit, drive.force_limit)
    annotation(Line(points = {{-100, 0}, {-81, 0}, {-81, 45}, {-62, 45}}, color = {0, 0, 127}));
  connect(force_limit_positive, drive.force_limit_positive)
    annotation(Line(points = {{-100, -18}, {-81, -18}, {-81, 41}, {-62, 41}}, color = {0, 0, 127}));
  connect(force_limit_negative, drive.force_limit_negative)
    annotation(Line(points = {{-100, -36}, {-81, -36}, {-81, 38}, {-62, 38}}, color = {0, 0, 127}));
  drive.control = control;
  connect(reference_acceleration, drive.reference_acceleration)
    annotation(Line(points = {{-100, -72}, {-81, -72}, {-81, 31}, {-62, 31}}, color = {0, 0, 127}));
  connect(reference_force, drive.reference_force)
    annotation(Line(points = {{-100, -90}, {-81, -90}, {-81, 27}, {-62, 27}}, color = {0, 0, 127}));
  motor_position = drive.flange.s;
  motor_velocity = drive.motor_velocity;
  demand_position = drive.demand_position;
  force = drive.force;
  stop_force = stop.force;
  stop_face = stop.face;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-70, -40}, {70, -20}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-30, -20}, {30, 30}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{-70, -50}, {70, -50}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: m_eff = m + J (2 pi/h)^2 with the screw lead h; gain of the velocity loop
2 pi f_v m_eff. A model that extends this one adds what lies between motor and slide.</p>
<p>Assumption: one motor on one screw. Limit: without the parts of the extending model it is
incomplete. Source: H. Gross et al., Electrical Feed Drives in Automation.</p>
</html>"));
end PartialAxis;
