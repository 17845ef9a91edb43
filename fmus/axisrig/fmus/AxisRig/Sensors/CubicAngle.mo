within AxisRig.Sensors;
block CubicAngle "Rotation through two angles with given rates, as a cubic in time"
  Interfaces.AngleInput start "Angle at the beginning"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.AngularVelocityInput start_rate "Rate at the beginning"
    annotation(Placement(transformation(extent = {{-120, 44}, {-100, 64}})));
  Interfaces.AngleInput finish "Angle at the end"
    annotation(Placement(transformation(extent = {{-120, 8}, {-100, 28}})));
  Interfaces.AngularVelocityInput finish_rate "Rate at the end"
    annotation(Placement(transformation(extent = {{-120, -28}, {-100, -8}})));
  Interfaces.TimeInput span "Duration from beginning to end"
    annotation(Placement(transformation(extent = {{-120, -64}, {-100, -44}})));
  Interfaces.RealInput passed(unit = "1") "Share of the duration that has passed, 0..1"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.AngleOutput angle "Angle now"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
equation
  angle = start + passed*(span*start_rate
    + passed*((3*(finish - start) - span*(2*start_rate + finish_rate))
    + passed*(2*(start - finish) + span*(start_rate + finish_rate))));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -50}, {-40, -45}, {0, 0}, {40, 45}, {80, 50}}, color = {0, 0, 127},
          smooth = Smooth.Bezier),
      Ellipse(extent = {{-15, -15}, {15, 15}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: that of CubicPath, for a rotary axis.</p>
<p>Assumption: angle and rate are those of the axis at both ends. Limit: exact for rotations whose angular
acceleration is linear in time; across a step of it by da inside the duration T the error is at most
0.0162 da T^2.</p>
<p>Source: C. de Boor, A Practical Guide to Splines, chapter IV.</p>
</html>"));
end CubicAngle;
