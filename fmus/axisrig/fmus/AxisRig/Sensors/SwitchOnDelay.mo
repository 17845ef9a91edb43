within AxisRig.Sensors;
block SwitchOnDelay "Device that is ready some time after it has been switched on"
  parameter Units.Time start_up_time(min = 0) = 0 "From switching on until it is ready"
    annotation(Dialog(group = "Parameters"));
  Interfaces.BooleanInput u "Switched on"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.BooleanOutput ready "Switched on for long enough"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.BooleanOutput waiting "Switched on and not yet ready"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  Units.Time ready_at "When it is or was ready";
initial equation
  pre(ready_at) = time + start_up_time;
equation
  when u then
    ready_at = time + start_up_time;
  end when;
  ready = u and time >= ready_at;
  waiting = u and not ready;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-50, -50}, {50, 50}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 0}, {0, 40}}, color = {0, 0, 0}),
      Line(points = {{0, 0}, {25, 10}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: ready from t + T on with the start-up time T, t the instant of switching on; not ready when
off. Assumption: a device that is on at the start was switched on at the start. Limit: switching off acts at once. Source:
radio probes need some seconds after switching on until their signal is valid.</p>
</html>"));
end SwitchOnDelay;
