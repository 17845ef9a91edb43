within AxisRig.Examples;
model FixedStop "An axis runs into a fixed stop, presses with its force limit and goes back"
  extends Icons.Experiment;
  parameter Units.Force press = 600 "Force limit"
    annotation(Dialog(group = "Parameters"));
  Drives.ServoAxis axis(
    kv = 20,
    stop_position = 0.01,
    coulomb_friction = 60,
    breakaway_friction = 90)
    "Axis with a stop at 10 mm"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  Units.Position position "Axis";
  Units.Velocity velocity "Axis";
  Units.Force force "Motor";
  Units.Force stop_force "Stop";
protected
  Boolean returns "The demand goes back";
equation
  returns = time >= 0.9;
  axis.reference_position = if returns then 0.01 else 0;
  axis.reference_velocity = if returns then -0.03 else 0.03;
  axis.reference_time = if returns then 0.9 else 0;
  axis.reference_end = if returns then 1.2 else 0.6;
  axis.enabled = true;
  axis.force_limit = press;
  axis.force_limit_positive = 1e9;
  axis.force_limit_negative = 1e9;
  axis.control = 0;
  axis.reference_acceleration = 0;
  axis.reference_force = 0;
  position = axis.position;
  velocity = axis.velocity;
  force = axis.force;
  stop_force = axis.stop_force;
  annotation(
    experiment(StopTime = 1.4, Interval = 4e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>The demand goes to 18 mm, the stop is at 10 mm. At rest the stop carries 600 N and has yielded 600 N/k = 30 um.
Reference: <code>Resources/ReferenceResults/FixedStop.csv</code>, integrated from the equations.</p>
</html>"));
end FixedStop;
