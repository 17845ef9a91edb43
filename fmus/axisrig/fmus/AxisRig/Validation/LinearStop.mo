within AxisRig.Validation;
model LinearStop "A mass runs into a spring with damper and leaves it again"
  extends Icons.Experiment;
  Mechanics.Slide slide(mass = 100, velocity_start = 0.1) "Moving mass"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Mechanics.LinearStop stop(stop_position = 2.01e-3, stiffness = 50e6, damping = 20e3)
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
    experiment(StopTime=0.06, Interval=0.0005),
    Documentation(info="<html>
<p>Half a damped oscillation, until the force ends: closed form.</p>
</html>"));
end LinearStop;
