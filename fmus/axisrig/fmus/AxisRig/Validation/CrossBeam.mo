within AxisRig.Validation;
model CrossBeam "A beam is pushed at one end and held by springs at both"
  extends Icons.Experiment;
  Mechanics.CrossBeam beam(mass = 400, inertia = 150, span = 2, offset = 0.3, position_start = 1e-3)
    "Beam with what it carries"
    annotation(Placement(transformation(extent = {{-72, 21}, {-34, 59}})));
  Mechanics.ElasticJoint spring_1(stiffness = 1e6, damping = 3e3) "Spring at the first end"
    annotation(Placement(transformation(extent = {{-19, 21}, {19, 59}})));
  Mechanics.ElasticJoint spring_2(stiffness = 2e6, damping = 4e3) "Spring at the second end"
    annotation(Placement(transformation(extent = {{34, 21}, {72, 59}})));
  Mechanics.Load load "Force from outside"
    annotation(Placement(transformation(extent = {{-72, -59}, {-34, -21}})));
  Mechanics.Slide wall_1(mass = 1e3) "Heavy mass at the first end"
    annotation(Placement(transformation(extent = {{-19, -59}, {19, -21}})));
  Mechanics.Slide wall_2(mass = 1e3) "Heavy mass at the second end"
    annotation(Placement(transformation(extent = {{34, -59}, {72, -21}})));
  output Units.Position position_1 "First end";
  output Units.Position position_2 "Second end";
  output Units.Position skew "First end minus second end";
  output Units.Angle yaw "Yaw";
equation
  load.force = 100;
  connect(load.flange, beam.flange_1)
    annotation(Line(points = {{-53, -59}, {-62, -59}, {-62, 40}, {-72, 40}}, color = {0, 127, 0}));
  connect(wall_1.flange, spring_1.flange_a)
    annotation(Line(points = {{0, -59}, {-10, -59}, {-10, 40}, {-19, 40}}, color = {0, 127, 0}));
  connect(wall_2.flange, spring_2.flange_a)
    annotation(Line(points = {{53, -59}, {44, -59}, {44, 40}, {34, 40}}, color = {0, 127, 0}));
  connect(spring_1.flange_b, beam.flange_1)
    annotation(Line(points = {{19, 40}, {-72, 40}}, color = {0, 127, 0}));
  connect(spring_2.flange_b, beam.flange_2)
    annotation(Line(points = {{72, 40}, {-34, 40}}, color = {0, 127, 0}));
  position_1 = beam.flange_1.s;
  position_2 = beam.flange_2.s;
  skew = position_1 - position_2;
  yaw = beam.yaw;
  annotation(
    experiment(StopTime=0.2, Interval=0.002),
    Documentation(info="<html>
<p>A linear system: the reference is its matrix exponential.</p>
</html>"));
end CrossBeam;
