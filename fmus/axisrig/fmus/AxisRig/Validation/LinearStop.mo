within AxisRig.Validation;
model LinearStop "A mass runs into a spring with damper and leaves it again"
  Mechanics.Slide slide(mass = 100, velocity_start = 0.1);
  Mechanics.LinearStop stop(stop_position = 2.01e-3, stiffness = 50e6, damping = 20e3);
  output Units.Position position "Position of the mass";
  output Units.Velocity velocity "Velocity of the mass";
  output Units.Force force "Force of the contact";
equation
  connect(slide.flange, stop.flange);
  position = slide.position;
  velocity = slide.velocity;
  force = stop.force;
  annotation(
    experiment(StopTime=0.06, Interval=0.0005),
    Documentation(info="<html>
<p>Half a damped oscillation, until the force ends: closed form.</p>
</html>"));
end LinearStop;
