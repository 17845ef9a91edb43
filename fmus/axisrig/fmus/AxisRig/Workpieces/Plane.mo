within AxisRig.Workpieces;
block Plane "Level surface"
  extends Surface;
  parameter Units.Position level = 0 "Height everywhere";
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
    Documentation(info="<html>
<p>Equation: h = level. Assumption: ideal surface. Limit: none. Source: definition.</p>
</html>"));
end Plane;
