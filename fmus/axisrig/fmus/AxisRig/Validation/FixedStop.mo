within AxisRig.Validation;
model FixedStop "A mass runs into a stop and leaves it again"
  extends Icons.Experiment;
  Mechanics.Slide slide(mass = 100, velocity_start = 0.1, weight = 50) "Moving mass"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Mechanics.FixedStop stop(
    stop_position = 2e-3,
    stiffness = 20e6,
    exponent = 1.5,
    reference_penetration = 1e-4,
    damping = 4)
    "Fixed stop"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Units.Position position "Position of the mass";
  output Units.Velocity velocity "Velocity of the mass";
  output Units.Force force "Force of the contact";
equation
  connect(slide.flange, stop.flange)
    annotation(Line(points = {{-40, -20}, {40, -20}}, color = {0, 127, 0}));
  position = slide.position;
  velocity = slide.velocity;
  force = stop.force;
  annotation(
    experiment(StopTime=0.06, Interval=5e-4),
    Documentation(info="<html>
<p>100 kg at 0.1 m/s, Hertzian exponent 1.5. Compared: position, velocity, force.</p>
</html>"));
end FixedStop;
