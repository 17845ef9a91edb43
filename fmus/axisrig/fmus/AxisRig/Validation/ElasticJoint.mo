within AxisRig.Validation;
model ElasticJoint "Two masses joined with backlash, thrown to and fro"
  Mechanics.Slide driver(mass = 70, velocity_start = 0.02);
  Mechanics.Slide driven(mass = 120, weight = 5);
  Mechanics.ElasticJoint joint(stiffness = 120e6, damping = 6e3, backlash = 10e-6);
  Mechanics.Load load;
  output Units.Position twist "How far the driving mass is ahead";
  output Units.Position position "Position of the driven mass";
  output Units.Velocity velocity "Velocity of the driven mass";
  output Units.Force force "Force on the driven mass";
equation
  load.force = if time < 0.02 then -200 else 300;
  connect(load.flange, driver.flange);
  connect(driver.flange, joint.flange_a);
  connect(joint.flange_b, driven.flange);
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
