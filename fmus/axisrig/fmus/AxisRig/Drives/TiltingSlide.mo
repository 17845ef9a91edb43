within AxisRig.Drives;
model TiltingSlide "Vertical slide with a turning axis below it, whose tool meets a level stop"
  Interfaces.PositionInput reference_position_z "Demand at reference_time_z"
    annotation(Placement(transformation(extent = {{-106, 87}, {-100, 93}})));
  Interfaces.VelocityInput reference_velocity_z "Slope of the demand until reference_end_z"
    annotation(Placement(transformation(extent = {{-106, 78}, {-100, 84}})));
  Interfaces.TimeInput reference_time_z "Instant of reference_position_z"
    annotation(Placement(transformation(extent = {{-106, 70}, {-100, 76}})));
  Interfaces.TimeInput reference_end_z "Instant from which the demand rests"
    annotation(Placement(transformation(extent = {{-106, 61}, {-100, 67}})));
  Interfaces.BooleanInput enabled_z(start = false) "Power stage on; off: no motor force"
    annotation(Placement(transformation(extent = {{-106, 53}, {-100, 59}})));
  Interfaces.ForceInput force_limit_z(start = 1e9, min = 0)
    "Further limit of the motor force, both directions"
    annotation(Placement(transformation(extent = {{-106, 44}, {-100, 50}})));
  Interfaces.ForceInput force_limit_positive_z(start = 1e9, min = 0)
    "Further limit of the motor force, positive direction"
    annotation(Placement(transformation(extent = {{-106, 36}, {-100, 42}})));
  Interfaces.ForceInput force_limit_negative_z(start = 1e9, min = 0)
    "Further limit of the motor force, negative direction, as an amount"
    annotation(Placement(transformation(extent = {{-106, 27}, {-100, 33}})));
  Interfaces.IntegerInput control_z(start = 0, min = 0, max = 2)
    "What is controlled; 0: position, 1: velocity, 2: force"
    annotation(Placement(transformation(extent = {{-106, 18}, {-100, 24}})));
  Interfaces.AccelerationInput reference_acceleration_z
    "Velocity control: the demand is reference_velocity + this*(min(t, end) - time)"
    annotation(Placement(transformation(extent = {{-106, 10}, {-100, 16}})));
  Interfaces.ForceInput reference_force_z "Control of the force: demand"
    annotation(Placement(transformation(extent = {{-106, 1}, {-100, 7}})));
  Interfaces.AngleInput reference_position_a "Demand at reference_time_a"
    annotation(Placement(transformation(extent = {{-106, -7}, {-100, -1}})));
  Interfaces.AngularVelocityInput reference_velocity_a "Slope of the demand until reference_end_a"
    annotation(Placement(transformation(extent = {{-106, -16}, {-100, -10}})));
  Interfaces.TimeInput reference_time_a "Instant of reference_position_a"
    annotation(Placement(transformation(extent = {{-106, -24}, {-100, -18}})));
  Interfaces.TimeInput reference_end_a "Instant from which the demand rests"
    annotation(Placement(transformation(extent = {{-106, -33}, {-100, -27}})));
  Interfaces.BooleanInput enabled_a(start = false) "Power stage on; off: no motor torque"
    annotation(Placement(transformation(extent = {{-106, -42}, {-100, -36}})));
  Interfaces.TorqueInput force_limit_a(start = 1e9, min = 0)
    "Further limit of the motor torque, both directions"
    annotation(Placement(transformation(extent = {{-106, -50}, {-100, -44}})));
  Interfaces.TorqueInput force_limit_positive_a(start = 1e9, min = 0)
    "Further limit of the motor torque, positive direction"
    annotation(Placement(transformation(extent = {{-106, -59}, {-100, -53}})));
  Interfaces.TorqueInput force_limit_negative_a(start = 1e9, min = 0)
    "Further limit of the motor torque, negative direction, as an amount"
    annotation(Placement(transformation(extent = {{-106, -67}, {-100, -61}})));
  Interfaces.IntegerInput control_a(start = 0, min = 0, max = 2)
    "What is controlled; 0: position, 1: velocity, 2: torque"
    annotation(Placement(transformation(extent = {{-106, -76}, {-100, -70}})));
  Interfaces.AngularAccelerationInput reference_acceleration_a
    "Velocity control: the demand is reference_velocity + this*(min(t, end) - time)"
    annotation(Placement(transformation(extent = {{-106, -84}, {-100, -78}})));
  Interfaces.TorqueInput reference_force_a "Control of the torque: demand"
    annotation(Placement(transformation(extent = {{-106, -93}, {-100, -87}})));

  parameter Units.Position position_start_z = 0 "Position of the slide at the start"
    annotation(Dialog(group = "Start"));
  parameter Units.Angle position_start_a = 0 "Angle of A at the start"
    annotation(Dialog(group = "Start"));
  parameter Units.Rate kv(min = 0) = 10 "Gain of the position loops"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Share feed_forward = 0 "Share of velocity feed-forward"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Frequency velocity_bandwidth = 60
    "Bandwidth of the velocity loops, sets their gain"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time velocity_integral_time(min = 1e-5) = 8e-3
    "Integral time of the velocity loops"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time anti_windup_time(min = 1e-5) = 8e-3
    "Back-calculation time of the velocity loops"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Frequency current_bandwidth(min = 1) = 800 "Bandwidth of the current loops"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Force force_limit_motor_z(min = 0) = 4000 "Largest motor force of the slide"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Torque torque_limit_motor_a(min = 0) = 300 "Largest torque at A"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Mass mass(min = 1e-3) = 120 "Slide with all that it carries"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia rotor_inertia_z = 1.8e-4 "Motor, coupling and screw of the slide"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Length screw_lead_z(min = 1e-4) = 0.01 "Travel of the slide per revolution"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia inertia(min = 1e-6) = 0.5 "What turns with A, with the tool, about A"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia rotor_inertia_a = 1.8e-4 "Motor and coupling of A"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Ratio gear_ratio = 60 "Turns of the motor per turn of A"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Length lever = 0.18 "From A to the end of the tool"
    annotation(Dialog(group = "Tool"));
  parameter Units.Position stop_position = -1e3 "Height of the stop; the default lies out of reach"
    annotation(Dialog(group = "Fixed stop"));
  parameter Integer stop_direction_z(min = -1, max = 1) = -1
    "-1: the stop is met going down, 1: going up"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Stiffness stop_stiffness = 20e6 "Stiffness of the stop"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.ContactDamping stop_damping = 20 "Share of the stop's spring force per velocity"
    annotation(Dialog(group = "Fixed stop"));
  final parameter Units.Mass effective_mass_z
    = mass + rotor_inertia_z*(2*Constants.pi/screw_lead_z)^2
    "Slide and rotating parts, in terms of the slide";
  final parameter Units.Inertia effective_inertia_a = inertia + rotor_inertia_a*gear_ratio^2
    "What turns and its motor, at A";

  Interfaces.PositionOutput position_z "Position of the slide (truth)"
    annotation(Placement(transformation(extent = {{100, 85}, {110, 95}})));
  Interfaces.VelocityOutput velocity_z "Velocity of the slide (truth)"
    annotation(Placement(transformation(extent = {{100, 73}, {110, 83}})));
  Interfaces.PositionOutput motor_position_z "Motor encoder of the slide"
    annotation(Placement(transformation(extent = {{100, 61}, {110, 71}})));
  Interfaces.VelocityOutput motor_velocity_z "Velocity of the motor encoder of the slide"
    annotation(Placement(transformation(extent = {{100, 49}, {110, 59}})));
  Interfaces.PositionOutput demand_position_z "Position demand of the slide"
    annotation(Placement(transformation(extent = {{100, 38}, {110, 48}})));
  Interfaces.ForceOutput force_z "Motor force on the slide"
    annotation(Placement(transformation(extent = {{100, 26}, {110, 36}})));
  Interfaces.ForceOutput stop_force_z "Force between tool and stop, as the slide has it"
    annotation(Placement(transformation(extent = {{100, 14}, {110, 24}})));
  Interfaces.PositionOutput stop_face_z "Where the slide is when the tool touches, with A as it is"
    annotation(Placement(transformation(extent = {{100, 2}, {110, 12}})));
  Interfaces.AngleOutput position_a "Angle of A (truth)"
    annotation(Placement(transformation(extent = {{100, -10}, {110, 0}})));
  Interfaces.AngularVelocityOutput velocity_a "Angular velocity of A (truth)"
    annotation(Placement(transformation(extent = {{100, -22}, {110, -12}})));
  Interfaces.AngleOutput motor_position_a "Motor encoder of A"
    annotation(Placement(transformation(extent = {{100, -34}, {110, -24}})));
  Interfaces.AngularVelocityOutput motor_velocity_a "Velocity of the motor encoder of A"
    annotation(Placement(transformation(extent = {{100, -46}, {110, -36}})));
  Interfaces.AngleOutput demand_position_a "Demand of A"
    annotation(Placement(transformation(extent = {{100, -58}, {110, -48}})));
  Interfaces.TorqueOutput force_a "Motor torque at A"
    annotation(Placement(transformation(extent = {{100, -69}, {110, -59}})));
  Interfaces.TorqueOutput stop_force_a "Torque that the stop puts on A, as an amount"
    annotation(Placement(transformation(extent = {{100, -81}, {110, -71}})));
  Interfaces.PositionOutput tip "Height of the end of the tool (truth)"
    annotation(Placement(transformation(extent = {{100, -93}, {110, -83}})));
