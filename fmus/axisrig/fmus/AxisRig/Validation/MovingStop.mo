within AxisRig.Validation;
model MovingStop "A stop comes towards a mass, throws it back, rests, and is met again"
  extends Icons.Experiment;
  Mechanics.Slide slide(mass = 100, velocity_start = 0.02, weight = -600) "Moving mass"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Mechanics.FixedStop stop(
    stop_position = 3e-3,
    stop_speed = -0.05,
    stop_begin = 0.008,
    stop_end = 0.052,
    stiffness = 50e6,
    damping = 8)
    "Fixed stop"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Units.Position position "Position of the mass";
  output Units.Velocity velocity "Velocity of the mass";
  output Units.Force force "Force of the contact";
  output Units.Position face "Where the stop is touched";
equation
  connect(slide.flange, stop.flange)
    annotation(Line(points = {{-40, -20}, {40, -20}}, color = {0, 127, 0}));
  position = slide.position;
  velocity = slide.velocity;
  force = stop.force;
  face = stop.face;
  annotation(
    experiment(StopTime=0.08, Interval=5e-4),
    Documentation(info="<html>
<p>100 kg under 600 N towards a stop that moves against them from 8 ms to 52 ms and is met again
and again. Compared: position, velocity, force, place of the stop.</p>
</html>"));
end MovingStop;
