within AxisRig.Sensors;
model WorkpieceProbe "Touch probe against a workpiece of any shape, with bounce, radio and switching on"
  extends MovingSensor;
  Interfaces.BooleanInput switched_on(start = true) "Probe switched on"
    annotation(Placement(transformation(origin = {0, 110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  parameter Units.Length ball_radius = 0 "Radius of the stylus ball"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length pretravel = 0 "Deflection from contact to the switching point, everywhere"
    annotation(Dialog(group = "Signal"));
  parameter Units.Length pretravel_scatter(min = 0) = 0
    "Standard deviation of the pre-travel from touch to touch"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Position first_touch = 0 "More pre-travel in the first touch of the run"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Position drift = 0 "More pre-travel with every touch"
    annotation(Dialog(group = "Noise and jitter"));
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
  parameter Units.Modulus contact_modulus = 0
    "Reduced modulus of ball and workpiece, which yield where they touch; 0: both are rigid"
    annotation(Dialog(group = "Three-leg seat"));
  parameter Units.Time trigger_delay(min = 0) = 0 "From the switching point to the edge"
    annotation(Dialog(group = "Signal"));
  parameter Units.Time radio_delay(min = 0) = 0 "Transmission to the receiver"
    annotation(Dialog(group = "Signal"));
  parameter Units.Time radio_jitter(min = 0) = 0 "Largest deviation of it to either side"
    annotation(Dialog(group = "Signal"));
  parameter Integer seed(min = 0, max = 1000000) = 1 "Of the deviations"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Integer bounce_count(min = 0, max = 100) = 0 "How often the signal opens after a touch"
    annotation(Dialog(group = "Signal"));
  parameter Integer release_bounce_count(min = 0, max = 100) = 0
    "How often it closes after a release"
    annotation(Dialog(group = "Signal"));
  parameter Units.Time bounce_time(min = 1e-9) = 1e-3 "From the first edge to the last"
    annotation(Dialog(group = "Signal"));
  parameter Units.Time switch_on_time(min = 0) = 0 "From switching on until the signal is valid"
    annotation(Dialog(group = "Signal"));
  parameter Boolean inverted = false "Signal is true while the probe is free"
    annotation(Dialog(group = "Signal"));
  Workpieces.Workpiece workpiece(points = 3, slopes = 3) "What lies below"
    annotation(Placement(transformation(extent = {{-74, -34}, {-46, -6}})));

  Interfaces.BooleanOutput signal "Switching output; false until the probe is ready"
    annotation(Placement(transformation(extent = {{100, 85}, {110, 95}})));
  Interfaces.TimeOutput rising_time "Instant of the last rising edge of the signal"
    annotation(Placement(transformation(extent = {{100, 72}, {110, 82}})));
  Interfaces.TimeOutput falling_time "Instant of the last falling edge of the signal"
    annotation(Placement(transformation(extent = {{100, 59}, {110, 69}})));
  Interfaces.IntegerOutput rising_count "Rising edges of the signal since the start"
    annotation(Placement(transformation(extent = {{100, 46}, {110, 56}})));
  Interfaces.IntegerOutput falling_count "Falling edges of the signal since the start"
    annotation(Placement(transformation(extent = {{100, 34}, {110, 44}})));
  Interfaces.BooleanOutput contact "The ball touches the workpiece"
    annotation(Placement(transformation(extent = {{100, 21}, {110, 31}})));
  Interfaces.TimeOutput contact_time(start = 0, fixed = true)
    "Last instant at which the gap closed"
    annotation(Placement(transformation(extent = {{100, 8}, {110, 18}})));
  Interfaces.IntegerOutput contact_count(start = 0, fixed = true) "How often the gap has closed"
    annotation(Placement(transformation(extent = {{100, -5}, {110, 5}})));
  Interfaces.PositionOutput contact_x(start = 0, fixed = true) "x at contact_time"
    annotation(Placement(transformation(extent = {{100, -18}, {110, -8}})));
  Interfaces.PositionOutput contact_y(start = 0, fixed = true) "y at contact_time"
    annotation(Placement(transformation(extent = {{100, -31}, {110, -21}})));
  Interfaces.PositionOutput contact_z(start = 0, fixed = true) "z at contact_time"
    annotation(Placement(transformation(extent = {{100, -44}, {110, -34}})));
  Interfaces.PositionOutput gap "Distance of the ball from the workpiece"
    annotation(Placement(transformation(extent = {{100, -56}, {110, -46}})));
  Interfaces.LengthOutput total_pretravel
    "In the direction of the surface, of the touch that is or comes next"
    annotation(Placement(transformation(extent = {{100, -69}, {110, -59}})));
  Interfaces.LengthOutput clearance
    "Distance that the ball can move without any edge; 0 while one is under way"
    annotation(Placement(transformation(extent = {{100, -82}, {110, -72}})));
  Interfaces.BooleanOutput ready "Switched on for long enough"
    annotation(Placement(transformation(extent = {{100, -95}, {110, -85}})));
protected
  constant Units.Length rounding = 1e-13 "By how much two steps may disagree where they meet";
  constant Units.Length smallest = 1e-12 "Below it a direction is not known";
  Real norm[3](each unit = "1") "Length of (slope_x, slope_y, 1) at the points";
  Units.Position top[3] "Height of the ball centre when it touches at the point";
  Units.Slope touched_x "Slope where the ball touches: x";
  Units.Slope touched_y "Slope where the ball touches: y";
  Real touched_norm(unit = "1") "Length of (touched_x, touched_y, 1)";
  Units.Position above "Distance of the ball centre from the surface";
  Units.Length above_out "The same, 0 below";
  Units.Length beyond_out "Distance of the ball centre from the upright wall, 0 inside";
  Units.Length out "Distance of the ball centre from the material, 0 inside";
  Units.Share upward "Share of the surface in the normal";
  Units.Share sideways "Share of the upright wall in the normal";
  ThreeLegSeat seat(
    force = seat_force,
    length = stylus_length,
    radius = seat_radius,
    angle = seat_angle,
    bending = bending_stiffness,
    axial = axial_stiffness)
    "Seat of the stylus"
    annotation(Placement(transformation(extent = {{-34, -34}, {-6, -6}})));
  PretravelScatter scatter(
    scatter = pretravel_scatter,
    first = first_touch,
    drift = drift,
    least = -pretravel,
    random_seed = seed)
    "What one touch differs from another"
    annotation(Placement(transformation(extent = {{46, -74}, {74, -46}})));
  Units.Length approach "By how much ball and workpiece yield at the trigger force (Hertz)";
  Boolean deflected "Deflected past the switching point";
  Boolean deflected_at_start "Deflected when the simulation began";
  EdgeDelay path(dead_time = trigger_delay + radio_delay, jitter = radio_jitter,
    random_seed = seed)
    "From the switching point to the edge"
    annotation(Placement(transformation(extent = {{6, -34}, {34, -6}})));
  ContactBounce bounce(
    closing_count = bounce_count,
    opening_count = release_bounce_count,
    duration = bounce_time)
    "Bouncing contact"
    annotation(Placement(transformation(extent = {{46, -34}, {74, -6}})));
  SwitchOnDelay power(start_up_time = switch_on_time) "Start-up of the probe"
    annotation(Placement(transformation(extent = {{-74, -74}, {-46, -46}})));
  EdgeCounter rising "Counts rising edges"
    annotation(Placement(transformation(extent = {{-34, -74}, {-6, -46}})));
  EdgeCounter falling "Counts falling edges"
    annotation(Placement(transformation(extent = {{6, -74}, {34, -46}})));
initial equation
  pre(deflected_at_start) = gap + pretravel + approach + seat.pretravel
    + scatter.first_difference <= 0;
equation
  connect(x.position, workpiece.x[1])
    annotation(Line(points = {{-32, 45}, {-54, 45}, {-54, -7}, {-75, -7}}, color = {0, 0, 127}));
  connect(y.position, workpiece.y[1])
    annotation(Line(points = {{21, 45}, {-27, 45}, {-27, -33}, {-75, -33}}, color = {0, 0, 127}));
  for i in 1:2 loop
    workpiece.x[i + 1] = x.position + ball_radius*workpiece.slope_x[i]/norm[i];
    workpiece.y[i + 1] = y.position + ball_radius*workpiece.slope_y[i]/norm[i];
  end for;
  for i in 1:3 loop
    norm[i] = sqrt(1 + workpiece.slope_x[i]^2 + workpiece.slope_y[i]^2);
    top[i] = workpiece.height[i] + sqrt(max(0, ball_radius^2
      - (workpiece.x[i] - x.position)^2 - (workpiece.y[i] - y.position)^2));
  end for;
  touched_x = noEvent(if top[3] >= max(top[1], top[2]) then workpiece.slope_x[3]
    elseif top[2] >= top[1] then workpiece.slope_x[2] else workpiece.slope_x[1]);
  touched_y = noEvent(if top[3] >= max(top[1], top[2]) then workpiece.slope_y[3]
    elseif top[2] >= top[1] then workpiece.slope_y[2] else workpiece.slope_y[1]);
  touched_norm = sqrt(1 + touched_x^2 + touched_y^2);
  above = (z.position - max(top[3], max(top[1], top[2])))/touched_norm + ball_radius;
  above_out = max(0, above);
  beyond_out = max(0, workpiece.beyond);
  out = sqrt(above_out^2 + beyond_out^2);
  gap = out + min(0, max(above, workpiece.beyond)) - ball_radius;
  sideways = beyond_out/max(out, smallest);
  upward = noEvent(if out > smallest then above_out/out else 1);
  seat.normal_x = sideways*workpiece.beyond_x - upward*touched_x/touched_norm;
  seat.normal_y = sideways*workpiece.beyond_y - upward*touched_y/touched_norm;
  seat.normal_z = upward/touched_norm;
  scatter.u = contact;
  approach = min(1, contact_modulus)
    *(9*seat.trigger_force^2/(16*max(1e-6, ball_radius)*max(1, contact_modulus)^2))^(1/3);
  total_pretravel = pretravel + approach + seat.pretravel + scatter.y;
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
  bounce.u = path.y;
  power.u = switched_on;
  ready = power.ready;
  signal = ready and bounce.y <> inverted;
  rising.u = signal;
  falling.u = not signal;
  connect(rising.last, rising_time)
    annotation(Line(points = {{-5, -73}, {48, -73}, {48, 77}, {100, 77}}, color = {0, 0, 127}));
  rising_count = rising.count;
  connect(falling.last, falling_time)
    annotation(Line(points = {{35, -73}, {68, -73}, {68, 64}, {100, 64}}, color = {0, 0, 127}));
  falling_count = falling.count;
  clearance = if path.waiting or bounce.bouncing or power.waiting then 0
    elseif not contact then max(0, max(workpiece.beyond,
      (z.position - workpiece.height[1])/sqrt(1 + workpiece.steepest^2)) - ball_radius)
    else noEvent(if workpiece.steepest > 0 or seat_force > 0 then 0
      else min(abs(gap), abs(gap + total_pretravel)));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-15, 30}, {15, 80}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 30}, {0, -30}}, color = {0, 0, 0}),
      Ellipse(extent = {{-12, -54}, {12, -30}}, fillColor = {255, 0, 0},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, -56}, {-70, -59}, {-60, -63}, {-50, -67}, {-40, -69},
          {-30, -70}, {-20, -69}, {-10, -66}, {0, -62}, {10, -58}, {20, -55}, {30, -54}, {40,
          -55}, {50, -57}, {60, -61}, {70, -65}, {80, -68}, {80, -80}}, fillColor = {200, 170,
          120}, fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: a ball of radius r touches the surface h(x, y) at the foot f = p + r (h_x, h_y)/N with
