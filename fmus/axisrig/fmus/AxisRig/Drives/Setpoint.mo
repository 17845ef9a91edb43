within AxisRig.Drives;
block Setpoint "Demand between two instants of the fieldbus, straight in time"
  input Units.Position reference_position "Demand at reference_time";
  input Units.Velocity reference_velocity "Slope of the demand until reference_end";
  input Units.Time reference_time "Instant of reference_position";
  input Units.Time reference_end "Instant from which the demand rests";
  input Units.Acceleration reference_acceleration "Slope of a demanded velocity until reference_end";
  input Boolean velocity_control "The demand is a velocity";
  output Units.Position position "Demand now";
  output Units.Velocity velocity "Velocity demand, or slope of the position demand, now";
protected
  Boolean moving "The demand still moves";
  Units.Time elapsed "For how long the demand has been moving";
equation
  moving = time < reference_end;
  elapsed = (if moving then time else reference_end) - reference_time;
  velocity = if velocity_control then reference_velocity + reference_acceleration*elapsed
    elseif moving then reference_velocity else 0;
  position = reference_position + reference_velocity*elapsed;
  annotation(
    Documentation(info="<html>
<p>Equation: x(t) = x_r + v_r (min(t, t_end) - t_r); a demanded velocity is
v(t) = v_r + a_r (min(t, t_end) - t_r) and stays at its last value. The end is an event of its own,
so that no internal step lies across it.</p>
<p>Assumption: the drive interpolates its demand linearly. Limit: the velocity of a position
demand steps at each new slope. Source: CiA 402-2, cyclic synchronous position and velocity mode
with interpolation time period.</p>
</html>"));
end Setpoint;
