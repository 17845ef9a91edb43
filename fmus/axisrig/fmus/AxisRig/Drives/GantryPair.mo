within AxisRig.Drives;
model GantryPair "Two drives that move one beam on two guideways"
  Interfaces.PositionInput reference_position_1 "Demand at reference_time_1"
    annotation(Placement(transformation(extent = {{-106, 87}, {-100, 93}})));
  Interfaces.VelocityInput reference_velocity_1 "Slope of the demand until reference_end_1"
    annotation(Placement(transformation(extent = {{-106, 78}, {-100, 84}})));
  Interfaces.TimeInput reference_time_1 "Instant of reference_position_1"
    annotation(Placement(transformation(extent = {{-106, 70}, {-100, 76}})));
  Interfaces.TimeInput reference_end_1 "Instant from which the demand rests"
    annotation(Placement(transformation(extent = {{-106, 61}, {-100, 67}})));
  Interfaces.BooleanInput enabled_1(start = false) "Power stage on; off: no motor force"
    annotation(Placement(transformation(extent = {{-106, 53}, {-100, 59}})));
  Interfaces.ForceInput force_limit_1(start = 1e9, min = 0)
    "Further limit of the motor force, both directions"
    annotation(Placement(transformation(extent = {{-106, 44}, {-100, 50}})));
  Interfaces.ForceInput force_limit_positive_1(start = 1e9, min = 0)
    "Further limit of the motor force, positive direction"
    annotation(Placement(transformation(extent = {{-106, 36}, {-100, 42}})));
  Interfaces.ForceInput force_limit_negative_1(start = 1e9, min = 0)
    "Further limit of the motor force, negative direction, as an amount"
    annotation(Placement(transformation(extent = {{-106, 27}, {-100, 33}})));
  Interfaces.IntegerInput control_1(start = 0, min = 0, max = 2)
    "What is controlled; 0: position, 1: velocity, 2: force"
    annotation(Placement(transformation(extent = {{-106, 18}, {-100, 24}})));
  Interfaces.AccelerationInput reference_acceleration_1
    "Velocity control: the demand is reference_velocity + this*(min(t, end) - time)"
    annotation(Placement(transformation(extent = {{-106, 10}, {-100, 16}})));
  Interfaces.ForceInput reference_force_1 "Control of the force: demand"
    annotation(Placement(transformation(extent = {{-106, 1}, {-100, 7}})));
  Interfaces.PositionInput reference_position_2 "Demand at reference_time_2"
    annotation(Placement(transformation(extent = {{-106, -7}, {-100, -1}})));
  Interfaces.VelocityInput reference_velocity_2 "Slope of the demand until reference_end_2"
    annotation(Placement(transformation(extent = {{-106, -16}, {-100, -10}})));
  Interfaces.TimeInput reference_time_2 "Instant of reference_position_2"
    annotation(Placement(transformation(extent = {{-106, -24}, {-100, -18}})));
  Interfaces.TimeInput reference_end_2 "Instant from which the demand rests"
    annotation(Placement(transformation(extent = {{-106, -33}, {-100, -27}})));
  Interfaces.BooleanInput enabled_2(start = false) "Power stage on; off: no motor force"
    annotation(Placement(transformation(extent = {{-106, -42}, {-100, -36}})));
  Interfaces.ForceInput force_limit_2(start = 1e9, min = 0)
    "Further limit of the motor force, both directions"
    annotation(Placement(transformation(extent = {{-106, -50}, {-100, -44}})));
  Interfaces.ForceInput force_limit_positive_2(start = 1e9, min = 0)
    "Further limit of the motor force, positive direction"
    annotation(Placement(transformation(extent = {{-106, -59}, {-100, -53}})));
  Interfaces.ForceInput force_limit_negative_2(start = 1e9, min = 0)
    "Further limit of the motor force, negative direction, as an amount"
    annotation(Placement(transformation(extent = {{-106, -67}, {-100, -61}})));
  Interfaces.IntegerInput control_2(start = 0, min = 0, max = 2)
    "What is controlled; 0: position, 1: velocity, 2: force"
    annotation(Placement(transformation(extent = {{-106, -76}, {-100, -70}})));
  Interfaces.AccelerationInput reference_acceleration_2
    "Velocity control: the demand is reference_velocity + this*(min(t, end) - time)"
    annotation(Placement(transformation(extent = {{-106, -84}, {-100, -78}})));
  Interfaces.ForceInput reference_force_2 "Control of the force: demand"
    annotation(Placement(transformation(extent = {{-106, -93}, {-100, -87}})));

  parameter Units.Position position_start = 0 "Position of both sides at the start"
    annotation(Dialog(group = "Start"));
  parameter Units.Rate kv(min = 0) = 10 "Gain of the position loops"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Share feed_forward = 0 "Share of velocity feed-forward"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Frequency velocity_bandwidth = 40
    "Bandwidth of the velocity loops, sets their gain"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time velocity_integral_time(min = 1e-5) = 12e-3
    "Integral time of the velocity loops"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time anti_windup_time(min = 1e-5) = 12e-3
    "Back-calculation time of the velocity loops"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Frequency current_bandwidth(min = 1) = 800 "Bandwidth of the current loops"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Force force_limit_motor(min = 0) = 4000
    "Largest force of each motor, in terms of the slide"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Mass carriage_mass(min = 1e-3) = 60 "Each carriage between screw and beam"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia rotor_inertia = 6e-4 "Each motor with coupling and screw"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Length screw_lead(min = 1e-4) = 0.02 "Travel per revolution"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Mass beam_mass(min = 1e-3) = 400 "Beam with what it carries"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia beam_inertia(min = 1e-6) = 150
    "About the vertical through the centre of mass"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Length span(min = 1e-3) = 2 "Between both guideways"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Position mass_offset = 0
    "Centre of mass from the middle, towards the first guideway"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Stiffness coupling_stiffness = 150e6 "Between each carriage and the beam"
    annotation(Dialog(group = "Elastic parts"));
  parameter Units.Damping coupling_damping = 20e3 "Between each carriage and the beam"
    annotation(Dialog(group = "Elastic parts"));
  parameter Units.Position stop_position_1 = 1e3
    "Fixed stop of the first side; the default lies out of reach"
    annotation(Dialog(group = "Fixed stop"));
  parameter Integer stop_direction_1(min = -1, max = 1) = 1
    "1: this stop is met in positive direction, -1: in negative direction"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Velocity stop_speed_1(min = -1, max = 1) = 0
    "Of the stop of the first side from stop_begin_1 to stop_end_1; 0: it is at rest"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Time stop_begin_1 = 0 "When this stop begins to move"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Time stop_end_1 = 0 "When it is at rest again"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Position stop_position_2 = 1e3 "Fixed stop of the second side"
    annotation(Dialog(group = "Fixed stop"));
  parameter Integer stop_direction_2(min = -1, max = 1) = 1
    "1: this stop is met in positive direction, -1: in negative direction"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Velocity stop_speed_2(min = -1, max = 1) = 0
    "Of the stop of the second side from stop_begin_2 to stop_end_2; 0: it is at rest"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Time stop_begin_2 = 0 "When this stop begins to move"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Time stop_end_2 = 0 "When it is at rest again"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Stiffness stop_stiffness = 20e6 "Stiffness of each stop"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.ContactDamping stop_damping = 20
    "Share of the stop's spring force per velocity"
    annotation(Dialog(group = "Fixed stop"));
  final parameter Units.Mass drive_mass
    = carriage_mass + rotor_inertia*(2*Constants.pi/screw_lead)^2
    "Each carriage and its rotating parts";
  final parameter Units.Damping velocity_gain
    = 2*Constants.pi*velocity_bandwidth*(drive_mass + beam_mass/2)
    "Proportional gain of the velocity loops";

  Interfaces.PositionOutput position_1 "First end of the beam (truth)"
    annotation(Placement(transformation(extent = {{100, 85}, {110, 95}})));
  Interfaces.VelocityOutput velocity_1 "Velocity of the first end"
    annotation(Placement(transformation(extent = {{100, 74}, {110, 84}})));
  Interfaces.PositionOutput motor_position_1 "Motor encoder of the first side"
    annotation(Placement(transformation(extent = {{100, 63}, {110, 73}})));
  Interfaces.VelocityOutput motor_velocity_1 "Velocity of the motor encoder of the first side"
    annotation(Placement(transformation(extent = {{100, 51}, {110, 61}})));
  Interfaces.PositionOutput demand_position_1 "Position demand of the first side"
    annotation(Placement(transformation(extent = {{100, 40}, {110, 50}})));
  Interfaces.ForceOutput force_1 "Motor force of the first side"
    annotation(Placement(transformation(extent = {{100, 29}, {110, 39}})));
  Interfaces.ForceOutput stop_force_1 "Force between beam and stop, first side"
    annotation(Placement(transformation(extent = {{100, 17}, {110, 27}})));
  Interfaces.PositionOutput stop_face_1 "Where the stop of the first side is touched now"
    annotation(Placement(transformation(extent = {{100, 6}, {110, 16}})));
  Interfaces.PositionOutput position_2 "Second end of the beam (truth)"
    annotation(Placement(transformation(extent = {{100, -5}, {110, 5}})));
  Interfaces.VelocityOutput velocity_2 "Velocity of the second end"
    annotation(Placement(transformation(extent = {{100, -16}, {110, -6}})));
  Interfaces.PositionOutput motor_position_2 "Motor encoder of the second side"
    annotation(Placement(transformation(extent = {{100, -27}, {110, -17}})));
  Interfaces.VelocityOutput motor_velocity_2 "Velocity of the motor encoder of the second side"
    annotation(Placement(transformation(extent = {{100, -39}, {110, -29}})));
  Interfaces.PositionOutput demand_position_2 "Position demand of the second side"
    annotation(Placement(transformation(extent = {{100, -50}, {110, -40}})));
  Interfaces.ForceOutput force_2 "Motor force of the second side"
    annotation(Placement(transformation(extent = {{100, -61}, {110, -51}})));
  Interfaces.ForceOutput stop_force_2 "Force between beam and stop, second side"
    annotation(Placement(transformation(extent = {{100, -73}, {110, -63}})));
  Interfaces.PositionOutput stop_face_2 "Where the stop of the second side is touched now"
    annotation(Placement(transformation(extent = {{100, -84}, {110, -74}})));
  Interfaces.PositionOutput skew "How far the first end of the beam is ahead"
    annotation(Placement(transformation(extent = {{100, -95}, {110, -85}})));
