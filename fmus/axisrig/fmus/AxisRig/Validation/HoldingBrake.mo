within AxisRig.Validation;
model HoldingBrake "A brake opens, a mass falls, the brake catches it"
  extends Icons.Experiment;
  Mechanics.Slide slide(mass = 190, weight = 300) "Moving mass"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Mechanics.HoldingBrake brake(
    opening_time = 60e-3,
    closing_time = 20e-3,
    holding_force = 2000,
    stiffness = 100e6,
    damping = 20e3)
    "Holding brake"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Units.Position position "Position of the mass";
  output Units.Velocity velocity "Velocity of the mass";
  output Units.Force force "Force of the brake";
  output Boolean open "The brake has no force";
equation
  brake.released = time > 0.05 and time < 0.15;
  connect(slide.flange, brake.flange)
    annotation(Line(points = {{-40, -20}, {40, -20}}, color = {0, 127, 0}));
  position = slide.position;
  velocity = slide.velocity;
  force = brake.force;
  open = brake.open;
  annotation(
    experiment(StopTime=0.3, Interval=0.0013),
    Documentation(info="<html>
<p>Released from 0.05 to 0.15 s: open from 0.11 to 0.17 s, then the brake slips and holds.</p>
</html>"));
end HoldingBrake;
