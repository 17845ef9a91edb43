within AxisRig.Validation;
model SwitchOnDelay "A device on at the start, switched off and on again"
  extends Icons.Experiment;
  Sensors.SwitchOnDelay device(start_up_time = 0.0123) "Device under test"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Sensors.EdgeCounter rising "Counts rising edges"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Boolean ready "Ready";
  output Boolean waiting "Not yet ready";
  output Units.Time ready_time "When it became ready";
equation
  device.u = time < 0.0301 or time > 0.0402;
  rising.u = device.ready;
  ready = device.ready;
  waiting = device.waiting;
  ready_time = rising.last;
  annotation(
    experiment(StopTime=0.07, Interval=1e-3),
    Documentation(info="<html>
<p>Compared: ready, waiting and the instant at which it became ready.</p>
</html>"));
end SwitchOnDelay;
