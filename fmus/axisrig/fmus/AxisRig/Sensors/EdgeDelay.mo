within AxisRig.Sensors;
block EdgeDelay "Boolean signal that arrives later"
  parameter Units.Time dead_time(min = 0) = 0
    "Time from an edge of the input to that of the output"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time jitter(min = 0) = 0 "Largest deviation of it to either side"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Integer random_seed(min = 0, max = 1000000) = 0 "Of the deviations"
    annotation(Dialog(group = "Noise and jitter"));
  Interfaces.BooleanInput u "Input"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.BooleanInput u_start "Level of the input at the start"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.BooleanOutput y "Input as it was one dead time ago"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.BooleanOutput waiting "An edge is under way"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  EdgeQueue rising(transit = dead_time, spread = jitter, seed = random_seed, multiplier = 16807)
    "Rising edges under way"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  EdgeQueue falling(transit = dead_time, spread = jitter, seed = random_seed, multiplier = 48271)
    "Falling edges under way"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
equation
  rising.u = u;
  falling.u = not u;
  waiting = rising.waiting or falling.waiting;
  y = if u_start then rising.arrived >= falling.arrived else rising.arrived > falling.arrived;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, 20}, {-40, 20}, {-40, 60}, {80, 60}}, color = {255, 0, 255}),
      Line(points = {{-80, -60}, {20, -60}, {20, -20}, {80, -20}}, color = {255, 0, 255}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: y(t) = u(t - T) with the dead time T, and y = u_start at the start, as if the input had always
rested. With jitter each edge has a delay of its own (EdgeQueue), not below 0.</p>
<p>Limit: edges travel in two queues, one for each direction; at most four of one direction may be under
way at a time, else the simulation ends with an error. A pulse of which the end would overtake the
beginning is lost. Assumption: deviations are uniform. Source: a radio link sends its state in slots of time, which makes the delay
uniform over a slot.</p>
</html>"));
end EdgeDelay;