protected
  constant Units.Length arm = 1 "Radius at which the linear parts of A act";
  DriveCascade drive_z(
    kv = kv,
    feed_forward = feed_forward,
    velocity_gain = 2*Constants.pi*velocity_bandwidth*effective_mass_z,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = force_limit_motor_z)
    "Drive of the slide"
    annotation(Placement(transformation(extent = {{-74, 39}, {-46, 67}})));
  DriveCascade drive_a(
    kv = kv,
    feed_forward = feed_forward,
    velocity_gain = 2*Constants.pi*velocity_bandwidth*effective_inertia_a/arm^2,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = torque_limit_motor_a/arm)
    "Drive of A"
    annotation(Placement(transformation(extent = {{-34, 39}, {-6, 67}})));
  Mechanics.Slide slide(mass = effective_mass_z, position_start = position_start_z)
    "Slide with all that it carries"
    annotation(Placement(transformation(extent = {{-74, -14}, {-46, 14}})));
  Mechanics.Slide rim(mass = effective_inertia_a/arm^2, position_start = position_start_a*arm)
    "What turns with A, at a radius of 1 m"
    annotation(Placement(transformation(extent = {{-34, -14}, {-6, 14}})));
  Mechanics.LeverTip tool(lever = lever) "From the slide and A to the end of the tool"
    annotation(Placement(transformation(extent = {{-54, -67}, {-26, -39}})));
  Mechanics.FixedStop stop(
    stop_position = stop_position,
    stop_direction = stop_direction_z,
    stiffness = stop_stiffness,
    damping = stop_damping)
    "Stop of the tool"
    annotation(Placement(transformation(extent = {{6, -67}, {34, -39}})));
