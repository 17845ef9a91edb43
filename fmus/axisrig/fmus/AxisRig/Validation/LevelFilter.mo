within AxisRig.Validation;
model LevelFilter "Pulses shorter and longer than the filter"
  extends Icons.Experiment;
  Sensors.LevelFilter filter(rest_time = 2e-3) "Filter"
    annotation(Placement(transformation(extent = {{-60, 20}, {-20, 60}})));
  Sensors.EdgeCounter rising "Counts rising edges"
    annotation(Placement(transformation(extent = {{20, 20}, {60, 60}})));
  Sensors.EdgeCounter falling "Counts falling edges"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
  output Boolean level "Filtered level";
  output Units.Time rising_time "Last rising edge";
  output Units.Time falling_time "Last falling edge";
  output Boolean waiting "A level is resting";
equation
  filter.u = time > 0.01003 and time < 0.01202 or time > 0.02003 and time < 0.02205
    or time > 0.03003 and time < 0.03503 or time > 0.03603;
  rising.u = filter.y;
  falling.u = not filter.y;
  level = filter.y;
  rising_time = rising.last;
  falling_time = falling.last;
  waiting = filter.waiting;
  annotation(
    experiment(StopTime=0.045, Interval=1e-4),
    Documentation(info="<html>
<p>Pulses of 1.99, 2.02 and 5 ms and a gap of 1 ms before a filter of 2 ms: the first pulse and the gap
do not pass. Compared: level, instants of the edges, and whether a level is resting.</p>
</html>"));
end LevelFilter;
