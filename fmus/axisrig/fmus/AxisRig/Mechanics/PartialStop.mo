within AxisRig.Mechanics;
partial model PartialStop "What every fixed stop has in common"
  parameter Units.Position stop_position = 1e3 "Where the slide touches"
    annotation(Dialog(group = "Fixed stop"));
  parameter Integer stop_direction(min = -1, max = 1) = 1
    "1: the stop is met in positive direction, -1: in negative direction"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Velocity stop_speed(min = -1, max = 1) = 0
    "Of the stop from stop_begin to stop_end; 0: it is at rest"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Time stop_begin = 0 "When the stop begins to move"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Time stop_end = 0 "When it is at rest again"
    annotation(Dialog(group = "Fixed stop"));
  Interfaces.Flange flange "Moving side"
    annotation(Placement(transformation(extent = {{-10, -110}, {10, -90}})));
  Units.Position face "Where the stop is touched now";
  Units.Position penetration "How far the slide is past the first touch";
  Units.Velocity velocity "Velocity into the stop, relative to it";
  Units.Force force "Force between stop and slide, never negative";
protected
  Boolean begun "The stop has begun to move";
  Boolean ended "It is at rest again";
equation
  begun = time >= stop_begin;
  ended = time >= stop_end;
  face = stop_position
    + stop_speed*((if ended then stop_end elseif begun then time else stop_begin) - stop_begin);
  penetration = stop_direction*(flange.s - face);
  velocity = stop_direction*(der(flange.s) - (if begun and not ended then stop_speed else 0));
  flange.f = stop_direction*force;
  assert(abs(stop_direction) > 0.5, "stop_direction must be 1 or -1");
  assert(stop_end >= stop_begin, "stop_end must not be before stop_begin");
  assert(abs(stop_speed) <= 0 or stop_end > stop_begin,
    "a stop with a stop_speed needs a stop_end after stop_begin");
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{60, -70}, {76, 70}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-60, -30}, {20, 30}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: p = d (s - s_f) with the direction d; the force acts against d. The face of the stop is
at s_f = s_stop + v_s (min(max(t, t_begin), t_end) - t_begin), dp/dt = d (ds/dt - v_s) while it moves.
A model that extends this one says how the force follows from p and its velocity.</p>
<p>Assumption: what moves the stop yields to no force; its velocity steps at both ends, and with it a
damping force. Limit: one point of contact. Source: geometry.</p>
</html>"));
end PartialStop;