equation
  connect(reference_position_z, drive_z.reference_position)
    annotation(Line(points = {{-100, 90}, {-88, 90}, {-88, 66}, {-75, 66}}, color = {0, 0, 127}));
  connect(reference_velocity_z, drive_z.reference_velocity)
    annotation(Line(points = {{-100, 81}, {-88, 81}, {-88, 63}, {-75, 63}}, color = {0, 0, 127}));
  connect(reference_time_z, drive_z.reference_time)
    annotation(Line(points = {{-100, 73}, {-88, 73}, {-88, 61}, {-75, 61}}, color = {0, 0, 127}));
  connect(reference_end_z, drive_z.reference_end)
    annotation(Line(points = {{-100, 64}, {-88, 64}, {-88, 58}, {-75, 58}}, color = {0, 0, 127}));
  drive_z.enabled = enabled_z;
  connect(force_limit_z, drive_z.force_limit)
    annotation(Line(points = {{-100, 47}, {-88, 47}, {-88, 53}, {-75, 53}}, color = {0, 0, 127}));
  connect(force_limit_positive_z, drive_z.force_limit_positive)
    annotation(Line(points = {{-100, 39}, {-88, 39}, {-88, 50}, {-75, 50}}, color = {0, 0, 127}));
  connect(force_limit_negative_z, drive_z.force_limit_negative)
    annotation(Line(points = {{-100, 30}, {-88, 30}, {-88, 48}, {-75, 48}}, color = {0, 0, 127}));
  drive_z.control = control_z;
  connect(reference_acceleration_z, drive_z.reference_acceleration)
    annotation(Line(points = {{-100, 13}, {-88, 13}, {-88, 43}, {-75, 43}}, color = {0, 0, 127}));
  connect(reference_force_z, drive_z.reference_force)
    annotation(Line(points = {{-100, 4}, {-88, 4}, {-88, 40}, {-75, 40}}, color = {0, 0, 127}));
  drive_a.reference_position = reference_position_a*arm;
  drive_a.reference_velocity = reference_velocity_a*arm;
  connect(reference_time_a, drive_a.reference_time)
    annotation(Line(points = {{-100, -21}, {-68, -21}, {-68, 61}, {-35, 61}}, color = {0, 0, 127}));
  connect(reference_end_a, drive_a.reference_end)
    annotation(Line(points = {{-100, -30}, {-68, -30}, {-68, 58}, {-35, 58}}, color = {0, 0, 127}));
  drive_a.enabled = enabled_a;
  drive_a.force_limit = force_limit_a/arm;
  drive_a.force_limit_positive = force_limit_positive_a/arm;
  drive_a.force_limit_negative = force_limit_negative_a/arm;
  drive_a.control = control_a;
  drive_a.reference_acceleration = reference_acceleration_a*arm;
  drive_a.reference_force = reference_force_a/arm;
  connect(drive_z.flange, slide.flange)
    annotation(Line(points = {{-60, 39}, {-60, -14}}, color = {0, 127, 0}));
  connect(drive_a.flange, rim.flange)
    annotation(Line(points = {{-20, 39}, {-20, -14}}, color = {0, 127, 0}));
  connect(slide.flange, tool.slide)
    annotation(Line(points = {{-60, -14}, {-60, -46}, {-54, -46}}, color = {0, 127, 0}));
  connect(rim.flange, tool.rim)
    annotation(Line(points = {{-20, -14}, {-20, -46}, {-26, -46}}, color = {0, 127, 0}));
  connect(tool.tip, stop.flange)
    annotation(Line(points = {{-40, -67}, {20, -67}}, color = {0, 127, 0}));
  position_z = slide.position;
  velocity_z = slide.velocity;
  motor_position_z = position_z;
  motor_velocity_z = velocity_z;
  demand_position_z = drive_z.demand_position;
  force_z = drive_z.force;
  stop_force_z = stop.force;
  stop_face_z = stop.face + lever*cos(position_a);
  position_a = rim.position/arm;
  velocity_a = rim.velocity/arm;
  motor_position_a = position_a;
  motor_velocity_a = velocity_a;
  demand_position_a = drive_a.demand_position/arm;
  force_a = drive_a.force*arm;
  stop_force_a = stop.force*lever*noEvent(abs(sin(position_a)));
  tip = tool.tip.s;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-30, 30}, {10, 85}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-25, 5}, {5, 35}}, fillColor = {160, 160, 160},
          fillPattern = FillPattern.Solid),
      Line(points = {{-10, 20}, {30, -60}}, color = {0, 0, 0}),
      Rectangle(extent = {{-80, -80}, {80, -60}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: two cascades as in ServoAxis and RotaryAxis; the end of the tool is at h = z - L cos(a) (LeverTip),
and FixedStop is at a height: d h/dt = v + L sin(a) w. Its force F acts on the slide as F and on A as the torque
F L sin(a), the transposed Jacobian of h. The face is level, so X, Y and C take no force, wherever they are.</p>
<p>At rest the stop takes what the weaker one of both gives: F = F_z or M_a/(L |sin a|) of the force limits; that
axis stays behind its demand, the other one is where its demand is.</p>
<p>Assumptions: the centre of mass of what turns is on A, so that the inertia of one axis does not act on
the other; no friction, weights are balanced; rigid between motor and load. Limits: a level face and one point of
contact without friction; no modulo. The numbers are chosen, not measured. Source: the parts; principle of
virtual work.</p>
</html>"));
end TiltingSlide;
