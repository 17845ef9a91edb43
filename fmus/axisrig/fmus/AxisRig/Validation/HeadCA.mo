within AxisRig.Validation;
model HeadCA "A head that turns all round"
  extends Icons.Experiment;
  Kinematics.HeadCA head(reach = 51e-3, hd1 = 21e-3, hd2 = 17e-3, hd3 = 0.05, hd4 = -0.07, hd5 = 8e-3, hd6 = -6e-3,
    hd7 = 4e-3, hd8 = 3e-3, hd9 = 12e-3)
    "Head under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position point_x "Clamping point: x";
  output Units.Position point_y "Clamping point: y";
  output Units.Position point_z "Clamping point: z";
  output Units.Direction direction_x "Direction of the tool: x";
  output Units.Direction direction_y "Direction of the tool: y";
  output Units.Direction direction_z "Direction of the tool: z";
equation
  head.x = 0.3*time;
  head.y = 0.1 - 0.2*time;
  head.z = 0.4*time^2;
  head.c = -4 + 8*time;
  head.a = 2 - 5*time;
  point_x = head.point_x;
  point_y = head.point_y;
  point_z = head.point_z;
  direction_x = head.direction_x;
  direction_y = head.direction_y;
  direction_z = head.direction_z;
  annotation(
    experiment(StopTime=1, Interval=1.3e-2),
    Documentation(info="<html>
<p>C turns more than once, A through 0 and beyond 90 degrees. Compared: clamping point and direction.</p>
</html>"));
end HeadCA;
