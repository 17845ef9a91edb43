within AxisRig.Validation;
model Slide "A mass under a force from outside"
  extends Icons.Experiment;
  Mechanics.Slide slide(mass = 80, weight = 30, position_start = 0.01, velocity_start = 0.2)
    "Moving mass"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Mechanics.Load load "Force from outside"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Units.Position position "Position of the mass";
  output Units.Velocity velocity "Velocity of the mass";
equation
  load.force = 500*time;
  connect(load.flange, slide.flange)
    annotation(Line(points = {{40, -20}, {-40, -20}}, color = {0, 127, 0}));
  position = slide.position;
  velocity = slide.velocity;
  annotation(
    experiment(StopTime=1, Interval=0.05),
    Documentation(info="<html>
<p>The force grows in proportion to the time: closed form.</p>
</html>"));
end Slide;
