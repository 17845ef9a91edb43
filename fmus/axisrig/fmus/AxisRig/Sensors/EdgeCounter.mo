within AxisRig.Sensors;
block EdgeCounter "Number and instant of the rising edges of a signal"
  input Boolean u "Signal";
  output Integer count(start = 0, fixed = true) "Rising edges since the start";
  output Units.Time last(start = 0, fixed = true) "Instant of the last rising edge";
equation
  when u then
    count = pre(count) + 1;
    last = time;
  end when;
  annotation(
    Documentation(info="<html>
<p>Equation: at each rising edge the number grows by 1 and the instant is kept. Assumption: a signal that
is true at the start has had no edge. Limit: before the first edge the instant is 0; only the last
instant is kept. Source: definition.</p>
</html>"));
end EdgeCounter;
