within AxisRig.Mechanics;
model Slide "Rigid mass on a straight guideway"
  parameter Units.Mass mass = 120 "Everything that moves, in terms of the slide"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Force weight = 0 "Weight that no counterbalance carries, pulls towards negative"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Position position_start = 0 "Position at the start"
    annotation(Dialog(group = "Start"));
  parameter Units.Velocity velocity_start = 0 "Velocity at the start"
    annotation(Dialog(group = "Start"));
  Interfaces.Flange flange "Where forces act"
    annotation(Placement(transformation(extent = {{-10, -110}, {10, -90}})));
  Units.Position position(start = position_start, fixed = true) "Position of the slide";
  Units.Velocity velocity(start = velocity_start, fixed = true) "Velocity of the slide";
equation
  flange.s = position;
  der(position) = velocity;
  mass*der(velocity) = flange.f - weight;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-50, -40}, {50, 40}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -60}, {80, -60}}, color = {0, 0, 0}),
      Line(points = {{-72, -74}, {-60, -60}}, color = {0, 0, 0}),
      Line(points = {{-52, -74}, {-40, -60}}, color = {0, 0, 0}),
      Line(points = {{-32, -74}, {-20, -60}}, color = {0, 0, 0}),
      Line(points = {{-12, -74}, {0, -60}}, color = {0, 0, 0}),
      Line(points = {{8, -74}, {20, -60}}, color = {0, 0, 0}),
      Line(points = {{28, -74}, {40, -60}}, color = {0, 0, 0}),
      Line(points = {{48, -74}, {60, -60}}, color = {0, 0, 0}),
      Line(points = {{68, -74}, {80, -60}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: m dv/dt = f - F_g, ds/dt = v.</p>
<p>Assumptions: one rigid body; neither screw nor coupling is elastic, so that motor and slide move
as one. Limits: no mode of the feed drive, no backlash. Source: Newton's second law.</p>
</html>"));
end Slide;
