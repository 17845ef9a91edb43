within AxisRig.Sensors;
block SwitchOnDelay "Device that is ready some time after it has been switched on"
  parameter Units.Time delay(min = 0) = 0 "From switching on until it is ready";
  input Boolean u "Switched on";
  output Boolean ready "Switched on for long enough";
  output Boolean waiting "Switched on and not yet ready";
protected
  Units.Time ready_at "When it is or was ready";
initial equation
  pre(ready_at) = time + delay;
equation
  when u then
    ready_at = time + delay;
  end when;
  ready = u and time >= ready_at;
  waiting = u and not ready;
  annotation(
    Documentation(info="<html>
<p>Equation: ready from t + delay on, t the instant of switching on; not ready when off. Assumption: a
device that is on at the start was switched on at the start. Limit: switching off acts at once. Source:
radio probes need some seconds after switching on until their signal is valid.</p>
</html>"));
end SwitchOnDelay;
