within AxisRig.Workpieces;
partial block Surface "Height over x and y at several points"
  constant Integer points = 1 "How many points";
  constant Integer slopes = 1 "The first so many points have a slope";
  input Units.Position x[points] "Points: x";
  input Units.Position y[points] "Points: y";
  output Units.Position height[points] "Height at the points";
  output Units.Slope slope_x[slopes] "Derivative of the height by x";
  output Units.Slope slope_y[slopes] "Derivative of the height by y";
  output Units.Slope steepest "No slope anywhere is larger";
  annotation(
    Documentation(info="<html>
<p>What every surface offers. The largest slope L bounds distances from below: no point of the
surface is nearer to (x, y, z) than (z - h(x, y))/sqrt(1 + L^2).</p>
</html>"));
end Surface;
