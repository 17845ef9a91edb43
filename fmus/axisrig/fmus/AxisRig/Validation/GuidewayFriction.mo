within AxisRig.Validation;
model GuidewayFriction "A mass is pushed, slides and comes to rest by Stribeck friction"
  extends Icons.Experiment;
  Mechanics.Slide slide(mass = 190, velocity_start = 0.05) "Moving mass"
    annotation(Placement(transformation(extent = {{-60, 20}, {-20, 60}})));
  Mechanics.GuidewayFriction friction(
    coulomb = 120,
    breakaway = 160,
    stribeck = 5e-3,
    viscous = 800,
    slope = 1e-4)
    "Friction of the guideway"
    annotation(Placement(transformation(extent = {{20, 20}, {60, 60}})));
  Mechanics.Load load "Force from outside"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
  output Units.Position position "Position of the mass";
  output Units.Velocity velocity "Velocity of the mass";
  output Units.Force friction_force "Force against the motion";
equation
  load.force = if time < 0.2 then 100 else -220;
  connect(load.flange, slide.flange)
    annotation(Line(points = {{-40, -60}, {-40, -60}, {-40, 20}, {-40, 20}}, color = {0, 127, 0}));
  connect(friction.flange, slide.flange)
    annotation(Line(points = {{40, 20}, {-40, 20}}, color = {0, 127, 0}));
  position = slide.position;
  velocity = slide.velocity;
  friction_force = friction.flange.f;
  annotation(
    experiment(StopTime=0.4, Interval=0.002),
    Documentation(info="<html>
<p>Comes to rest below the breakaway force, then is pushed back over it.</p>
</html>"));
end GuidewayFriction;
