within AxisRig.Sensors;
block EdgeDelay "Boolean signal that arrives later"
  parameter Units.Time delay(min = 0) = 0 "Time from an edge of the input to that of the output";
  parameter Units.Time jitter(min = 0) = 0 "Largest deviation of it to either side";
  parameter Integer random_seed(min = 0, max = 1000000) = 0 "Of the deviations";
  input Boolean u "Input";
  input Boolean u_start "Level of the input at the start";
  output Boolean y "Input as it was one delay ago";
  output Boolean waiting "An edge is under way";
protected
  EdgeQueue rising(transit = delay, spread = jitter, seed = random_seed, multiplier = 16807);
  EdgeQueue falling(transit = delay, spread = jitter, seed = random_seed, multiplier = 48271);
equation
  rising.u = u;
  falling.u = not u;
  waiting = rising.waiting or falling.waiting;
  y = if u_start then rising.arrived >= falling.arrived else rising.arrived > falling.arrived;
  annotation(
    Documentation(info="<html>
<p>Equation: y(t) = u(t - delay), and y = u_start at the start, as if the input had always
rested. With jitter each edge has a delay of its own (EdgeQueue), not below 0.</p>
<p>Limit: edges travel in two queues, one for each direction; at most four of one direction may be under
way at a time, else the simulation ends with an error. A pulse of which the end would overtake the
beginning is lost. Assumption: deviations are uniform. Source: a radio link sends its state in slots of time, which makes the delay
uniform over a slot.</p>
</html>"));
end EdgeDelay;
