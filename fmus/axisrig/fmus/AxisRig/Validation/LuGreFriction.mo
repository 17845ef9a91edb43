within AxisRig.Validation;
model LuGreFriction "A mass slides, sticks and breaks away again"
  extends Icons.Experiment;
  Mechanics.Slide slide(mass = 190, velocity_start = 0.5) "Moving mass"
    annotation(Placement(transformation(extent = {{-60, 20}, {-20, 60}})));
  Mechanics.LuGreFriction friction(
    coulomb = 120,
    breakaway = 160,
    stribeck = 5e-3,
    viscous = 800,
    bristle_stiffness = 20e6,
    bristle_damping = 4e3)
    "Friction of the guideway"
    annotation(Placement(transformation(extent = {{20, 20}, {60, 60}})));
  Mechanics.Load load "Force from outside"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
  output Units.Position position "Position of the mass";
  output Units.Velocity velocity "Velocity of the mass";
  output Units.Force friction_force "Force against the motion";
equation
  load.force = if time < 0.0464 then -1500 elseif time < 0.3 then 100 else -220;
  connect(load.flange, slide.flange)
    annotation(Line(points = {{-40, -60}, {-40, -60}, {-40, 20}, {-40, 20}}, color = {0, 127, 0}));
  connect(friction.flange, slide.flange)
    annotation(Line(points = {{40, 20}, {-40, 20}}, color = {0, 127, 0}));
  position = slide.position;
  velocity = slide.velocity;
  friction_force = friction.flange.f;
  annotation(
    experiment(StopTime=0.5, Interval=0.0025),
    Documentation(info="<html>
<p>Is braked from a speed at which the bristles follow at their fastest, rests under a load below the breakaway force, held by the bristles, then is pushed over it.</p>
</html>"));
end LuGreFriction;
