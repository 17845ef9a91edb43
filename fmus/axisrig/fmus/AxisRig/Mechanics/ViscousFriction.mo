within AxisRig.Mechanics;
model ViscousFriction "Friction in proportion to the velocity"
  extends PartialFriction;
  parameter Units.Damping viscous = 100 "Force per velocity"
    annotation(Dialog(group = "Friction"));
equation
  flange.f = viscous*velocity;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
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
      Line(points = {{-70, -40}, {70, 60}}, color = {0, 0, 127}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: F = k_v v.</p>
<p>Assumption: lubricated bearings and seals of a motor, whose dry part is small. Limit: nothing holds
at rest. Source: Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994).</p>
</html>"));
end ViscousFriction;
