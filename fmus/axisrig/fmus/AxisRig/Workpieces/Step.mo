within AxisRig.Workpieces;
block Step "Obstacle with smooth flanks"
  extends Profile;
  parameter Units.Position rise = 2.8e-3 "Height of the top"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position start = 0 "Where the rising flank begins"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length flank(min = 1e-6) = 5e-3 "Length of a flank"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length width = 1e3
    "From the beginning of the rising to that of the falling flank"
    annotation(Dialog(group = "Parameters"));
protected
  Real up[points](each unit = "1") "How far the rising flank is passed, 0..1";
  Real down[points](each unit = "1") "How far the falling flank is passed, 0..1";
equation
  for i in 1:points loop
    up[i] = max(0, min(1, (s[i] - start)/flank));
    down[i] = max(0, min(1, (s[i] - start - width)/flank));
    height[i] = rise*(up[i]^2*(3 - 2*up[i]) - down[i]^2*(3 - 2*down[i]));
  end for;
  for i in 1:slopes loop
    slope[i] = 6*rise/flank*(up[i]*(1 - up[i]) - down[i]*(1 - down[i]));
  end for;
  steepest = 1.5*abs(rise)/flank;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, 0}, {-70, 0}, {-60, 0}, {-50, 0}, {-40, 0}, {-30, 0},
          {-20, 30}, {-10, 30}, {0, 30}, {10, 30}, {20, 30}, {30, 0}, {40, 0}, {50, 0}, {60, 0},
          {70, 0}, {80, 0}, {80, -80}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: q(u) = u^2 (3 - 2 u) for u within 0..1; h = H (q((s - s_0)/l) - q((s - s_0 - w)/l)),
largest slope 1.5 H/l. Assumption: the flank is a cubic, so that height and slope are continuous.
Limit: flanks shall not overlap (w at least l) for the largest slope to hold. Source: Hermite
interpolation between two levels; the default is the 2.8 mm obstacle of the manual of the distance
control.</p>
</html>"));
end Step;