N = sqrt(1 + h_x^2 + h_y^2), the slopes taken at f; then its centre is at h(f) + sqrt(r^2 - |f - p|^2).
f is found by two fixed-point steps from f = p, and the highest of the three candidates counts: on a
plane this is exact (the centre is r/cos b above the surface, an error of r (1/cos b - 1) against the
lowest point of the ball), and it is never too early. Where the material ends, the distance is that
from the wall or from the edge between wall and top. Contact at gap &lt;= 0, switching at
gap &lt;= -total_pretravel; pre-travel by direction from the normal (ThreeLegSeat),
and of each touch (PretravelScatter: scatter, first touch, drift; together not below -pretravel, so
that a touch never switches before its contact). With a contact_modulus E the ball and the surface yield
by (9 F^2/(16 r E^2))^(1/3) until the trigger force F of the seat is reached (Hertz); 1/E is the sum
of (1 - nu^2)/E of both. Without seat_force there is no force.</p>
<p>The edge follows after trigger_delay + radio_delay, with a deviation of its own (EdgeDelay), and
then bounces (ContactBounce). The signal is false until the probe is ready (SwitchOnDelay).</p>
<p>clearance: with the largest slope L of the surface the ball cannot touch within
(z - h)/sqrt(1 + L^2) - r, nor within its distance from the wall. In contact it is given on level
surfaces without three-leg seat only, else 0.</p>
<p>Assumptions: the probe does not act back; the deviation of the radio is that of a touch, all edges
of its bouncing share it. Limits: curvature of the surface times r below 0.5; where it is larger (short
flanks) contact comes late by a part of r, walls want an edge or a hole. The top is taken as level
where it ends at a wall. A touch shorter than the internal step can be missed; at most four edges of
one direction within the delay; the level at the start is no edge.</p>
<p>Source: ISO 230-10, probing systems of machine tools; contact of ball and surface: the envelope of
balls on a surface, its parallel surface at r; yielding: K. L. Johnson, Contact Mechanics, Cambridge
1985, 4.2 (ball on a flat body).</p>
</html>"));
end WorkpieceProbe;
