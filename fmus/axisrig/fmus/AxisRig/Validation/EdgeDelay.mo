within AxisRig.Validation;
model EdgeDelay "A square wave after a delay that differs from edge to edge"
  extends Icons.Experiment;
  Sensors.EdgeDelay path(dead_time = 30e-3, jitter = 3e-3, random_seed = 77)
    "From the switching point to the edge"
    annotation(Placement(transformation(extent = {{-60, 20}, {-20, 60}})));
  Sensors.EdgeCounter rising "Counts rising edges"
    annotation(Placement(transformation(extent = {{20, 20}, {60, 60}})));
  Sensors.EdgeCounter falling "Counts falling edges"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
  output Units.Time rising_time "Last rising edge";
  output Units.Time falling_time "Last falling edge";
  output Integer rising_count "Rising edges";
  output Boolean waiting "An edge is under way";
equation
  path.u = sin(251.3*time - 0.3) > 0;
  path.u_start = false;
  rising.u = path.y;
  falling.u = not path.y;
  rising_time = rising.last;
  falling_time = falling.last;
  rising_count = rising.count;
  waiting = path.waiting;
  annotation(
    experiment(StopTime=0.5, Interval=1.01e-3),
    Documentation(info="<html>
<p>40 Hz, 30 ms and up to 3 ms to either side. Compared: instants and number of the edges after the
delay, and whether one is under way.</p>
</html>"));
end EdgeDelay;
