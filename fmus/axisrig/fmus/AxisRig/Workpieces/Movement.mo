within AxisRig.Workpieces;
block Movement "How the whole workpiece moves up and down in time"
  parameter Units.Position lift = 0 "First lift, negative: it is lowered"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Time lift_begin = 0 "When it begins"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Time lift_end = 0 "When it is complete; not after the begin: a step at the begin"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Position lift_2 = 0 "Second lift, on top of the first"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Time lift_2_begin = 0 "When it begins"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Time lift_2_end = 0
    "When it is complete; not after the begin: a step at the begin"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Position sway = 0 "Amplitude of a sine in time"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Frequency sway_frequency = 1 "Its frequency"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Time sway_begin = 0 "When it begins, from 0 upwards"
    annotation(Dialog(group = "Motion of the workpiece"));
  Interfaces.PositionOutput height "By how much it has moved up"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
protected
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
  height = lift*first + lift_2*second + sway*sin(2*Constants.pi*sway_frequency*swung);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, -20}, {-70, -20}, {-60, -20}, {-50, -20}, {-40, -20},
          {-30, -20}, {-20, -20}, {-10, -20}, {0, -20}, {10, -20}, {20, -20}, {30, -20}, {40,
          -20}, {50, -20}, {60, -20}, {70, -20}, {80, -20}, {80, -80}}, fillColor = {200, 170,
          120}, fillPattern = FillPattern.Solid),
      Line(points = {{60, 10}, {60, 70}}, color = {0, 0, 0}),
      Polygon(points = {{50, 60}, {70, 60}, {60, 80}}, fillColor = {0, 127, 0},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: each lift is H min(1, max(0, (t - t_0)/(t_1 - t_0))), for t_1 up to t_0 a step H at t_0;
the sine A sin(2 pi f (t - t_s)) from t_s on. They add. Each kink and each step is an event.</p>
<p>Assumption: the workpiece moves as a whole and keeps its shape. Limit: speeds are not looked at.
Source: definition; step, ramp and sine are the courses by which a following control is judged.</p>
</html>"));
end Movement;
