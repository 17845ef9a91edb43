within AxisRig.Validation;
model CrossBeam "A beam is pushed at one end and held by springs at both"
  Mechanics.CrossBeam beam(mass = 400, inertia = 150, span = 2, offset = 0.3, position_start = 1e-3);
  Mechanics.ElasticJoint spring_1(stiffness = 1e6, damping = 3e3);
  Mechanics.ElasticJoint spring_2(stiffness = 2e6, damping = 4e3);
  Mechanics.Load load;
  Mechanics.Slide wall_1(mass = 1e3);
  Mechanics.Slide wall_2(mass = 1e3);
  output Units.Position position_1 "First end";
  output Units.Position position_2 "Second end";
  output Units.Position skew "First end minus second end";
  output Units.Angle yaw "Yaw";
equation
  load.force = 100;
  connect(load.flange, beam.flange_1);
  connect(wall_1.flange, spring_1.flange_a);
  connect(wall_2.flange, spring_2.flange_a);
  connect(spring_1.flange_b, beam.flange_1);
  connect(spring_2.flange_b, beam.flange_2);
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
