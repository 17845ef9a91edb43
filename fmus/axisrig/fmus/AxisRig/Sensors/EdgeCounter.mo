within AxisRig.Sensors;
block EdgeCounter "Number and instant of the rising edges of a signal"
  Interfaces.BooleanInput u "Signal"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.IntegerOutput count(start = 0, fixed = true) "Rising edges since the start"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.TimeOutput last(start = 0, fixed = true) "Instant of the last rising edge"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
equation
  when u then
    count = pre(count) + 1;
    last = time;
  end when;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -40}, {-30, -40}, {-30, 40}, {30, 40}, {30, -40}, {80, -40}},
          color = {255, 0, 255}),
      Text(extent = {{-80, -90}, {80, -45}}, textString = "n"),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: at each rising edge the number grows by 1 and the instant is kept. Assumption: a signal that
is true at the start has had no edge. Limit: before the first edge the instant is 0; only the last
instant is kept. Source: definition.</p>
</html>"));
end EdgeCounter;
