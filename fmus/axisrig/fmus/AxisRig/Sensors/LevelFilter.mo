within AxisRig.Sensors;
block LevelFilter "Passes a level only after it has rested for a time"
  parameter Units.Time rest_time(min = 0) = 0 "For how long a level must rest"
    annotation(Dialog(group = "Parameters"));
  Interfaces.BooleanInput u "Input"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.BooleanOutput y "Level that has rested"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.BooleanOutput waiting "A level is resting and not yet passed"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  constant Units.Time never = 1e60 "Later than any run";
  Units.Time changed(start = -never, fixed = true) "When the input changed last";
  Boolean passed(start = false, fixed = true) "Level that has rested";
equation
  when u then
    changed = time;
  elsewhen not u then
    changed = time;
  end when;
  passed = if time >= changed + rest_time then u else pre(passed);
  y = passed;
  waiting = u <> passed;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -40}, {-30, -40}, {-30, 40}, {30, 40}, {30, -40}, {80, -40}},
          color = {255, 0, 255}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: y(t) = u(t) when u has not changed since t - T, else y stays. An edge passes T later, a
pulse shorter than T not at all. The level at the start counts as rested.</p>
<p>Assumption: continuous filter. Limit: the sampling of a digital filter is left out. Source: input
filters of drives and terminals are set as such a time.</p>
</html>"));
end LevelFilter;
