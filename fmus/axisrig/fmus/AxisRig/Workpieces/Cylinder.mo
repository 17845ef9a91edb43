within AxisRig.Workpieces;
block Cylinder "Round bar or tube that lies on its side"
  extends Profile;
  parameter Units.Length radius = 0 "Radius; 0: no cylinder"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position axis = 0 "Where the axis of the cylinder lies on the profile"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Share round = 0.95 "Share of the radius that is round; tangent outside it"
    annotation(Dialog(group = "Parameters"));
  Interfaces.PositionOutput beyond
    "From the point 1 to the side of the cylinder; negative: above it"
    annotation(Placement(transformation(origin = {-72, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.SlopeOutput beyond_x "Derivative of it by x"
    annotation(Placement(transformation(origin = {0, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  Interfaces.SlopeOutput beyond_y "Derivative of it by y"
    annotation(Placement(transformation(origin = {72, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
protected
  constant Units.Length nowhere = 1e4 "Depth inside the material when there is no cylinder";
  // Compilers fix parameters that decide an if: the radius would no longer be one of an FMU.
  constant Units.Length thin = 1e-9 "A radius below counts as none";
  final parameter Units.Length reach = round*radius "Where the tangent begins";
  final parameter Real drop(unit = "1") = round/sqrt(max(1e-12, 1 - round^2))*min(1, radius/thin)
    "Slope of the tangent";
  Units.Position from_axis[points] "Distance from the axis, within reach";
  Units.Position over[points] "How far the reach is exceeded";
equation
  for i in 1:points loop
    from_axis[i] = max(-reach, min(reach, s[i] - axis));
    over[i] = abs(s[i] - axis - from_axis[i]);
    height[i] = sqrt(max(0, radius^2 - from_axis[i]^2)) - radius - drop*over[i];
  end for;
  for i in 1:slopes loop
    slope[i] = -from_axis[i]/sqrt(max(1e-18, radius^2 - from_axis[i]^2));
  end for;
  steepest = drop;
  beyond = abs(s[1] - axis) - radius - nowhere*max(0, 1 - radius/thin);
  beyond_x = noEvent(if s[1] > axis then along_x else -along_x);
  beyond_y = noEvent(if s[1] > axis then along_y else -along_y);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-60, -60}, {60, 60}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: h = sqrt(R^2 - (s - s_0)^2) - R, so that the highest line has the height 0 of its own.
Assumption: the axis is level. Limit: towards the side the slope has no bound; outside the share
round of the radius the tangent goes on, and outside the radius there is no material. Source: circle.
</p>
</html>"));
end Cylinder;
