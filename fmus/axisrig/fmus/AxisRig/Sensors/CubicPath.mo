within AxisRig.Sensors;
block CubicPath "Motion through two positions with given rates, as a cubic in time"
  input Units.Position start "Position at the beginning";
  input Units.Velocity start_rate "Rate at the beginning";
  input Units.Position finish "Position at the end";
  input Units.Velocity finish_rate "Rate at the end";
  input Units.Time span "Duration from beginning to end";
  input Real passed(unit = "1") "Share of the duration that has passed, 0..1";
  output Units.Position position "Position now";
equation
  position = start + passed*(span*start_rate
    + passed*((3*(finish - start) - span*(2*start_rate + finish_rate))
    + passed*(2*(start - finish) + span*(start_rate + finish_rate))));
  annotation(
    Documentation(info="<html>
<p>Equation: s(u) = h00 s0 + h10 T v0 + h01 s1 + h11 T v1 with the cubic Hermite base functions, written
in the Horner form.</p>
<p>Assumption: position and rate are those of the axis at both ends. Limit: exact for motions whose
acceleration is linear in time; across an acceleration
step of da inside the duration T the error is at most 0.0162 da T^2.</p>
<p>Source: C. de Boor, A Practical Guide to Splines, chapter IV.</p>
</html>"));
end CubicPath;
