within AxisRig.Sensors;
model HeadDistanceSensor "Distance sensor at a head with the axes X, Y, Z, C, A over a workpiece"
  extends TiltedSensor;
  Interfaces.PositionInput x_start "Axis X at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 65}, {-100, 71}})));
  Interfaces.VelocityInput x_rate_start "Rate of Axis X at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 56}, {-100, 62}})));
  Interfaces.PositionInput x_end "Axis X at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 48}, {-100, 54}})));
  Interfaces.VelocityInput x_rate_end "Rate of Axis X at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 39}, {-100, 45}})));
  Interfaces.PositionInput y_start "Axis Y at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 31}, {-100, 37}})));
  Interfaces.VelocityInput y_rate_start "Rate of Axis Y at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 22}, {-100, 28}})));
  Interfaces.PositionInput y_end "Axis Y at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 14}, {-100, 20}})));
  Interfaces.VelocityInput y_rate_end "Rate of Axis Y at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 5}, {-100, 11}})));
  Interfaces.PositionInput z_start "Axis Z at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -3}, {-100, 3}})));
  Interfaces.VelocityInput z_rate_start "Rate of Axis Z at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -12}, {-100, -6}})));
  Interfaces.PositionInput z_end "Axis Z at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -20}, {-100, -14}})));
  Interfaces.VelocityInput z_rate_end "Rate of Axis Z at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -29}, {-100, -23}})));
  Interfaces.AngleInput c_start "Axis C at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -37}, {-100, -31}})));
  Interfaces.AngularVelocityInput c_rate_start "Rate of Axis C at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -46}, {-100, -40}})));
  Interfaces.AngleInput c_end "Axis C at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -54}, {-100, -48}})));
  Interfaces.AngularVelocityInput c_rate_end "Rate of Axis C at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -63}, {-100, -57}})));
  Interfaces.AngleInput a_start "Axis A at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -71}, {-100, -65}})));
  Interfaces.AngularVelocityInput a_rate_start "Rate of Axis A at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -80}, {-100, -74}})));
  Interfaces.AngleInput a_end "Axis A at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -88}, {-100, -82}})));
  Interfaces.AngularVelocityInput a_rate_end "Rate of Axis A at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -97}, {-100, -91}})));
  Kinematics.HeadCA head "From the axes to the clamping point"
    annotation(Placement(transformation(extent = {{-14, 6}, {14, 34}})));
protected
  CubicPath x "Axis X"
    annotation(Placement(transformation(extent = {{-90, 44}, {-70, 64}})));
  CubicPath y "Axis Y"
    annotation(Placement(transformation(extent = {{-60, 44}, {-40, 64}})));
  CubicPath z "Axis Z"
    annotation(Placement(transformation(extent = {{-30, 44}, {-10, 64}})));
  CubicAngle c "Axis C"
    annotation(Placement(transformation(extent = {{0, 44}, {20, 64}})));
  CubicAngle a "Axis A"
    annotation(Placement(transformation(extent = {{30, 44}, {50, 64}})));
equation
  x.start = x_start;
  x.start_rate = x_rate_start;
  x.finish = x_end;
  x.finish_rate = x_rate_end;
  x.span = step_size;
  x.passed = passed;
  head.x = x.position;
  y.start = y_start;
  y.start_rate = y_rate_start;
  y.finish = y_end;
  y.finish_rate = y_rate_end;
  y.span = step_size;
  y.passed = passed;
  head.y = y.position;
  z.start = z_start;
  z.start_rate = z_rate_start;
  z.finish = z_end;
  z.finish_rate = z_rate_end;
  z.span = step_size;
  z.passed = passed;
  head.z = z.position;
  c.start = c_start;
  c.start_rate = c_rate_start;
  c.finish = c_end;
  c.finish_rate = c_rate_end;
  c.span = step_size;
  c.passed = passed;
  head.c = c.angle;
  a.start = a_start;
  a.start_rate = a_rate_start;
  a.finish = a_end;
  a.finish_rate = a_rate_end;
  a.span = step_size;
  a.passed = passed;
  head.a = a.angle;
  clamping_x = head.point_x;
  clamping_y = head.point_y;
  clamping_z = head.point_z;
  u_x = head.direction_x;
  u_y = head.direction_y;
  u_z = head.direction_z;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-55, 55}, {-25, 90}}, fillColor = {160, 160, 160},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-60, 60}, {-20, 75}, {10, 20}, {-10, 10}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 15}, {35, -60}}, color = {255, 0, 0}),
      Rectangle(extent = {{-80, -80}, {80, -60}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: the axes move on cubics over the step (CubicPath, CubicAngle); Kinematics.HeadCA gives the
clamping point and the direction of the tool, TiltedSensor everything else.</p>
<p>Assumptions: the sensor does not act back on the axes; axes without errors of their own. Limits: see
TiltedSensor. Source: offsets of kinematic 9 (HeadCA); 3D distance control wants the orthogonal distance of the
clamping point.</p>
</html>"));
end HeadDistanceSensor;
