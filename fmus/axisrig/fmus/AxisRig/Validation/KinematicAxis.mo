within AxisRig.Validation;
model KinematicAxis "Axis without mass: at rest, gets power, follows two ramps, at rest again"
  extends Icons.Experiment;
  Drives.KinematicAxis axis(
    position_start = 0.021,
    noise = 2e-6,
    noise_period = 130e-6,
    seed = 5)
    "Axis under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position position "Slide";
  output Units.Velocity velocity "Slide";
  output Units.Position motor_position "Motor encoder";
  output Units.Position demand_position "Position demand";
protected
  Boolean back "The second ramp is given";
equation
  back = time >= 0.1031;
  axis.reference_position = if back then 0.0236 else 0.02;
  axis.reference_velocity = if back then -0.04 else 0.07;
  axis.reference_time = if back then 0.1031 else 0.0207;
  axis.reference_end = if back then 1 else 0.0809;
  axis.enabled = time >= 0.0407 and time < 0.1513;
  position = axis.position;
  velocity = axis.velocity;
  motor_position = axis.motor_position;
  demand_position = axis.demand_position;
  annotation(
    experiment(StopTime=0.2, Interval=0.5003e-3),
    Documentation(info="<html>
<p>Without power until 41 ms, a ramp that ends, a ramp back from somewhere else, without power from 151 ms
on. Compared: motion, encoder with noise, demand.</p>
</html>"));
end KinematicAxis;
