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
<p>A device that is on at the start counts as switched on at the start. Switching off acts at once.
</p>
</html>"));
end SwitchOnDelay;
