within AxisRig.Workpieces;
block Edge "Straight edge: the material ends"
  extends Border;
  parameter Units.Position position = 1e3 "Where it ends; the default lies out of reach";
  parameter Units.Angle azimuth = 0 "Direction from the material outwards, from x towards y";
protected
  final parameter Real out_x(unit = "1") = cos(azimuth) "x of the direction outwards";
  final parameter Real out_y(unit = "1") = sin(azimuth) "y of the direction outwards";
equation
  beyond = out_x*x + out_y*y - position;
  beyond_x = out_x;
  beyond_y = out_y;
  annotation(
    Documentation(info="<html>
<p>Equation: e = x cos a + y sin a - d. Assumption: upright wall without end below. Limit: none.
Source: distance from a line in Hesse's normal form.</p>
</html>"));
end Edge;
