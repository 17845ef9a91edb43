within AxisRig.Drives;
block Setpoint "Demand between two instants of the fieldbus, straight in time"
  input Units.Position reference_position "Demand at reference_time";
  input Units.Velocity reference_velocity "Slope of the demand until reference_end";
  input Units.Time reference_time "Instant of reference_position";
  input Units.Time reference_end "Instant from which the demand rests";
  output Units.Position position "Demand now";
  output Units.Velocity velocity "Slope of the demand now";
protected
  Boolean moving "The demand still moves";
equation
  moving = time < reference_end;
  velocity = if moving then reference_velocity else 0;
  position = reference_position
    + reference_velocity*((if moving then time else reference_end) - reference_time);
  annotation(
    Documentation(info="<html>
<p>Equation: x(t) = x_r + v_r (min(t, t_end) - t_r). The end is an event of its own, so that no
internal step lies across it.</p>
<p>Assumption: the drive interpolates its position demand linearly. Limit: the velocity of the
demand steps at each new slope. Source: CiA 402-2, cyclic
synchronous position mode with interpolation time period.</p>
</html>"));
end Setpoint;
