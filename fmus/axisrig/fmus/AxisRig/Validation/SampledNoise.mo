within AxisRig.Validation;
model SampledNoise "Normal numbers"
  extends Icons.Experiment;
  Sensors.SampledNoise noise(period = 130e-6, random_seed = 12) "Random numbers"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Real y(unit = "1") "Number now";
equation
  y = noise.y;
  annotation(
    experiment(StopTime=0.1, Interval=5.003e-4),
    Documentation(info="<html>
<p>Compared: the numbers.</p>
</html>"));
end SampledNoise;
