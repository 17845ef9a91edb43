within AxisRig.Mechanics;
partial model PartialStop "What every fixed stop has in common"
  parameter Units.Position stop_position = 1e3 "Where the slide touches";
  parameter Integer stop_direction(min = -1, max = 1) = 1
    "1: the stop is met in positive direction, -1: in negative direction";
  Interfaces.Flange flange "Moving side";
  Units.Position penetration "How far the slide is past the first touch";
  Units.Velocity velocity "Velocity into the stop";
  Units.Force force "Force between stop and slide, never negative";
equation
  penetration = stop_direction*(flange.s - stop_position);
  velocity = stop_direction*der(flange.s);
  flange.f = stop_direction*force;
  assert(abs(stop_direction) > 0.5, "stop_direction must be 1 or -1");
  annotation(
    Documentation(info="<html>
<p>Equation: p = d (s - s_stop) with the direction d; the force acts against d. A model that extends
this one says how the force follows from p and its velocity.</p>
<p>Assumption: the stop does not move. Limit: one point of contact. Source: geometry.</p>
</html>"));
end PartialStop;
