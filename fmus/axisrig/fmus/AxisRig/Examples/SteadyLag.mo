within AxisRig.Examples;
model SteadyLag "Axis in steady motion: the lag must be (1 - f) v/Kv"
  extends Icons.Experiment;
  parameter Units.Velocity feed = 0.02 "Feed"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Share feed_forward = 0 "Share of velocity feed-forward"
    annotation(Dialog(group = "Position loop"));
  Drives.ServoAxis axis(feed_forward = feed_forward) "Axis under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  Units.Position lag "Demand minus position";
equation
  axis.reference_position = 0;
  axis.reference_velocity = feed;
  axis.reference_time = 0;
  axis.reference_end = 1e3;
  axis.enabled = true;
  axis.force_limit = 1e9;
  axis.force_limit_positive = 1e9;
  axis.force_limit_negative = 1e9;
  axis.control = 0;
  axis.reference_acceleration = 0;
  axis.reference_force = 0;
  lag = axis.demand_position - axis.position;
  annotation(
    experiment(StopTime = 3, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>After three seconds the lag of the default axis (Kv 10 1/s) at 20 mm/s is 2 mm.</p>
</html>"));
end SteadyLag;
