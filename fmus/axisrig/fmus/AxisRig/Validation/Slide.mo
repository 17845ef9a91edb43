within AxisRig.Validation;
model Slide "A mass under a force from outside"
  Mechanics.Slide slide(mass = 80, weight = 30, position_start = 0.01, velocity_start = 0.2);
  Mechanics.Load load;
  output Units.Position position "Position of the mass";
  output Units.Velocity velocity "Velocity of the mass";
equation
  load.force = 500*time;
  connect(load.flange, slide.flange);
  position = slide.position;
  velocity = slide.velocity;
  annotation(
    experiment(StopTime=1, Interval=0.05),
    Documentation(info="<html>
<p>The force grows in proportion to the time: closed form.</p>
</html>"));
end Slide;
