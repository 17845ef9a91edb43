within AxisRig.Validation;
model SensorFilter "Both orders following a sine that begins away from zero"
  extends Icons.Experiment;
  Sensors.SensorFilter first(number = 1, corner = 120) "Filter of the first order"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Sensors.SensorFilter second(number = 2, corner = 150, damping_ratio = 0.4)
    "Filter of the second order"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Units.Position first_order "Output of the first order";
  output Units.Position second_order "Output of the second order";
protected
  Units.Position u "Input of both";
equation
  u = 1e-3*(1 + cos(500*time)) + 0.02*time;
  first.u = u;
  second.u = u;
  first_order = first.y;
  second_order = second.y;
  annotation(
    experiment(StopTime=0.05, Interval=5e-4),
    Documentation(info="<html>
<p>Compared: both outputs, from the first instant.</p>
</html>"));
end SensorFilter;