protected
  DriveCascade drive_1(
    kv = kv,
    feed_forward = feed_forward,
    velocity_gain = velocity_gain,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = force_limit_motor)
    "Drive of the first side"
    annotation(Placement(transformation(extent = {{-74, 39}, {-46, 67}})));
  DriveCascade drive_2(
    kv = kv,
    feed_forward = feed_forward,
    velocity_gain = velocity_gain,
    velocity_integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time,
    current_bandwidth = current_bandwidth,
    force_limit_motor = force_limit_motor)
    "Drive of the second side"
    annotation(Placement(transformation(extent = {{-34, 39}, {-6, 67}})));
  Mechanics.Slide carriage_1(mass = drive_mass, position_start = position_start)
    "Carriage of the first side with its rotor"
    annotation(Placement(transformation(extent = {{6, 39}, {34, 67}})));
  Mechanics.Slide carriage_2(mass = drive_mass, position_start = position_start)
    "Carriage of the second side with its rotor"
    annotation(Placement(transformation(extent = {{46, 39}, {74, 67}})));
  Mechanics.LuGreFriction friction_1 "Guideway of the first side"
    annotation(Placement(transformation(extent = {{-74, -14}, {-46, 14}})));
  Mechanics.LuGreFriction friction_2 "Guideway of the second side"
    annotation(Placement(transformation(extent = {{-34, -14}, {-6, 14}})));
  Mechanics.ElasticJoint coupling_1(stiffness = coupling_stiffness, damping = coupling_damping)
    "Between first carriage and beam"
    annotation(Placement(transformation(extent = {{6, -14}, {34, 14}})));
  Mechanics.ElasticJoint coupling_2(stiffness = coupling_stiffness, damping = coupling_damping)
    "Between second carriage and beam"
    annotation(Placement(transformation(extent = {{46, -14}, {74, 14}})));
  Mechanics.CrossBeam beam(
    mass = beam_mass,
    inertia = beam_inertia,
    span = span,
    offset = mass_offset,
    position_start = position_start)
    "Beam with what it carries"
    annotation(Placement(transformation(extent = {{-74, -67}, {-46, -39}})));
  Mechanics.FixedStop stop_1(
    stop_position = stop_position_1,
    stop_direction = stop_direction_1,
    stop_speed = stop_speed_1,
    stop_begin = stop_begin_1,
    stop_end = stop_end_1,
    stiffness = stop_stiffness,
    damping = stop_damping)
    "Stop of the first side"
    annotation(Placement(transformation(extent = {{-34, -67}, {-6, -39}})));
  Mechanics.FixedStop stop_2(
    stop_position = stop_position_2,
    stop_direction = stop_direction_2,
    stop_speed = stop_speed_2,
    stop_begin = stop_begin_2,
    stop_end = stop_end_2,
    stiffness = stop_stiffness,
    damping = stop_damping)
    "Stop of the second side"
    annotation(Placement(transformation(extent = {{6, -67}, {34, -39}})));
