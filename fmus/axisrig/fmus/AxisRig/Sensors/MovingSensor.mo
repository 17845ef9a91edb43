within AxisRig.Sensors;
partial model MovingSensor "Sensor on three axes that move on a cubic over the communication step"
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
protected
  Real passed(unit = "1") "Share of the step that has passed";
  CubicPath x "Reference point of the sensor: x";
  CubicPath y "Reference point of the sensor: y";
  CubicPath z "Reference point of the sensor: z";
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
  annotation(
    Documentation(info="<html>
<p>The motion p(t) of the sensor from position and rate at both ends of the communication step
(CubicPath). Every sensor that reads the axes has these inputs.</p>
<p>Assumption: the sensor does not act back on the axes. Limit: between the ends the motion is a
cubic; see CubicPath for what is left across a step of the acceleration.</p>
</html>"));
end MovingSensor;
