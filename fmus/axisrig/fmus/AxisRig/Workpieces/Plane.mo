within AxisRig.Workpieces;
block Plane "Level surface"
  extends Surface;
  parameter Units.Position level = 0 "Height everywhere"
    annotation(Dialog(group = "Parameters"));
equation
  for i in 1:points loop
    height[i] = level;
  end for;
  for i in 1:slopes loop
    slope_x[i] = 0;
    slope_y[i] = 0;
  end for;
  steepest = 0;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, 0}, {-70, 0}, {-60, 0}, {-50, 0}, {-40, 0}, {-30, 0},
          {-20, 0}, {-10, 0}, {0, 0}, {10, 0}, {20, 0}, {30, 0}, {40, 0}, {50, 0}, {60, 0}, {70,
          0}, {80, 0}, {80, -80}}, fillColor = {200, 170, 120}, fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: h = level. Assumption: ideal surface. Limit: none. Source: definition.</p>
</html>"));
end Plane;
