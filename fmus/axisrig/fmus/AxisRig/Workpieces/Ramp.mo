within AxisRig.Workpieces;
block Ramp "Straight rise between two levels"
  extends Profile;
  parameter Units.Position rise = 1e-3 "Height after the ramp"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position start = 0 "Where the ramp begins"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length length(min = 1e-6) = 0.1 "Over which it rises"
    annotation(Dialog(group = "Parameters"));
protected
  final parameter Units.Slope gradient = rise/length "Height per length on the ramp";
equation
  for i in 1:points loop
    height[i] = gradient*max(0, min(length, s[i] - start));
  end for;
  for i in 1:slopes loop
    slope[i] = noEvent(if s[i] > start and s[i] < start + length then gradient else 0);
  end for;
  steepest = abs(gradient);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, -20}, {-70, -20}, {-60, -20}, {-50, -20}, {-40, -20},
          {-30, -20}, {-20, -20}, {-10, -10}, {0, 0}, {10, 10}, {20, 20}, {30, 30}, {40, 40}, {50,
          40}, {60, 40}, {70, 40}, {80, 40}, {80, -80}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: h = H min(1, max(0, (s - s_0)/l)). Assumption: sharp corners. Limit: the slope steps at
both ends. Source: definition; height control follows a ramp met with the speed v of the height with
the error v/K (K in 1/s), the law by which tracing controls are rated.</p>
</html>"));
end Ramp;
