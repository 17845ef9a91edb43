within AxisRig.Kinematics;
partial block ToolPoint "Clamping point of a tool and its direction"
  parameter Units.Position reach = 0
    "From the head to the clamping point along the tool, beside the offsets of the head"
    annotation(Dialog(group = "Parameters"));
  Interfaces.PositionOutput point_x "Clamping point: x"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.PositionOutput point_y "Clamping point: y"
    annotation(Placement(transformation(extent = {{100, 48}, {120, 68}})));
  Interfaces.PositionOutput point_z "Clamping point: z"
    annotation(Placement(transformation(extent = {{100, 16}, {120, 36}})));
  Interfaces.DirectionOutput direction_x "From the tool centre point to the clamping point: x"
    annotation(Placement(transformation(extent = {{100, -36}, {120, -16}})));
  Interfaces.DirectionOutput direction_y "From the tool centre point to the clamping point: y"
    annotation(Placement(transformation(extent = {{100, -68}, {120, -48}})));
  Interfaces.DirectionOutput direction_z "From the tool centre point to the clamping point: z"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-40, 60}, {0, 0}, {30, -50}}, color = {0, 0, 0}),
      Ellipse(extent = {{-10, -10}, {10, 10}}, fillColor = {0, 0, 127},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>What every head offers. The clamping point is mechanical: the length of the tool is not in it.</p>
</html>"));
end ToolPoint;
