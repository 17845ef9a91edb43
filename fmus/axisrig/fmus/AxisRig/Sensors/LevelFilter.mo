within AxisRig.Sensors;
block LevelFilter "Passes a level only after it has rested for a time"
  parameter Units.Time rest_time(min = 0) = 0 "For how long a level must rest";
  input Boolean u "Input";
  output Boolean y "Level that has rested";
  output Boolean waiting "A level is resting and not yet passed";
protected
  constant Units.Time never = 1e60;
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
    Documentation(info="<html>
<p>Equation: y(t) = u(t) when u has not changed since t - T, else y stays. An edge passes T later, a
pulse shorter than T not at all. The level at the start counts as rested.</p>
<p>Assumption: continuous filter. Limit: the sampling of a digital filter is left out. Source: input
filters of drives and terminals are set as such a time.</p>
</html>"));
end LevelFilter;
