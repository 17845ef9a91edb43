within AxisRig.Sensors;
model TouchProbe "Touch probe against a plane, with edges located inside the step"
  extends MovingSensor;
  parameter Units.Direction normal_x = 0 "Normal of the plane, towards free space: x"
    annotation(Dialog(group = "Plane"));
  parameter Units.Direction normal_y = 0 "Normal of the plane, towards free space: y"
    annotation(Dialog(group = "Plane"));
  parameter Units.Direction normal_z = 1 "Normal of the plane, towards free space: z"
    annotation(Dialog(group = "Plane"));
  parameter Units.Position surface = 0.1 "Distance of the plane from the origin along its normal"
    annotation(Dialog(group = "Plane"));
  parameter Units.Length ball_radius = 0 "Radius of the stylus ball"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length pretravel = 0 "Deflection from contact to the switching point, everywhere"
    annotation(Dialog(group = "Signal"));
  parameter Units.Force seat_force = 0 "Of the three-leg seat; adds pre-travel by direction"
    annotation(Dialog(group = "Three-leg seat"));
  parameter Units.Length stylus_length = 50e-3 "From the plane of the pads to the ball centre"
    annotation(Dialog(group = "Three-leg seat"));
  parameter Units.Length seat_radius(min = 1e-4) = 10e-3 "Of the circle of the pads"
    annotation(Dialog(group = "Three-leg seat"));
  parameter Units.Angle seat_angle = 0 "Direction of the first pad from x"
    annotation(Dialog(group = "Three-leg seat"));
  parameter Units.Stiffness bending_stiffness(min = 1) = 0.2e6 "Of the stylus across its axis"
    annotation(Dialog(group = "Three-leg seat"));
  parameter Units.Stiffness axial_stiffness(min = 1) = 2e6 "Of the stylus along its axis"
    annotation(Dialog(group = "Three-leg seat"));
  parameter Units.Time trigger_delay(min = 0) = 0 "From the switching point to the edge"
    annotation(Dialog(group = "Signal"));
  parameter Boolean inverted = false "Signal is true while the probe is free"
    annotation(Dialog(group = "Signal"));

  Interfaces.BooleanOutput signal "Switching output"
    annotation(Placement(transformation(extent = {{100, 84}, {112, 96}})));
  Interfaces.TimeOutput rising_time "Instant of the last rising edge of the signal"
    annotation(Placement(transformation(extent = {{100, 70}, {112, 82}})));
  Interfaces.TimeOutput falling_time "Instant of the last falling edge of the signal"
    annotation(Placement(transformation(extent = {{100, 56}, {112, 68}})));
  Interfaces.IntegerOutput rising_count "Rising edges of the signal since the start"
    annotation(Placement(transformation(extent = {{100, 42}, {112, 54}})));
  Interfaces.IntegerOutput falling_count "Falling edges of the signal since the start"
    annotation(Placement(transformation(extent = {{100, 29}, {112, 41}})));
  Interfaces.BooleanOutput contact "The ball touches the plane"
    annotation(Placement(transformation(extent = {{100, 15}, {112, 27}})));
  Interfaces.TimeOutput contact_time(start = 0, fixed = true)
    "Last instant at which the gap closed"
    annotation(Placement(transformation(extent = {{100, 1}, {112, 13}})));
  Interfaces.IntegerOutput contact_count(start = 0, fixed = true) "How often the gap has closed"
    annotation(Placement(transformation(extent = {{100, -13}, {112, -1}})));
  Interfaces.PositionOutput contact_x(start = 0, fixed = true) "x at contact_time"
    annotation(Placement(transformation(extent = {{100, -27}, {112, -15}})));
  Interfaces.PositionOutput contact_y(start = 0, fixed = true) "y at contact_time"
    annotation(Placement(transformation(extent = {{100, -41}, {112, -29}})));
  Interfaces.PositionOutput contact_z(start = 0, fixed = true) "z at contact_time"
    annotation(Placement(transformation(extent = {{100, -54}, {112, -42}})));
  Interfaces.PositionOutput gap "Distance of the ball from the plane"
    annotation(Placement(transformation(extent = {{100, -68}, {112, -56}})));
  Interfaces.LengthOutput total_pretravel "In the direction of the plane"
    annotation(Placement(transformation(extent = {{100, -82}, {112, -70}})));
  Interfaces.LengthOutput clearance
    "Distance that the ball can move without any edge; 0 while one is under way"
    annotation(Placement(transformation(extent = {{100, -96}, {112, -84}})));
