within AxisRig.Workpieces;
block InclinedPlane "Plane that rises in one direction"
  extends Profile;
  parameter Units.Angle angle(min = -1.4, max = 1.4) = 0.5235987755982988
    "Inclination, positive: rises along the profile"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position origin = 0 "Where the height is 0"
    annotation(Dialog(group = "Parameters"));
protected
  final parameter Units.Slope rise = tan(angle) "Height per length along the profile";
equation
  for i in 1:points loop
    height[i] = rise*(s[i] - origin);
  end for;
  for i in 1:slopes loop
    slope[i] = rise;
  end for;
  steepest = abs(rise);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, -48}, {-70, -42}, {-60, -36}, {-50, -30}, {-40, -24},
          {-30, -18}, {-20, -12}, {-10, -6}, {0, 0}, {10, 6}, {20, 12}, {30, 18}, {40, 24}, {50,
          30}, {60, 36}, {70, 42}, {80, 48}, {80, -80}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: h = (s - s_0) tan b. Assumption: ideal plane without end. Limit: |b| below 80 degrees.
A ball of radius r touches it r (1/cos b - 1) higher than where its lowest point would. Source:
definition; the default is 30 degrees.</p>
</html>"));
end InclinedPlane;
