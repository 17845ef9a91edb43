within AxisRig.Sensors;
model HeadTouchProbe "Touch probe at a head with the axes X, Y, Z, C, A, against a plane"
  Interfaces.TimeInput step_time "Beginning of the communication step"
    annotation(Placement(transformation(extent = {{-112, 86}, {-100, 98}})));
  Interfaces.TimeInput step_size(start = 1e-3, min = 1e-9) "Length of the communication step"
    annotation(Placement(transformation(extent = {{-112, 72}, {-100, 84}})));
  Interfaces.PositionInput x_start "Axis X at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 62}, {-100, 68}})));
  Interfaces.VelocityInput x_rate_start "Rate of axis X at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 54}, {-100, 60}})));
  Interfaces.PositionInput x_end "Axis X at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 46}, {-100, 52}})));
  Interfaces.VelocityInput x_rate_end "Rate of axis X at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 38}, {-100, 44}})));
  Interfaces.PositionInput y_start "Axis Y at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 30}, {-100, 36}})));
  Interfaces.VelocityInput y_rate_start "Rate of axis Y at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, 22}, {-100, 28}})));
  Interfaces.PositionInput y_end "Axis Y at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 14}, {-100, 20}})));
  Interfaces.VelocityInput y_rate_end "Rate of axis Y at the end of the step"
    annotation(Placement(transformation(extent = {{-106, 6}, {-100, 12}})));
  Interfaces.PositionInput z_start "Axis Z at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -2}, {-100, 4}})));
  Interfaces.VelocityInput z_rate_start "Rate of axis Z at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -10}, {-100, -4}})));
  Interfaces.PositionInput z_end "Axis Z at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -18}, {-100, -12}})));
  Interfaces.VelocityInput z_rate_end "Rate of axis Z at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -26}, {-100, -20}})));
  Interfaces.AngleInput c_start "Axis C at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -34}, {-100, -28}})));
  Interfaces.AngularVelocityInput c_rate_start "Rate of axis C at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -42}, {-100, -36}})));
  Interfaces.AngleInput c_end "Axis C at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -50}, {-100, -44}})));
  Interfaces.AngularVelocityInput c_rate_end "Rate of axis C at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -58}, {-100, -52}})));
  Interfaces.AngleInput a_start "Axis A at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -66}, {-100, -60}})));
  Interfaces.AngularVelocityInput a_rate_start "Rate of axis A at the beginning of the step"
    annotation(Placement(transformation(extent = {{-106, -74}, {-100, -68}})));
  Interfaces.AngleInput a_end "Axis A at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -82}, {-100, -76}})));
  Interfaces.AngularVelocityInput a_rate_end "Rate of axis A at the end of the step"
    annotation(Placement(transformation(extent = {{-106, -90}, {-100, -84}})));
  parameter Units.Length tool_length = 50e-3 "From the clamping point to the centre of the ball"
    annotation(Dialog(group = "Tool"));
  Interfaces.BooleanOutput signal "Switching output"
    annotation(Placement(transformation(extent = {{100, 92}, {106, 98}})));
  Interfaces.TimeOutput rising_time "Instant of the last rising edge of the signal"
    annotation(Placement(transformation(extent = {{100, 83}, {106, 89}})));
  Interfaces.TimeOutput falling_time "Instant of the last falling edge of the signal"
    annotation(Placement(transformation(extent = {{100, 74}, {106, 80}})));
  Interfaces.IntegerOutput rising_count "Rising edges of the signal since the start"
    annotation(Placement(transformation(extent = {{100, 65}, {106, 71}})));
  Interfaces.IntegerOutput falling_count "Falling edges of the signal since the start"
    annotation(Placement(transformation(extent = {{100, 56}, {106, 62}})));
  Interfaces.BooleanOutput contact "The ball touches the plane"
    annotation(Placement(transformation(extent = {{100, 47}, {106, 53}})));
  Interfaces.TimeOutput contact_time "Last instant at which the gap closed"
    annotation(Placement(transformation(extent = {{100, 38}, {106, 44}})));
  Interfaces.IntegerOutput contact_count "How often the gap has closed"
    annotation(Placement(transformation(extent = {{100, 29}, {106, 35}})));
  Interfaces.PositionOutput contact_x(start = 0, fixed = true) "Axis X at contact_time"
    annotation(Placement(transformation(extent = {{100, 20}, {106, 26}})));
  Interfaces.PositionOutput contact_y(start = 0, fixed = true) "Axis Y at contact_time"
    annotation(Placement(transformation(extent = {{100, 11}, {106, 17}})));
  Interfaces.PositionOutput contact_z(start = 0, fixed = true) "Axis Z at contact_time"
    annotation(Placement(transformation(extent = {{100, 2}, {106, 8}})));
  Interfaces.AngleOutput contact_c(start = 0, fixed = true) "Axis C at contact_time"
    annotation(Placement(transformation(extent = {{100, -7}, {106, -1}})));
  Interfaces.AngleOutput contact_a(start = 0, fixed = true) "Axis A at contact_time"
    annotation(Placement(transformation(extent = {{100, -16}, {106, -10}})));
  Interfaces.PositionOutput tcp_x "Centre of the ball: x"
    annotation(Placement(transformation(extent = {{100, -25}, {106, -19}})));
  Interfaces.PositionOutput tcp_y "Centre of the ball: y"
    annotation(Placement(transformation(extent = {{100, -34}, {106, -28}})));
  Interfaces.PositionOutput tcp_z "Centre of the ball: z"
    annotation(Placement(transformation(extent = {{100, -43}, {106, -37}})));
  Interfaces.PositionOutput contact_tcp_x "Centre of the ball at contact_time: x"
    annotation(Placement(transformation(extent = {{100, -52}, {106, -46}})));
  Interfaces.PositionOutput contact_tcp_y "Centre of the ball at contact_time: y"
    annotation(Placement(transformation(extent = {{100, -61}, {106, -55}})));
  Interfaces.PositionOutput contact_tcp_z "Centre of the ball at contact_time: z"
    annotation(Placement(transformation(extent = {{100, -70}, {106, -64}})));
  Interfaces.PositionOutput gap "Distance of the ball from the plane"
    annotation(Placement(transformation(extent = {{100, -79}, {106, -73}})));
  Interfaces.LengthOutput total_pretravel "In the direction of the plane"
    annotation(Placement(transformation(extent = {{100, -88}, {106, -82}})));
  Interfaces.LengthOutput clearance
    "How far the axes can move without any edge, 1 degree counted as 1 mm; 0 while one is under way"
    annotation(Placement(transformation(extent = {{100, -97}, {106, -91}})));
  TouchProbe probe "Probe at the tool centre point"
    annotation(Placement(transformation(extent = {{30, -20}, {70, 20}})));
  Kinematics.HeadCA head "From the axes to the clamping point"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
