within AxisRig.Sensors;
model SecondEncoder "Linear encoder at the load of one axis"
  input Units.Time step_time "Beginning of the communication step";
  input Units.Time step_size(start = 1e-3, min = 1e-9) "Length of the communication step";
  input Units.Position x_start "Position of the axis at the beginning of the step";
  input Units.Velocity x_rate_start "Rate of it at the beginning of the step";
  input Units.Position x_end "Position of the axis at the end of the step";
  input Units.Velocity x_rate_end "Rate of it at the end of the step";
  parameter Real scale(unit = "1") = 1 "Measured length over true length";
  parameter Units.Position offset = 0 "Reading at the axis position 0";
  parameter Units.Position periodic_error = 0 "Amplitude of the error within a signal period";
  parameter Units.Length signal_period(min = 1e-9) = 20e-6 "Length of a signal period";
  parameter Units.Angle periodic_phase = 0 "Phase of the periodic error at the reading 0";
  parameter Units.Length resolution(min = 1e-12) = 1e-9 "Length of a count";
  output Units.Position position "Reading in whole counts";
  output Units.Position position_true "Position of the axis";
  output Units.Velocity velocity "Rate of the reading, not quantised";
protected
  constant Real pi = 3.141592653589793;
  Real passed(unit = "1") "Share of the step that has passed";
  Units.Position scaled "Reading of an encoder without periodic error";
  Units.Velocity rate "Rate of the axis";
  Real number(unit = "rad/m") "Phase per length";
  Units.Angle counted "Reading as an angle that turns once in a count";
  Units.Position reading "Reading before it is quantised";
  CubicPath x "Position of the axis";
equation
  number = 2*pi/signal_period;
  passed = (time - step_time)/step_size;
  x.start = x_start;
  x.start_rate = x_rate_start;
  x.finish = x_end;
  x.finish_rate = x_rate_end;
  x.span = step_size;
  x.passed = passed;
  rate = x_rate_start + passed*(2*(3*(x_end - x_start)/step_size - (2*x_rate_start + x_rate_end))
    + passed*3*(2*(x_start - x_end)/step_size + (x_rate_start + x_rate_end)));
  position_true = x.position;
  scaled = offset + scale*x.position;
  reading = scaled + periodic_error*sin(number*scaled + periodic_phase);
  // The nearest whole count without floor(): an event at each count would stop the simulation some
  // hundred thousand times a second.
  counted = 2*pi*reading/resolution;
  position = reading - resolution/(2*pi)*atan2(sin(counted), cos(counted));
  velocity = scale*rate*(1 + periodic_error*number*cos(number*scaled + periodic_phase));
  annotation(
    Documentation(info="<html>
<p>Equations: s = offset + scale x; reading = s + A sin(2 pi s/p + phi); position = q round(reading/q).
The rate is the derivative of the reading. Only the output is quantised: nothing inside depends on
whole counts, and no events come from them. The rounding is done by angles, x - q/(2 pi)
atan2(sin(2 pi x/q), cos(2 pi x/q)), which is exact to 1e-8 of a count.</p>
<p>Assumptions: the scale grows evenly (temperature, inclination); one harmonic of the periodic error.
Limit: no own elasticity between table and scale. Source: the signal of a linear encoder is
interpolated within its period (20 um), unequal amplitudes and phases of its two tracks leave a
periodic error.</p>
</html>"));
end SecondEncoder;
