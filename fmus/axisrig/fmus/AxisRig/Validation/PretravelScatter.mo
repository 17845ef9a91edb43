within AxisRig.Validation;
model PretravelScatter "Pre-travel of eight touches"
  extends Icons.Experiment;
  Sensors.PretravelScatter touches(
    scatter = 5e-6,
    first = 20e-6,
    drift = 2e-6,
    least = -2e-6,
    random_seed = 12)
    "Difference from touch to touch"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position difference "Of the touch that is or comes next";
equation
  touches.u = sin(62.3*time - 0.4) > 0;
  difference = touches.y;
  annotation(
    experiment(StopTime=0.8, Interval=8.003e-3),
    Documentation(info="<html>
<p>A touch ends at each falling zero of the sine. Compared: difference.</p>
</html>"));
end PretravelScatter;
