within AxisRig.Validation;
model ElasticJoint "Two masses joined with backlash, thrown to and fro"
  extends Icons.Experiment;
  Mechanics.Slide driver(mass = 70, velocity_start = 0.02) "Driving mass"
    annotation(Placement(transformation(extent = {{-60, 20}, {-20, 60}})));
  Mechanics.Slide driven(mass = 120, weight = 5) "Driven mass"
    annotation(Placement(transformation(extent = {{20, 20}, {60, 60}})));
  Mechanics.ElasticJoint joint(stiffness = 120e6, damping = 6e3, backlash = 10e-6)
    "Joint under test"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
  Mechanics.Load load "Force from outside"
    annotation(Placement(transformation(extent = {{20, -60}, {60, -20}})));
  output Units.Position twist "How far the driving mass is ahead";
  output Units.Position position "Position of the driven mass";
  output Units.Velocity velocity "Velocity of the driven mass";
  output Units.Force force "Force on the driven mass";
equation
  load.force = if time < 0.02 then -200 else 300;
  connect(load.flange, driver.flange)
    annotation(Line(points = {{40, -60}, {0, -60}, {0, 20}, {-40, 20}}, color = {0, 127, 0}));
  connect(driver.flange, joint.flange_a)
    annotation(Line(points = {{-40, 20}, {-50, 20}, {-50, -40}, {-60, -40}}, color = {0, 127, 0}));
  connect(joint.flange_b, driven.flange)
    annotation(Line(points = {{-20, -40}, {10, -40}, {10, 20}, {40, 20}}, color = {0, 127, 0}));
  twist = joint.twist;
  position = driven.position;
  velocity = driven.velocity;
  force = joint.force;
  annotation(
    experiment(StopTime=0.06, Interval=0.0005),
    Documentation(info="<html>
<p>Both contacts are met; the load presses the driving mass to the one and then to the other.</p>
</html>"));
end ElasticJoint;
