within AxisRig.Validation;
model EdgeStamp "Stamps of a square wave, across the wrap of 32 bits"
  extends Icons.Experiment;
  Sensors.EdgeStamp last(
    spread = 1.7e-6,
    random_seed = 4711,
    error = -2.3e-6,
    epoch_seconds = 846000003,
    epoch_nanoseconds = 999900000)
    "Stamps the last edge"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Sensors.EdgeStamp first(
    multiplier = 48271,
    spread = 1e-6,
    random_seed = 4711,
    error = 4e-6,
    epoch_seconds = 0,
    epoch_nanoseconds = 0,
    hold_first = true)
    "Holds the first edge"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Integer count "Edges";
  output Integer seconds "Stamp of the last edge";
  output Integer nanoseconds "Stamp of the last edge";
  output Real low_word(unit = "1") "Stamp of the last edge, low 32 bits";
  output Integer first_nanoseconds "Stamp of the first edge since rearm";
equation
  last.u = sin(25.13*time - 0.3) > 0;
  last.rearm = false;
  first.u = last.u;
  first.rearm = time > 4.01;
  count = last.count;
  seconds = last.seconds;
  nanoseconds = last.nanoseconds;
  low_word = last.low_word;
  first_nanoseconds = first.nanoseconds;
  annotation(
    experiment(StopTime=9, Interval=0.03),
    Documentation(info="<html>
<p>4 Hz over 9 s. Compared: number of edges and both forms of the stamp; the held stamp before and
after rearm.</p>
</html>"));
end EdgeStamp;
