within AxisRig.Kinematics;
block ToolExtension "Virtual length of an inclined tool (kinematic 98)"
  parameter Units.Length nominal = 80e-3 "Length of the tool that is not inclined"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Angle hd2(min = 0, max = 1.6) = 1.5707963267948966
    "Inclination from which it is extended; 90 degrees: never"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Angle hd3(min = 0, max = 1.6) = 0
    "Inclination up to which it is extended; not above hd2: never"
    annotation(Dialog(group = "Offsets"));
  Interfaces.AngleInput tilt "Inclination of the tool against z"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.LengthOutput length "Length now"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
equation
  length = nominal*cos(hd2)/cos(max(hd2, min(hd3, tilt)));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -40}, {0, -40}, {60, 40}, {80, 40}}, color = {0, 0, 127}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: L up to the inclination HD2, L cos(HD2)/cos(t) up to HD3, at which the head keeps its height, and
frozen from there on.</p>
<p>Assumption: the beam has no length of its own. Limit: HD3 below 90 degrees. Source: minimum distance of the
manual of the distance control, kinematic 98.</p>
</html>"));
end ToolExtension;
