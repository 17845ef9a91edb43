within AxisRig.Validation;
model SixJointRobot "A robot that turns all its joints"
  extends Icons.Experiment;
  Kinematics.SixJointRobot robot(reach = 11e-3, hd1 = 50e-3, hd2 = 4e-3, hd3 = -5e-3, hd4 = 0.3, hd5 = -0.2,
    hd6 = 0.5, hd7 = 0.45, hd8 = 0.6, hd9 = 0.64, hd10 = 0.1, hd11 = 0.15, hd12 = 0.1, hd14 = 0.02, hd15 = -0.03)
    "Robot under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position point_x "Clamping point: x";
  output Units.Position point_y "Clamping point: y";
  output Units.Position point_z "Clamping point: z";
  output Units.Direction direction_x "Direction of the tool: x";
  output Units.Direction direction_y "Direction of the tool: y";
  output Units.Direction direction_z "Direction of the tool: z";
equation
  robot.joint_1 = -3 + 6*time;
  robot.joint_2 = -1 + 2*time;
  robot.joint_3 = 1.5 - 2*time;
  robot.joint_4 = -4 + 9*time;
  robot.joint_5 = -1 + 2.5*time;
  robot.joint_6 = 2 - 7*time;
  point_x = robot.point_x;
  point_y = robot.point_y;
  point_z = robot.point_z;
  direction_x = robot.direction_x;
  direction_y = robot.direction_y;
  direction_z = robot.direction_z;
  annotation(
    experiment(StopTime=1, Interval=1.3e-2),
    Documentation(info="<html>
<p>The wrist goes through its stretched pose. Compared: clamping point and direction.</p>
</html>"));
end SixJointRobot;
