within AxisRig.Sensors;
model PositionSwitch "Switch that a cam of one axis closes: limit switch, home switch"
  input Units.Time step_time "Beginning of the communication step";
  input Units.Time step_size(start = 1e-3, min = 1e-9) "Length of the communication step";
  input Units.Position x_start "Position of the axis at the beginning of the step";
  input Units.Velocity x_rate_start "Rate of it at the beginning of the step";
  input Units.Position x_end "Position of the axis at the end of the step";
  input Units.Velocity x_rate_end "Rate of it at the end of the step";
  parameter Units.Position low = 0 "Lower end of the cam";
  parameter Units.Position high = 1e3 "Upper end of the cam; the default lies out of reach";
  parameter Units.Length hysteresis = 20e-6 "The switch opens this far outside the cam";
  parameter Boolean inverted = false "Signal is true off the cam (normally closed contact)";
  output Boolean signal "Switching output";
  output Units.Time rising_time "Instant of the last rising edge of the signal";
  output Units.Time falling_time "Instant of the last falling edge of the signal";
  output Integer rising_count "Rising edges of the signal since the start";
  output Integer falling_count "Falling edges of the signal since the start";
  output Units.Length clearance "Distance that the axis can move without any edge";
protected
  constant Units.Length rounding = 1e-13 "By how much two steps may disagree where they meet";
  Real passed(unit = "1") "Share of the step that has passed";
  CubicPath x "Position of the axis";
  Units.Length outside "How far off the cam it stays closed";
  Boolean closed "On the cam";
  EdgeCounter rising;
  EdgeCounter falling;
equation
  passed = (time - step_time)/step_size;
  x.start = x_start;
  x.start_rate = x_rate_start;
  x.finish = x_end;
  x.finish_rate = x_rate_end;
  x.span = step_size;
  x.passed = passed;
  outside = if hysteresis > rounding then hysteresis else rounding;
  closed = x.position >= low - (if pre(closed) then outside else 0)
    and x.position <= high + (if pre(closed) then outside else 0);
  clearance = min(
    min(abs(x.position - low), abs(x.position - low + outside)),
    min(abs(x.position - high), abs(x.position - high - outside)));
  signal = closed <> inverted;
  rising.u = signal;
  falling.u = not signal;
  rising_time = rising.last;
  rising_count = rising.count;
  falling_time = falling.last;
  falling_count = falling.count;
  annotation(
    Documentation(info="<html>
<p>Equations: closes at low &lt;= x &lt;= high, opens beyond low - h and high + h. A limit switch of the
positive end has its cam from its place to out of reach; a home switch a short one.</p>
<p>clearance is the way to the nearest of the four places where the level can change.</p>
<p>Assumption: the place of an edge does not depend on speed. Limits: no bounce, no delay (the drive
has an input filter); the level at the start is not an edge; a cam shorter than the way within an
internal step can be missed. Source: definition; hysteresis of inductive switches is up to 15 % of
their range, IEC 60947-5-2.</p>
</html>"));
end PositionSwitch;
