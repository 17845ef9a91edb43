within AxisRig.Workpieces;
partial block Border "Where the material ends"
  Interfaces.PositionInput x "Point: x"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.PositionInput y "Point: y"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.PositionOutput beyond "Distance from the material; negative: inside it"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.SlopeOutput beyond_x "Derivative of it by x"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
  Interfaces.SlopeOutput beyond_y "Derivative of it by y"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, 20}, {0, 20}, {0, -80}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>What every border offers: the signed distance in the plane x, y from the upright wall at which
the material ends.</p>
</html>"));
end Border;
