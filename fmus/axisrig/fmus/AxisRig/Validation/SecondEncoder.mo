within AxisRig.Validation;
model SecondEncoder "An encoder on a scale that has grown"
  extends Icons.Experiment;
  Sensors.SecondEncoder encoder(
    scale = 1.00003,
    offset = 0.2,
    periodic_error = 0.15e-6,
    signal_period = 20e-6,
    periodic_phase = 0.7,
    resolution = 50e-9)
    "Encoder under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position position "Reading";
  output Units.Velocity velocity "Rate of the reading";
equation
  encoder.step_time = 0;
  encoder.step_size = 1;
  encoder.x_start = 0.01;
  encoder.x_rate_start = 2e-3;
  encoder.x_end = 0.0101;
  encoder.x_rate_end = -1e-3;
  position = encoder.position;
  velocity = encoder.velocity;
  annotation(
    experiment(StopTime=1, Interval=1.7e-3),
    Documentation(info="<html>
<p>Compared: reading in whole counts, rate.</p>
</html>"));
end SecondEncoder;