protected
  constant Units.Length rounding = 1e-13 "By how much two steps may disagree where they meet";
  ThreeLegSeat seat(
    force = seat_force,
    length = stylus_length,
    radius = seat_radius,
    angle = seat_angle,
    bending = bending_stiffness,
    axial = axial_stiffness)
    "Seat of the stylus"
    annotation(Placement(transformation(extent = {{-74, -54}, {-46, -26}})));
  Boolean deflected "Deflected past the switching point";
  Boolean deflected_at_start "Deflected when the simulation began";
  EdgeDelay path(dead_time = trigger_delay) "From the switching point to the edge"
    annotation(Placement(transformation(extent = {{-34, -54}, {-6, -26}})));
  EdgeCounter rising "Counts rising edges"
    annotation(Placement(transformation(extent = {{6, -54}, {34, -26}})));
  EdgeCounter falling "Counts falling edges"
    annotation(Placement(transformation(extent = {{46, -54}, {74, -26}})));
initial equation
  pre(deflected_at_start) = gap + total_pretravel <= 0;
equation
  seat.normal_x = normal_x;
  seat.normal_y = normal_y;
  seat.normal_z = normal_z;
  total_pretravel = pretravel + seat.pretravel;
  gap = normal_x*x.position + normal_y*y.position + normal_z*z.position - surface - ball_radius;
  contact = gap <= (if pre(contact) then rounding else 0);
  deflected = gap + total_pretravel <= (if pre(deflected) then rounding else 0);
  when contact then
    contact_time = time;
    contact_count = pre(contact_count) + 1;
    contact_x = x.position;
    contact_y = y.position;
    contact_z = z.position;
  end when;
  deflected_at_start = pre(deflected_at_start);
  path.u = deflected;
  path.u_start = deflected_at_start;
  clearance = if path.waiting then 0 else min(abs(gap), abs(gap + total_pretravel));
  signal = path.y <> inverted;
  rising.u = signal;
  falling.u = not signal;
  connect(rising.last, rising_time)
    annotation(Line(points = {{35, -53}, {68, -53}, {68, 76}, {100, 76}}, color = {0, 0, 127}));
  rising_count = rising.count;
  connect(falling.last, falling_time)
    annotation(Line(points = {{75, -53}, {88, -53}, {88, 62}, {100, 62}}, color = {0, 0, 127}));
  falling_count = falling.count;
  assert(abs(normal_x^2 + normal_y^2 + normal_z^2 - 1) < 1e-9,
    "normal_x, normal_y, normal_z must be a unit vector");
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-15, 30}, {15, 80}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 30}, {0, -30}}, color = {0, 0, 0}),
      Ellipse(extent = {{-12, -54}, {12, -30}}, fillColor = {255, 0, 0},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-80, -80}, {80, -56}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: gap = n.p - d - r. Contact at gap &lt;= 0, switching at gap &lt;= -total_pretravel; the
signal follows after trigger_delay. p is the motion of the axes over the communication step as a
cubic through both ends (CubicPath). total_pretravel = pretravel + what the three-leg seat adds in the
direction of the normal (ThreeLegSeat; none with seat_force 0).</p>
<p>clearance = min(|gap|, |gap + total_pretravel|): the ball can move that far in any direction before
contact or signal can change, because a plane comes nearer by at most the way of the ball.</p>
<p>Assumption: the probe does not act back on the axes. The gap must open by 1e-13 m before a contact
ends, so that rounding where two steps meet makes no edges; this shifts falling edges by 1e-13 m over
the speed. Limits: the level at the start is not an edge; a touch shorter than the internal step can
be missed; at most four edges of one direction within trigger_delay; no bounce (WorkpieceProbe has
it).</p>
<p>Source: ISO 230-10, probing systems of machine tools: pre-travel and its reproducible share; the
trigger delay covers switching electronics and transmission.</p>
</html>"));
end TouchProbe;
