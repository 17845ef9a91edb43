within AxisRig.Sensors;
block CubicPath "Motion through two positions with given rates, as a cubic in time"
  Interfaces.PositionInput start "Position at the beginning"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.VelocityInput start_rate "Rate at the beginning"
    annotation(Placement(transformation(extent = {{-120, 44}, {-100, 64}})));
  Interfaces.PositionInput finish "Position at the end"
    annotation(Placement(transformation(extent = {{-120, 8}, {-100, 28}})));
  Interfaces.VelocityInput finish_rate "Rate at the end"
    annotation(Placement(transformation(extent = {{-120, -28}, {-100, -8}})));
  Interfaces.TimeInput span "Duration from beginning to end"
    annotation(Placement(transformation(extent = {{-120, -64}, {-100, -44}})));
  Interfaces.RealInput passed(unit = "1") "Share of the duration that has passed, 0..1"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.PositionOutput position "Position now"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
equation
  position = start + passed*(span*start_rate
    + passed*((3*(finish - start) - span*(2*start_rate + finish_rate))
    + passed*(2*(start - finish) + span*(start_rate + finish_rate))));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -50}, {-40, -45}, {0, 0}, {40, 45}, {80, 50}}, color = {0, 0, 127},
          smooth = Smooth.Bezier),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: s(u) = h00 s0 + h10 T v0 + h01 s1 + h11 T v1 with the cubic Hermite base functions, written
in the Horner form.</p>
<p>Assumption: position and rate are those of the axis at both ends. Limit: exact for motions whose
acceleration is linear in time; across an acceleration
step of da inside the duration T the error is at most 0.0162 da T^2.</p>
<p>Source: C. de Boor, A Practical Guide to Splines, chapter IV.</p>
</html>"));
end CubicPath;
