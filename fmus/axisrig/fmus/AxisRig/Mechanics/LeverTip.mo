within AxisRig.Mechanics;
model LeverTip "End of a lever that hangs on a turning axis below a vertical slide"
  parameter Units.Length lever = 0.18 "From the turning axis to the end"
    annotation(Dialog(group = "Parameters"));
  Interfaces.Flange slide "Slide, upwards"
    annotation(Placement(transformation(extent = {{-110, 40}, {-90, 60}})));
  Interfaces.Flange rim "Turning axis, at a radius of 1 m"
    annotation(Placement(transformation(extent = {{90, 40}, {110, 60}})));
  Interfaces.Flange tip "End of the lever, upwards"
    annotation(Placement(transformation(extent = {{-10, -110}, {10, -90}})));
protected
  constant Units.Length arm = 1 "Radius of the rim";
equation
  tip.s = slide.s - lever*cos(rim.s/arm);
  slide.f = -tip.f;
  rim.f = -tip.f*lever/arm*sin(rim.s/arm);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-25, 25}, {25, 75}}, fillColor = {160, 160, 160},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 50}, {40, -80}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: h = s - L cos(a) with the angle a of the lever from the vertical; a force at the end acts on the
slide as it is, and on the axis with L sin(a), the derivative of h by a.</p>
<p>Assumption: rigid and without mass (that of the lever belongs to the axis). Limit: one direction, the
vertical. Source: principle of virtual work.</p>
</html>"));
end LeverTip;
