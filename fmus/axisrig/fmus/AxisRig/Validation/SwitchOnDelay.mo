within AxisRig.Validation;
model SwitchOnDelay "A device on at the start, switched off and on again"
  Sensors.SwitchOnDelay device(delay = 0.0123);
  Sensors.EdgeCounter rising;
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
