within AxisRig.Workpieces;
block Ramp "Straight rise between two levels"
  extends Profile;
  parameter Units.Position rise = 1e-3 "Height behind the ramp";
  parameter Units.Position start = 0 "Where the ramp begins";
  parameter Units.Length length(min = 1e-6) = 0.1 "Over which it rises";
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
    Documentation(info="<html>
<p>Equation: h = H min(1, max(0, (s - s_0)/l)). Assumption: sharp corners. Limit: the slope steps at
both ends. Source: definition; height control follows a ramp met with the speed v of the height with
the error v/K (K in 1/s), the law by which tracing controls are rated.</p>
</html>"));
end Ramp;
