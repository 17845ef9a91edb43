within AxisRig.Kinematics;
block HeadCA "Head with the rotary axes C and A on three linear axes (kinematic 9)"
  extends ToolPoint;
  parameter Units.Position hd1 = 0 "Along the tool, from the A axis on"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd2 = 0 "Down from the reference point to the A axis"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Angle hd3 = 0 "Shift of the zero of A"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Angle hd4 = 0 "Shift of the zero of C"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd5 = 0 "From the C axis to the A axis, along y at C = 0"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd6 = 0 "From the C axis to the A axis, along x at C = 0"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd7 = 0 "From the reference point to the C axis: x"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd8 = 0 "From the reference point to the C axis: y"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd9 = 0 "From the A axis to the line of the tool, along y at C = A = 0"
    annotation(Dialog(group = "Offsets"));
  Interfaces.PositionInput x "Axis X"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.PositionInput y "Axis Y"
    annotation(Placement(transformation(extent = {{-120, 35}, {-100, 55}})));
  Interfaces.PositionInput z "Axis Z"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.AngleInput c "Axis C, turns about Z"
    annotation(Placement(transformation(extent = {{-120, -55}, {-100, -35}})));
  Interfaces.AngleInput a "Axis A, turns about X at C = 0"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
protected
  Real cos_c(unit = "1") "Cosine of C";
  Real sin_c(unit = "1") "Sine of C";
  Real cos_a(unit = "1") "Cosine of A";
  Real sin_a(unit = "1") "Sine of A";
  Units.Position across "From the C axis to the clamping point, along y at C = 0";
equation
  cos_c = cos(c + hd4);
  sin_c = sin(c + hd4);
  cos_a = cos(a + hd3);
  sin_a = sin(a + hd3);
  across = hd5 + hd9*cos_a + (hd1 + reach)*sin_a;
  point_x = x + hd7 + cos_c*hd6 - sin_c*across;
  point_y = y + hd8 + sin_c*hd6 + cos_c*across;
  point_z = z - hd2 + hd9*sin_a - (hd1 + reach)*cos_a;
  direction_x = sin_c*sin_a;
  direction_y = -cos_c*sin_a;
  direction_z = cos_a;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-15, 40}, {15, 80}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-20, 10}, {20, 50}}, fillColor = {160, 160, 160},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 30}, {40, -40}}, color = {0, 0, 0}, thickness = 1),
      Line(points = {{40, -40}, {60, -75}}, color = {255, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: with c = C + HD4 and a = A + HD3 the tool points from its centre point to the clamping
point along u = Rz(c) Rx(a) e_z, and the clamping point is (X, Y, Z) + (HD7, HD8, 0)
+ Rz(c) [(HD6, HD5, -HD2) + Rx(a) (0, HD9, -(HD1 + reach))].</p>
<p>Assumption: axes without errors of their own. Limit: none. Source: offsets of kinematic 9 of the manuals;
their signs are a decision of this project (docs/ambiguities.md).</p>
</html>"));
end HeadCA;
