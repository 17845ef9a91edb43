within AxisRig.Kinematics;
block SixJointRobot "Robot with six joints and a central wrist (kinematic 45)"
  extends ToolPoint;
  parameter Units.Position hd1 = 0 "From the flange to the tool, along the flange normal"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd2 = 0 "From the flange to the tool, along x of the tool"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd3 = 0 "From the flange to the tool, along y of the tool"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Angle hd4 = 0 "Turns the tool at the flange about x"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Angle hd5 = 0 "Turns the tool at the flange about y"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Angle hd6 = 0 "Turns the tool at the flange about z"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd7 = 0 "Height of joint 2"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd8 = 0 "Length of the upper arm"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd9 = 0 "Length of the forearm, to the wrist"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd10 = 0 "From the wrist to the flange"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd11 = 0 "From joint 1 to joint 2, outwards"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Position hd12 = 0 "From joint 3 down to the line of the forearm"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Angle hd14 = 0 "Shift of the zero of joint 2"
    annotation(Dialog(group = "Offsets"));
  parameter Units.Angle hd15 = 0 "Shift of the zero of joint 3"
    annotation(Dialog(group = "Offsets"));
  Interfaces.AngleInput joint_1 "Turns about Z"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.AngleInput joint_2 "Turns about Y: upper arm"
    annotation(Placement(transformation(extent = {{-120, 44}, {-100, 64}})));
  Interfaces.AngleInput joint_3 "Turns about Y: forearm"
    annotation(Placement(transformation(extent = {{-120, 8}, {-100, 28}})));
  Interfaces.AngleInput joint_4 "Turns about the forearm"
    annotation(Placement(transformation(extent = {{-120, -28}, {-100, -8}})));
  Interfaces.AngleInput joint_5 "Turns the wrist about Y"
    annotation(Placement(transformation(extent = {{-120, -64}, {-100, -44}})));
  Interfaces.AngleInput joint_6 "Turns the flange about its normal"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
protected
  final parameter Real tool_x(unit = "1") =
    cos(hd6)*cos(hd4)*sin(hd5) + sin(hd6)*sin(hd4) "x of the direction of the tool at the flange";
  final parameter Real tool_y(unit = "1") =
    sin(hd6)*cos(hd4)*sin(hd5) - cos(hd6)*sin(hd4) "y of the direction of the tool at the flange";
  final parameter Real tool_z(unit = "1") = cos(hd4)*cos(hd5)
    "z of the direction of the tool at the flange";
  Real arm[3](each unit = "1") "Direction of the upper arm";
  Real forward[3](each unit = "1") "Direction of the forearm";
  Real side[3](each unit = "1") "Axis of the joints 2 and 3";
  Real up[3](each unit = "1") "Across the forearm, upwards in the zero pose";
  Real turned_side[3](each unit = "1") "side, turned by joint 4";
  Real turned_up[3](each unit = "1") "up, turned by joint 4";
  Real normal[3](each unit = "1") "Normal of the flange";
  Real bent_up[3](each unit = "1") "turned_up, turned by joint 5";
  Real flange_side[3](each unit = "1") "y of the tool at the flange";
  Real flange_up[3](each unit = "1") "x of the tool at the flange";
  Real outwards[3](each unit = "1") "Direction of the arm seen from above, in the zero pose of joint 2";
  Real vertical[3](each unit = "1") "Upwards";
  Real u[3](each unit = "1") "Direction of the tool";
  Units.Position point[3] "Clamping point";
equation
  outwards[1] = cos(joint_1);
  outwards[2] = sin(joint_1);
  outwards[3] = 0;
  side[1] = -outwards[2];
  side[2] = outwards[1];
  side[3] = 0;
  vertical[1] = 0;
  vertical[2] = 0;
  vertical[3] = 1;
  for i in 1:3 loop
    arm[i] = outwards[i]*sin(joint_2 + hd14) + vertical[i]*cos(joint_2 + hd14);
    forward[i] = outwards[i]*cos(joint_2 + hd14 + joint_3 + hd15)
      - vertical[i]*sin(joint_2 + hd14 + joint_3 + hd15);
    up[i] = outwards[i]*sin(joint_2 + hd14 + joint_3 + hd15)
      + vertical[i]*cos(joint_2 + hd14 + joint_3 + hd15);
    turned_side[i] = side[i]*cos(joint_4) + up[i]*sin(joint_4);
    turned_up[i] = up[i]*cos(joint_4) - side[i]*sin(joint_4);
    normal[i] = forward[i]*cos(joint_5) - turned_up[i]*sin(joint_5);
    bent_up[i] = forward[i]*sin(joint_5) + turned_up[i]*cos(joint_5);
    flange_side[i] = turned_side[i]*cos(joint_6) + bent_up[i]*sin(joint_6);
    flange_up[i] = bent_up[i]*cos(joint_6) - turned_side[i]*sin(joint_6);
    u[i] = flange_up[i]*tool_x + flange_side[i]*tool_y - normal[i]*tool_z;
    point[i] = outwards[i]*hd11 + vertical[i]*hd7 + arm[i]*hd8 + forward[i]*hd9 - up[i]*hd12
      + normal[i]*(hd10 + hd1) + flange_up[i]*hd2 + flange_side[i]*hd3 - u[i]*reach;
  end for;
  point_x = point[1];
  point_y = point[2];
  point_z = point[3];
  direction_x = u[1];
  direction_y = u[2];
  direction_z = u[3];
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-80, -80}, {-40, -50}}, fillColor = {160, 160, 160},
          fillPattern = FillPattern.Solid),
      Line(points = {{-60, -50}, {-40, 50}, {40, 40}}, color = {0, 0, 0}, thickness = 1),
      Line(points = {{40, 40}, {50, 0}}, color = {0, 0, 0}, thickness = 1),
      Line(points = {{50, 0}, {58, -60}}, color = {255, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: zero pose with the upper arm upwards and the forearm along +X. Joint 2 is at Rz(q1) (HD11, 0,
HD7); the upper arm follows with HD8 along Ry(q2 + HD14) e_z, the forearm with (HD9, 0, -HD12) in the frame
turned by Ry(q3 + HD15) more, the flange with HD10 along the normal after Rx(q4) Ry(q5) Rx(q6). At the flange
the frame turned by Ry(-90 degrees) has HD2, HD3 and -HD1, and the tool points from its centre
point to the clamping point along z of that frame turned by Rz(HD6) Ry(HD5) Rx(HD4). reach goes along the
tool.</p>
<p>Assumption: rigid arms. Limit: none. Source: offsets of kinematic 45 of the manuals; zero pose and signs are
a decision of this project (docs/ambiguities.md).</p>
</html>"));
end SixJointRobot;
