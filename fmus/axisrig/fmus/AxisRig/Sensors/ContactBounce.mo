within AxisRig.Sensors;
block ContactBounce "Contact that opens and closes again some times after it has switched"
  parameter Integer closing_count(min = 0, max = 100) = 0 "How often it opens again after closing"
    annotation(Dialog(group = "Parameters"));
  parameter Integer opening_count(min = 0, max = 100) = 0 "How often it closes again after opening"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time duration(min = 1e-9) = 1e-3 "From the first edge to the last"
    annotation(Dialog(group = "Parameters"));
  Interfaces.BooleanInput u "Contact without bounce"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.BooleanOutput y "Contact"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.BooleanOutput bouncing "Between the first edge and the last"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  constant Units.Time never = 1e60 "Later than any run";
  Integer left(start = 0, fixed = true) "Edges still to come";
  Boolean flipped(start = false, fixed = true) "The contact is not where it will stay";
  Units.Time interval(start = 0, fixed = true) "Between two edges";
  Units.Time next(start = never, fixed = true) "When the next edge comes";
equation
  when u then
    left = 2*closing_count;
    flipped = false;
    interval = duration/max(1, 2*closing_count);
    next = if closing_count > 0 then time + duration/max(1, 2*closing_count) else never;
  elsewhen not u then
    left = 2*opening_count;
    flipped = false;
    interval = duration/max(1, 2*opening_count);
    next = if opening_count > 0 then time + duration/max(1, 2*opening_count) else never;
  elsewhen time >= pre(next) then
    left = pre(left) - 1;
    flipped = not pre(flipped);
    interval = pre(interval);
    next = if pre(left) > 1 then pre(next) + pre(interval) else never;
  end when;
  y = u <> flipped;
  bouncing = left > 0;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -40}, {-40, -40}, {-40, 40}, {-20, 40}, {-20, -40}, {0, -40}, {0, 40},
          {20, 40}, {20, -40}, {35, -40}, {35, 40}, {80, 40}}, color = {255, 0, 255}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: after an edge of the input at t the output follows at once and then changes 2 n times, at
t + k T/(2 n), k = 1 to 2 n; it rests from t + T on. A new edge of the input ends the bouncing of
the one before.</p>
<p>Assumption: equal intervals, which makes every instant a closed form; real ones become shorter.
Limit: the number does not depend on the speed. Source: switching contacts bounce 2 to 5 times within
0.2 to 2 ms; chosen, not measured.</p>
</html>"));
end ContactBounce;
