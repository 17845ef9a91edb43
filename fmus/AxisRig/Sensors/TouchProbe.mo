within AxisRig.Sensors;
model TouchProbe "Touch probe against a plane, with edges located inside the step"
  input Units.Time step_time "Beginning of the communication step";
  input Units.Time step_size(start = 1e-3, min = 1e-9) "Length of the communication step";
  input Units.Position x_start "x at the beginning of the step";
  input Units.Velocity x_rate_start "Rate of x at the beginning of the step";
  input Units.Position x_end "x at the end of the step";
  input Units.Velocity x_rate_end "Rate of x at the end of the step";
  input Units.Position y_start "y at the beginning of the step";
  input Units.Velocity y_rate_start "Rate of y at the beginning of the step";
  input Units.Position y_end "y at the end of the step";
  input Units.Velocity y_rate_end "Rate of y at the end of the step";
  input Units.Position z_start "z at the beginning of the step";
  input Units.Velocity z_rate_start "Rate of z at the beginning of the step";
  input Units.Position z_end "z at the end of the step";
  input Units.Velocity z_rate_end "Rate of z at the end of the step";

  parameter Units.Direction normal_x = 0 "Normal of the plane, towards free space: x";
  parameter Units.Direction normal_y = 0 "Normal of the plane, towards free space: y";
  parameter Units.Direction normal_z = 1 "Normal of the plane, towards free space: z";
  parameter Units.Position surface = 0.1 "Distance of the plane from the origin along its normal";
  parameter Units.Length ball_radius = 0 "Radius of the stylus ball";
  parameter Units.Length pretravel = 0 "Deflection from contact to the switching point";
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
protected
  constant Units.Length rounding = 1e-13 "By how much two steps may disagree where they meet";
  Real passed(unit = "1") "Share of the step that has passed";
  CubicPath x "Ball centre: x";
  CubicPath y "Ball centre: y";
  CubicPath z "Ball centre: z";
  Boolean deflected "Deflected beyond the switching point";
  Boolean deflected_at_start "Deflected when the simulation began";
  EdgeDelay path(delay = trigger_delay);
  EdgeCounter rising;
  EdgeCounter falling;
initial equation
  pre(deflected_at_start) = gap + pretravel <= 0;
equation
  passed = (time - step_time)/step_size;
  x.start = x_start;
  x.start_rate = x_rate_start;
  x.finish = x_end;
  x.finish_rate = x_rate_end;
  x.span = step_size;
  x.passed = passed;
  y.start = y_start;
  y.start_rate = y_rate_start;
  y.finish = y_end;
  y.finish_rate = y_rate_end;
  y.span = step_size;
  y.passed = passed;
  z.start = z_start;
  z.start_rate = z_rate_start;
  z.finish = z_end;
  z.finish_rate = z_rate_end;
  z.span = step_size;
  z.passed = passed;
  gap = normal_x*x.position + normal_y*y.position + normal_z*z.position - surface - ball_radius;
  contact = gap <= (if pre(contact) then rounding else 0);
  deflected = gap + pretravel <= (if pre(deflected) then rounding else 0);
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
<p>Equations: gap = n.p - d - r. Contact at gap &lt;= 0, switching at gap &lt;= -pretravel; the
signal follows after trigger_delay. p is the motion of the axes over the communication step as a
cubic through both ends (CubicPath).</p>
<p>Assumptions: the probe does not act back on the axes; pre-travel is the same in all directions;
no bounce. The gap must open by 1e-13 m before a contact ends, so that rounding where two steps meet
makes no edges; this shifts falling edges by 1e-13 m over the speed. Limits: the level at the start is not an edge; a touch shorter than the internal step
can be missed; at most four edges of one direction within trigger_delay.</p>
<p>Source: ISO 230-10, probing systems of machine tools: pre-travel and its reproducible share; the
trigger delay stands for switching electronics and transmission.</p>
</html>"));
end TouchProbe;
