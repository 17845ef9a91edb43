within AxisRig.Validation;
model FixedStopTornOff "A mass leaves a straight stop faster than the contact can follow"
  extends Icons.Experiment;
  Mechanics.Slide slide(mass = 100, position_start = -2.03e-3, velocity_start = 0.1) "Moving mass"
    annotation(Placement(transformation(extent = {{-60, 20}, {-20, 60}})));
  Mechanics.FixedStop stop(
    stop_position = -2e-3,
    stop_direction = -1,
    stiffness = 500e6,
    exponent = 1,
    damping = 20)
    "Fixed stop"
    annotation(Placement(transformation(extent = {{20, 20}, {60, 60}})));
  Mechanics.Load load "Force from outside"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
  output Units.Position position "Position of the mass";
  output Units.Velocity velocity "Velocity of the mass";
  output Units.Force force "Force of the contact";
equation
  load.force = if time < 0.01003 then -20e3 elseif time < 0.01053 then 20e3 else -20e3;
  connect(load.flange, slide.flange)
    annotation(Line(points = {{-40, -60}, {-40, -60}, {-40, 20}, {-40, 20}}, color = {0, 127, 0}));
  connect(slide.flange, stop.flange)
    annotation(Line(points = {{-40, 20}, {40, 20}}, color = {0, 127, 0}));
  position = slide.position;
  velocity = slide.velocity;
  force = stop.force;
  annotation(
    experiment(StopTime=0.02, Interval=1e-4),
    Documentation(info="<html>
<p>Met in negative direction, exponent 1, 500 N/um. The mass starts inside the stop on its way out,
faster than 1/a; it is pressed in, torn off by 20 kN and thrown back. Compared: position, velocity,
force, which is never negative.</p>
</html>"));
end FixedStopTornOff;
