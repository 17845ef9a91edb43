within AxisRig.Validation;
model PositionSwitch "An axis runs over a cam and back"
  extends Icons.Experiment;
  Sensors.PositionSwitch switch(low = 5e-3, high = 15e-3, hysteresis = 1e-3, inverted = false)
    "Switch under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Boolean signal "Level";
  output Units.Time rising_time "Edge of the signal";
  output Units.Time falling_time "Edge of the signal";
  output Units.Length clearance "To the next edge";
equation
  switch.step_time = 0;
  switch.step_size = 0.4;
  switch.x_start = 0;
  switch.x_rate_start = 0.2;
  switch.x_end = 0;
  switch.x_rate_end = -0.2;
  signal = switch.signal;
  rising_time = switch.rising_time;
  falling_time = switch.falling_time;
  clearance = switch.clearance;
  annotation(
    experiment(StopTime=0.4, Interval=4.003e-3),
    Documentation(info="<html>
<p>Over the whole cam and back: two edges at its ends, two off them by the hysteresis.</p>
</html>"));
end PositionSwitch;
