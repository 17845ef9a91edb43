within AxisRig.Workpieces;
block Edge "Straight edge: the material ends"
  extends Border;
  parameter Units.Position position = 1e3 "Where it ends; the default lies out of reach"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Angle azimuth = 0 "Direction from the material outwards, from x towards y"
    annotation(Dialog(group = "Parameters"));
protected
  final parameter Real out_x(unit = "1") = cos(azimuth) "x of the direction outwards";
  final parameter Real out_y(unit = "1") = sin(azimuth) "y of the direction outwards";
equation
  beyond = out_x*x + out_y*y - position;
  beyond_x = out_x;
  beyond_y = out_y;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, 20}, {20, 20}, {20, -80}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: e = x cos a + y sin a - d. Assumption: upright wall without end below. Limit: none.
Source: distance from a line in Hesse's normal form.</p>
</html>"));
end Edge;
