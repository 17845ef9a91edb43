within AxisRig.Workpieces;
block Hole "Round hole"
  extends Border;
  parameter Units.Position center_x = 0 "Axis of the hole: x"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position center_y = 0 "Axis of the hole: y"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length radius = 0 "Radius; 0: no hole"
    annotation(Dialog(group = "Parameters"));
  Interfaces.LengthOutput from_axis "Distance from the axis of the hole"
    annotation(Placement(transformation(origin = {60, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
protected
  constant Units.Length nowhere = 1e4 "Depth inside the material when there is no hole";
  // Compilers fix parameters that decide an if: the radius would no longer be one of an FMU.
  constant Units.Length thin = 1e-9 "A radius below counts as none";
  constant Units.Length smallest = 1e-12 "Below it the direction to the axis is not known";
equation
  from_axis = sqrt((x - center_x)^2 + (y - center_y)^2);
  beyond = radius - from_axis - nowhere*max(0, 1 - radius/thin);
  beyond_x = (center_x - x)/max(from_axis, smallest);
  beyond_y = (center_y - y)/max(from_axis, smallest);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-80, -80}, {80, 20}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-25, -80}, {25, 20}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: e = R - sqrt((x - x_0)^2 + (y - y_0)^2). Assumption: upright wall without bottom.
Limit: on the axis the direction is 0. Source: circle.</p>
</html>"));
end Hole;
