within AxisRig.Sensors;
model RobotDistanceSensor "Distance sensor at a robot with six joints over a workpiece"
  extends TiltedSensor;
  Interfaces.AngleInput j1_start "Joint 1 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 65}, {-100, 71}})));
  Interfaces.AngularVelocityInput j1_rate_start "Rate of joint 1 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 58}, {-100, 64}})));
  Interfaces.AngleInput j1_end "Joint 1 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 51}, {-100, 57}})));
  Interfaces.AngularVelocityInput j1_rate_end "Rate of joint 1 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 44}, {-100, 50}})));
  Interfaces.AngleInput j2_start "Joint 2 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 37}, {-100, 43}})));
  Interfaces.AngularVelocityInput j2_rate_start "Rate of joint 2 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 30}, {-100, 36}})));
  Interfaces.AngleInput j2_end "Joint 2 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 23}, {-100, 29}})));
  Interfaces.AngularVelocityInput j2_rate_end "Rate of joint 2 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 16}, {-100, 22}})));
  Interfaces.AngleInput j3_start "Joint 3 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 9}, {-100, 15}})));
  Interfaces.AngularVelocityInput j3_rate_start "Rate of joint 3 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 2}, {-100, 8}})));
  Interfaces.AngleInput j3_end "Joint 3 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -5}, {-100, 1}})));
  Interfaces.AngularVelocityInput j3_rate_end "Rate of joint 3 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -12}, {-100, -6}})));
  Interfaces.AngleInput j4_start "Joint 4 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -20}, {-100, -14}})));
  Interfaces.AngularVelocityInput j4_rate_start "Rate of joint 4 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -27}, {-100, -21}})));
  Interfaces.AngleInput j4_end "Joint 4 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -34}, {-100, -28}})));
  Interfaces.AngularVelocityInput j4_rate_end "Rate of joint 4 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -41}, {-100, -35}})));
  Interfaces.AngleInput j5_start "Joint 5 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -48}, {-100, -42}})));
  Interfaces.AngularVelocityInput j5_rate_start "Rate of joint 5 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -55}, {-100, -49}})));
  Interfaces.AngleInput j5_end "Joint 5 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -62}, {-100, -56}})));
  Interfaces.AngularVelocityInput j5_rate_end "Rate of joint 5 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -69}, {-100, -63}})));
  Interfaces.AngleInput j6_start "Joint 6 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -76}, {-100, -70}})));
  Interfaces.AngularVelocityInput j6_rate_start "Rate of joint 6 at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -83}, {-100, -77}})));
  Interfaces.AngleInput j6_end "Joint 6 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -90}, {-100, -84}})));
  Interfaces.AngularVelocityInput j6_rate_end "Rate of joint 6 at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -97}, {-100, -91}})));
  Kinematics.SixJointRobot robot "From the joints to the clamping point"
    annotation(Placement(transformation(extent = {{-14, 6}, {14, 34}})));
protected
  CubicAngle j1 "Joint 1"
    annotation(Placement(transformation(extent = {{-90, 44}, {-70, 64}})));
  CubicAngle j2 "Joint 2"
    annotation(Placement(transformation(extent = {{-65, 44}, {-45, 64}})));
  CubicAngle j3 "Joint 3"
    annotation(Placement(transformation(extent = {{-40, 44}, {-20, 64}})));
  CubicAngle j4 "Joint 4"
    annotation(Placement(transformation(extent = {{-15, 44}, {5, 64}})));
  CubicAngle j5 "Joint 5"
    annotation(Placement(transformation(extent = {{10, 44}, {30, 64}})));
  CubicAngle j6 "Joint 6"
    annotation(Placement(transformation(extent = {{35, 44}, {55, 64}})));
equation
  j1.start = j1_start;
  j1.start_rate = j1_rate_start;
  j1.finish = j1_end;
  j1.finish_rate = j1_rate_end;
  j1.span = step_size;
  j1.passed = passed;
  robot.joint_1 = j1.angle;
  j2.start = j2_start;
  j2.start_rate = j2_rate_start;
  j2.finish = j2_end;
  j2.finish_rate = j2_rate_end;
  j2.span = step_size;
  j2.passed = passed;
  robot.joint_2 = j2.angle;
  j3.start = j3_start;
  j3.start_rate = j3_rate_start;
  j3.finish = j3_end;
  j3.finish_rate = j3_rate_end;
  j3.span = step_size;
  j3.passed = passed;
  robot.joint_3 = j3.angle;
  j4.start = j4_start;
  j4.start_rate = j4_rate_start;
  j4.finish = j4_end;
  j4.finish_rate = j4_rate_end;
  j4.span = step_size;
  j4.passed = passed;
  robot.joint_4 = j4.angle;
  j5.start = j5_start;
  j5.start_rate = j5_rate_start;
  j5.finish = j5_end;
  j5.finish_rate = j5_rate_end;
  j5.span = step_size;
  j5.passed = passed;
  robot.joint_5 = j5.angle;
  j6.start = j6_start;
  j6.start_rate = j6_rate_start;
  j6.finish = j6_end;
  j6.finish_rate = j6_rate_end;
  j6.span = step_size;
  j6.passed = passed;
  robot.joint_6 = j6.angle;
  clamping_x = robot.point_x;
  clamping_y = robot.point_y;
  clamping_z = robot.point_z;
  u_x = robot.direction_x;
  u_y = robot.direction_y;
  u_z = robot.direction_z;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -60}, {-70, 40}, {-20, 70}}, color = {0, 0, 0}, thickness = 1),
      Polygon(points = {{-30, 60}, {-5, 75}, {15, 20}, {0, 10}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{8, 15}, {40, -60}}, color = {255, 0, 0}),
      Rectangle(extent = {{-80, -80}, {80, -60}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: the joints move on cubics over the step (CubicAngle); Kinematics.SixJointRobot gives the clamping
point and the direction of the tool, TiltedSensor everything else.</p>
<p>Assumptions: the sensor does not act back on the joints; rigid arms. Limits: see TiltedSensor. Source: offsets
of kinematic 45 (SixJointRobot); 3D distance control wants the orthogonal distance of the clamping point.</p>
</html>"));
end RobotDistanceSensor;
