within AxisRig.Workpieces;
block ThicknessOffset "Sheet that is thicker or thinner than its nominal size"
  extends Surface;
  parameter Units.Position deviation = 0.2e-3 "Thickness minus nominal thickness";
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
    Documentation(info="<html>
<p>Equation: h = deviation. Assumption: the sheet lies on its support and has one thickness. Limit:
no waviness of its own (Waviness). Source: EN 10051, thickness tolerances of hot rolled sheet of
category A, less than 1200 mm wide: 0.18 mm at 2 to 2.5 mm, 0.26 mm at 5 to 6 mm, 0.32 mm at 8 to
10 mm, to either side.</p>
</html>"));
end ThicknessOffset;
