within AxisRig.Validation;
model LuGreFriction "A mass slides, sticks and breaks away again"
  Mechanics.Slide slide(mass = 190, velocity_start = 0.5);
  Mechanics.LuGreFriction friction(
    coulomb = 120,
    breakaway = 160,
    stribeck = 5e-3,
    viscous = 800,
    bristle_stiffness = 20e6,
    bristle_damping = 4e3);
  Mechanics.Load load;
  output Units.Position position "Position of the mass";
  output Units.Velocity velocity "Velocity of the mass";
  output Units.Force friction_force "Force against the motion";
equation
  load.force = if time < 0.0464 then -1500 elseif time < 0.3 then 100 else -220;
  connect(load.flange, slide.flange);
  connect(friction.flange, slide.flange);
  position = slide.position;
  velocity = slide.velocity;
  friction_force = friction.flange.f;
  annotation(
    experiment(StopTime=0.5, Interval=0.0025),
    Documentation(info="<html>
<p>Is braked from a speed at which the bristles follow at their fastest, rests under a load below the breakaway force, held by the bristles, then is pushed over it.</p>
</html>"));
end LuGreFriction;
