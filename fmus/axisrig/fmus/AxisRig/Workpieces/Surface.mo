within AxisRig.Workpieces;
partial block Surface "Height over x and y at several points"
  constant Integer points = 1 "How many points";
  constant Integer slopes = 1 "The first so many points have a slope";
  Interfaces.PositionInput x[points] "Points: x"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.PositionInput y[points] "Points: y"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.PositionOutput height[points] "Height at the points"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.SlopeOutput slope_x[slopes] "Derivative of the height by x"
    annotation(Placement(transformation(extent = {{100, 20}, {120, 40}})));
  Interfaces.SlopeOutput slope_y[slopes] "Derivative of the height by y"
    annotation(Placement(transformation(extent = {{100, -40}, {120, -20}})));
  Interfaces.SlopeOutput steepest "No slope anywhere is larger"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, 10}, {-70, 10}, {-60, 10}, {-50, 10}, {-40, 10}, {-30,
          10}, {-20, 10}, {-10, 10}, {0, 10}, {10, 10}, {20, 10}, {30, 10}, {40, 10}, {50, 10},
          {60, 10}, {70, 10}, {80, 10}, {80, -80}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>What every surface offers. The largest slope L bounds distances from below: no point of the
surface is nearer to (x, y, z) than (z - h(x, y))/sqrt(1 + L^2).</p>
</html>"));
end Surface;
