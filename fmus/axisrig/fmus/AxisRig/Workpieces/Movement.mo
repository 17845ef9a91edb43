within AxisRig.Workpieces;
block Movement "How the whole workpiece moves up and down in time"
  parameter Units.Position lift = 0 "First lift, negative: it is lowered";
  parameter Units.Time lift_begin = 0 "When it begins";
  parameter Units.Time lift_end = 0 "When it is complete; not after the begin: a step at the begin";
  parameter Units.Position lift_2 = 0 "Second lift, on top of the first";
  parameter Units.Time lift_2_begin = 0 "When it begins";
  parameter Units.Time lift_2_end = 0 "When it is complete; not after the begin: a step at the begin";
  parameter Units.Position sway = 0 "Amplitude of a sine in time";
  parameter Units.Frequency sway_frequency = 1 "Its frequency";
  parameter Units.Time sway_begin = 0 "When it begins, from 0 upwards";
  output Units.Position height "By how much it has moved up";
protected
  constant Real pi = 3.141592653589793;
  constant Units.Time shortest = 1e-12 "Below it a duration counts as this";
  Real first(unit = "1") "Share of the first lift, 0..1";
  Real second(unit = "1") "Share of the second lift, 0..1";
  Units.Time swung "For how long it has been swaying";
equation
  first = if time >= max(lift_begin, lift_end) then 1
    elseif time >= lift_begin then (time - lift_begin)/max(shortest, lift_end - lift_begin) else 0;
  second = if time >= max(lift_2_begin, lift_2_end) then 1
    elseif time >= lift_2_begin then (time - lift_2_begin)/max(shortest, lift_2_end - lift_2_begin)
    else 0;
  swung = if time >= sway_begin then time - sway_begin else 0;
  height = lift*first + lift_2*second + sway*sin(2*pi*sway_frequency*swung);
  annotation(
    Documentation(info="<html>
<p>Equations: each lift is H min(1, max(0, (t - t_0)/(t_1 - t_0))), for t_1 up to t_0 a step H at t_0;
the sine A sin(2 pi f (t - t_s)) from t_s on. They add. Each kink and each step is an event.</p>
<p>Assumption: the workpiece moves as a whole and keeps its shape. Limit: speeds are not looked at.
Source: definition; step, ramp and sine are the courses by which a following control is judged.</p>
</html>"));
end Movement;
