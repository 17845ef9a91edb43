within AxisRig.Workpieces;
block ThicknessOffset "Sheet that is thicker or thinner than its nominal size"
  extends Surface;
  parameter Units.Position deviation = 0.2e-3 "Thickness minus nominal thickness"
    annotation(Dialog(group = "Parameters"));
equation
  for i in 1:points loop
    height[i] = deviation;
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
      Line(points = {{-80, 25}, {80, 25}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: h = deviation. Assumption: the sheet lies on its support and has one thickness. Limit:
no waviness of its own (Waviness). Source: EN 10051, thickness tolerances of hot rolled sheet of
category A, less than 1200 mm wide: 0.18 mm at 2 to 2.5 mm, 0.26 mm at 5 to 6 mm, 0.32 mm at 8 to
10 mm, to either side.</p>
</html>"));
end ThicknessOffset;
