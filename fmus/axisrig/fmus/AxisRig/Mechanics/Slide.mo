within AxisRig.Mechanics;
model Slide "Rigid mass on a straight guideway"
  parameter Units.Mass mass = 120 "Everything that moves, in terms of the slide";
  parameter Units.Force weight = 0 "Weight that no counterbalance carries, pulls towards negative";
  parameter Units.Position position_start = 0 "Position at the start";
  parameter Units.Velocity velocity_start = 0 "Velocity at the start";
  Interfaces.Flange flange "Where forces act";
  Units.Position position(start = position_start, fixed = true) "Position of the slide";
  Units.Velocity velocity(start = velocity_start, fixed = true) "Velocity of the slide";
equation
  flange.s = position;
  der(position) = velocity;
  mass*der(velocity) = flange.f - weight;
  annotation(
    Documentation(info="<html>
<p>Equation: m dv/dt = f - F_g, ds/dt = v.</p>
<p>Assumptions: one rigid body; neither screw nor coupling is elastic, so that motor and slide move
as one. Limits: no mode of the feed drive, no backlash. Source: Newton's second law.</p>
</html>"));
end Slide;
