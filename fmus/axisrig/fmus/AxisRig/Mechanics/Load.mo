within AxisRig.Mechanics;
model Load "Force from outside"
  Interfaces.ForceInput force "Force on the part that it is joined to"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.Flange flange "Where it acts"
    annotation(Placement(transformation(extent = {{-10, -110}, {10, -90}})));
equation
  flange.f = -force;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-70, 0}, {60, 0}}, color = {0, 0, 0}),
      Polygon(points = {{60, 20}, {60, -20}, {90, 0}}, fillColor = {0, 127, 0},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: f = -F. Assumption: the force does not depend on the motion, or the model around says
how. Limit: none. Source: sign of the flange.</p>
</html>"));
end Load;