equation
  connect(reference_position_1, drive_1.reference_position)
    annotation(Line(points = {{-100, 90}, {-88, 90}, {-88, 66}, {-75, 66}}, color = {0, 0, 127}));
  connect(reference_velocity_1, drive_1.reference_velocity)
    annotation(Line(points = {{-100, 81}, {-88, 81}, {-88, 63}, {-75, 63}}, color = {0, 0, 127}));
  connect(reference_time_1, drive_1.reference_time)
    annotation(Line(points = {{-100, 73}, {-88, 73}, {-88, 61}, {-75, 61}}, color = {0, 0, 127}));
  connect(reference_end_1, drive_1.reference_end)
    annotation(Line(points = {{-100, 64}, {-88, 64}, {-88, 58}, {-75, 58}}, color = {0, 0, 127}));
  drive_1.enabled = enabled_1;
  connect(force_limit_1, drive_1.force_limit)
    annotation(Line(points = {{-100, 47}, {-88, 47}, {-88, 53}, {-75, 53}}, color = {0, 0, 127}));
  connect(force_limit_positive_1, drive_1.force_limit_positive)
    annotation(Line(points = {{-100, 39}, {-88, 39}, {-88, 50}, {-75, 50}}, color = {0, 0, 127}));
  connect(force_limit_negative_1, drive_1.force_limit_negative)
    annotation(Line(points = {{-100, 30}, {-88, 30}, {-88, 48}, {-75, 48}}, color = {0, 0, 127}));
  drive_1.control = control_1;
  connect(reference_acceleration_1, drive_1.reference_acceleration)
    annotation(Line(points = {{-100, 13}, {-88, 13}, {-88, 43}, {-75, 43}}, color = {0, 0, 127}));
  connect(reference_force_1, drive_1.reference_force)
    annotation(Line(points = {{-100, 4}, {-88, 4}, {-88, 40}, {-75, 40}}, color = {0, 0, 127}));
  connect(reference_position_2, drive_2.reference_position)
    annotation(Line(points = {{-100, -4}, {-68, -4}, {-68, 66}, {-35, 66}}, color = {0, 0, 127}));
  connect(reference_velocity_2, drive_2.reference_velocity)
    annotation(Line(points = {{-100, -13}, {-68, -13}, {-68, 63}, {-35, 63}}, color = {0, 0, 127}));
  connect(reference_time_2, drive_2.reference_time)
    annotation(Line(points = {{-100, -21}, {-68, -21}, {-68, 61}, {-35, 61}}, color = {0, 0, 127}));
  connect(reference_end_2, drive_2.reference_end)
    annotation(Line(points = {{-100, -30}, {-68, -30}, {-68, 58}, {-35, 58}}, color = {0, 0, 127}));
  drive_2.enabled = enabled_2;
  connect(force_limit_2, drive_2.force_limit)
    annotation(Line(points = {{-100, -47}, {-68, -47}, {-68, 53}, {-35, 53}}, color = {0, 0, 127}));
  connect(force_limit_positive_2, drive_2.force_limit_positive)
    annotation(Line(points = {{-100, -56}, {-68, -56}, {-68, 50}, {-35, 50}}, color = {0, 0, 127}));
  connect(force_limit_negative_2, drive_2.force_limit_negative)
    annotation(Line(points = {{-100, -64}, {-68, -64}, {-68, 48}, {-35, 48}}, color = {0, 0, 127}));
  drive_2.control = control_2;
  connect(reference_acceleration_2, drive_2.reference_acceleration)
    annotation(Line(points = {{-100, -81}, {-68, -81}, {-68, 43}, {-35, 43}}, color = {0, 0, 127}));
  connect(reference_force_2, drive_2.reference_force)
    annotation(Line(points = {{-100, -90}, {-68, -90}, {-68, 40}, {-35, 40}}, color = {0, 0, 127}));
  connect(drive_1.flange, carriage_1.flange)
    annotation(Line(points = {{-60, 39}, {20, 39}}, color = {0, 127, 0}));
  connect(friction_1.flange, carriage_1.flange)
    annotation(Line(points = {{-60, -14}, {-20, -14}, {-20, 39}, {20, 39}}, color = {0, 127, 0}));
  connect(carriage_1.flange, coupling_1.flange_a)
    annotation(Line(points = {{20, 39}, {13, 39}, {13, 0}, {6, 0}}, color = {0, 127, 0}));
  connect(coupling_1.flange_b, beam.flange_1)
    annotation(Line(points = {{34, 0}, {-20, 0}, {-20, -53}, {-74, -53}}, color = {0, 127, 0}));
  connect(stop_1.flange, beam.flange_1)
    annotation(Line(points = {{-20, -67}, {-47, -67}, {-47, -53}, {-74, -53}}, color = {0, 127, 0}));
  connect(drive_2.flange, carriage_2.flange)
    annotation(Line(points = {{-20, 39}, {60, 39}}, color = {0, 127, 0}));
  connect(friction_2.flange, carriage_2.flange)
    annotation(Line(points = {{-20, -14}, {20, -14}, {20, 39}, {60, 39}}, color = {0, 127, 0}));
  connect(carriage_2.flange, coupling_2.flange_a)
    annotation(Line(points = {{60, 39}, {53, 39}, {53, 0}, {46, 0}}, color = {0, 127, 0}));
  connect(coupling_2.flange_b, beam.flange_2)
    annotation(Line(points = {{74, 0}, {14, 0}, {14, -53}, {-46, -53}}, color = {0, 127, 0}));
  connect(stop_2.flange, beam.flange_2)
    annotation(Line(points = {{20, -67}, {-13, -67}, {-13, -53}, {-46, -53}}, color = {0, 127, 0}));
  position_1 = beam.flange_1.s;
  velocity_1 = der(beam.flange_1.s);
  motor_position_1 = carriage_1.position;
  motor_velocity_1 = carriage_1.velocity;
  demand_position_1 = drive_1.demand_position;
  force_1 = drive_1.force;
  stop_force_1 = stop_1.force;
  stop_face_1 = stop_1.face;
  position_2 = beam.flange_2.s;
  velocity_2 = der(beam.flange_2.s);
  motor_position_2 = carriage_2.position;
  motor_velocity_2 = carriage_2.velocity;
  demand_position_2 = drive_2.demand_position;
  force_2 = drive_2.force;
  stop_force_2 = stop_2.force;
  stop_face_2 = stop_2.face;
  skew = position_1 - position_2;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-80, -70}, {-60, 70}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{60, -70}, {80, 70}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-80, -10}, {80, 20}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: two cascades as in ServoAxis, each with a carriage (mass and rotor), LuGre friction
and an elastic joint to one end of CrossBeam. The encoders sit on the motors, position_1 and
position_2 are the ends of the beam, skew is their difference.</p>
<p>With both drives at the same demand a centre of mass off the middle gives a skew only while the
speed changes; a difference of the demands gives the same skew at rest.</p>
<p>Assumptions: rigid beam, small yaw. Limits: no bending, no guideway forces across. The numbers
are chosen, not measured. Source: the parts.</p>
</html>"));
end GantryPair;
