within AxisRig.Workpieces;
block InclinedPlane "Plane that rises in one direction"
  extends Profile;
  parameter Units.Angle angle(min = -1.4, max = 1.4) = 0.5235987755982988
    "Inclination, positive: rises along the profile";
  parameter Units.Position origin = 0 "Where the height is 0";
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
    Documentation(info="<html>
<p>Equation: h = (s - s_0) tan b. Assumption: ideal plane without end. Limit: |b| below 80 degrees.
A ball of radius r touches it r (1/cos b - 1) higher than where its lowest point would. Source:
definition; the default is 30 degrees.</p>
</html>"));
end InclinedPlane;