protected
  Real passed(unit = "1") "Share of the step that has passed";
  Units.Length lever "Largest distance of the ball from an axis of the head";
  Real lever_share(unit = "1") "Way of the ball for a millimetre of a rotary axis, at most";
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
  passed = (time - step_time)/step_size;
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
  tcp_x = head.point_x - tool_length*head.direction_x;
  tcp_y = head.point_y - tool_length*head.direction_y;
  tcp_z = head.point_z - tool_length*head.direction_z;
  // The cubics have been walked: the probe gets where the ball is now, at rest.
  probe.step_time = step_time;
  probe.step_size = step_size;
  probe.x_start = tcp_x;
  probe.x_rate_start = 0;
  probe.x_end = tcp_x;
  probe.x_rate_end = 0;
  contact_tcp_x = probe.contact_x;
  probe.y_start = tcp_y;
  probe.y_rate_start = 0;
  probe.y_end = tcp_y;
  probe.y_rate_end = 0;
  contact_tcp_y = probe.contact_y;
  probe.z_start = tcp_z;
  probe.z_rate_start = 0;
  probe.z_end = tcp_z;
  probe.z_rate_end = 0;
  contact_tcp_z = probe.contact_z;
  when probe.contact then
    contact_x = x.position;
    contact_y = y.position;
    contact_z = z.position;
    contact_c = c.angle;
    contact_a = a.angle;
  end when;
  signal = probe.signal;
  rising_time = probe.rising_time;
  falling_time = probe.falling_time;
  rising_count = probe.rising_count;
  falling_count = probe.falling_count;
  contact = probe.contact;
  contact_time = probe.contact_time;
  contact_count = probe.contact_count;
  gap = probe.gap;
  total_pretravel = probe.total_pretravel;
  lever = sqrt(head.hd6^2
    + (abs(head.hd5) + sqrt(head.hd9^2 + (head.hd1 + head.reach + tool_length)^2))^2);
  lever_share = lever*Constants.pi/180/1e-3;
  clearance = probe.clearance/sqrt(1 + 2*lever_share^2);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-55, 55}, {-25, 90}}, fillColor = {160, 160, 160},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-60, 60}, {-20, 75}, {10, 20}, {-10, 10}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 15}, {28, -42}}, color = {0, 0, 0}),
      Ellipse(extent = {{18, -60}, {38, -40}}, fillColor = {255, 0, 0},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-80, -80}, {80, -60}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: the axes move on cubics over the step (CubicPath, CubicAngle); Kinematics.HeadCA gives the clamping
point and the direction u of the tool; the centre of the ball is the clamping point less tool_length u. Contact
and edges are those of TouchProbe there; its parameters have its name before them: <code>probe.surface</code>.
At a contact the positions of the axes and the centre of the ball are kept.</p>
<p>clearance: a rotation by an angle moves the ball by the lever times it at most, the lever being the distance
from the axis. With all axes as coordinates and 1 degree as 1 mm, k = lever*pi/180 per millimetre, the ball goes
no farther than sqrt(1 + 2 k^2) times the way of the axes (Cauchy-Schwarz); the clearance of the probe is divided
by that.</p>
<p>Assumptions: the probe does not act back on the axes; axes without errors of their own. Its three-leg seat is
that of TouchProbe with the stylus along z of the machine, so use it with the tool upright only. Limits: those of
TouchProbe. Source: offsets of kinematic 9 (HeadCA); ISO 230-10 for the probe.</p>
</html>"));
end HeadTouchProbe;
