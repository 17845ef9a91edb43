within AxisRig.Sensors;
block EdgeDelay "Boolean signal that arrives later by a fixed time"
  parameter Units.Time delay(min = 0) = 0 "Time from an edge of the input to that of the output";
  input Boolean u "Input";
  input Boolean u_start "Level of the input at the start";
  output Boolean y "Input as it was one delay ago";
  output Boolean waiting "An edge is under way";
protected
  EdgeQueue rising(delay = delay);
  EdgeQueue falling(delay = delay);
equation
  rising.u = u;
  falling.u = not u;
  waiting = rising.waiting or falling.waiting;
  y = if u_start then rising.arrived >= falling.arrived else rising.arrived > falling.arrived;
  annotation(
    Documentation(info="<html>
<p>Equation: y(t) = u(t - delay), and y = u_start at the start, as if the input had always
rested.</p>
<p>Edges travel in two queues, one for each direction; at most four of one direction may be under
way at a time, else the simulation ends with an error.</p>
</html>"));
end EdgeDelay;
