within AxisRig.Sensors;
model TouchProbe "Touch probe against a plane, with edges located inside the step"
  extends MovingSensor;
  parameter Units.Direction normal_x = 0 "Normal of the plane, towards free space: x";
  parameter Units.Direction normal_y = 0 "Normal of the plane, towards free space: y";
  parameter Units.Direction normal_z = 1 "Normal of the plane, towards free space: z";
  parameter Units.Position surface = 0.1 "Distance of the plane from the origin along its normal";
  parameter Units.Length ball_radius = 0 "Radius of the stylus ball";
  parameter Units.Length pretravel = 0 "Deflection from contact to the switching point, everywhere";
  parameter Units.Force seat_force = 0 "Of the three-leg seat; adds pre-travel by direction";
  parameter Units.Length stylus_length = 50e-3 "From the plane of the pads to the ball centre";
  parameter Units.Length seat_radius(min = 1e-4) = 10e-3 "Of the circle of the pads";
  parameter Units.Angle seat_angle = 0 "Direction of the first pad from x";
  parameter Units.Stiffness bending_stiffness(min = 1) = 0.2e6 "Of the stylus across its axis";
  parameter Units.Stiffness axial_stiffness(min = 1) = 2e6 "Of the stylus along its axis";
  parameter Units.Time trigger_delay(min = 0) = 0 "From the switching point to the edge";
  parameter Boolean inverted = false "Signal is true while the probe is free";

  output Boolean signal "Switching output";
  output Units.Time rising_time "Instant of the last rising edge of the signal";
  output Units.Time falling_time "Instant of the last falling edge of the signal";
  output Integer rising_count "Rising edges of the signal since the start";
  output Integer falling_count "Falling edges of the signal since the start";
  output Boolean contact "The ball touches the plane";
  output Units.Time contact_time(start = 0, fixed = true) "Last instant at which the gap closed";
  output Integer contact_count(start = 0, fixed = true) "How often the gap has closed";
  output Units.Position contact_x(start = 0, fixed = true) "x at contact_time";
  output Units.Position contact_y(start = 0, fixed = true) "y at contact_time";
  output Units.Position contact_z(start = 0, fixed = true) "z at contact_time";
  output Units.Position gap "Distance of the ball from the plane";
  output Units.Length total_pretravel "In the direction of the plane";
  output Units.Length clearance
    "Distance that the ball can move without any edge; 0 while one is under way";
protected
  constant Units.Length rounding = 1e-13 "By how much two steps may disagree where they meet";
  ThreeLegSeat seat(
    force = seat_force,
    length = stylus_length,
    radius = seat_radius,
    angle = seat_angle,
    bending = bending_stiffness,
    axial = axial_stiffness);
  Boolean deflected "Deflected beyond the switching point";
  Boolean deflected_at_start "Deflected when the simulation began";
  EdgeDelay path(delay = trigger_delay);
  EdgeCounter rising;
  EdgeCounter falling;
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
  rising_time = rising.last;
  rising_count = rising.count;
  falling_time = falling.last;
  falling_count = falling.count;
  assert(abs(normal_x^2 + normal_y^2 + normal_z^2 - 1) < 1e-9,
    "normal_x, normal_y, normal_z must be a unit vector");
  annotation(
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
trigger delay stands for switching electronics and transmission.</p>
</html>"));
end TouchProbe;
