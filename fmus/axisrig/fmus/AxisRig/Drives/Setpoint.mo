within AxisRig.Drives;
block Setpoint "Demand between two instants of the fieldbus, straight in time"
  Interfaces.PositionInput reference_position "Demand at reference_time"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.VelocityInput reference_velocity "Slope of the demand until reference_end"
    annotation(Placement(transformation(extent = {{-120, 44}, {-100, 64}})));
  Interfaces.TimeInput reference_time "Instant of reference_position"
    annotation(Placement(transformation(extent = {{-120, 8}, {-100, 28}})));
  Interfaces.TimeInput reference_end "Instant from which the demand rests"
    annotation(Placement(transformation(extent = {{-120, -28}, {-100, -8}})));
  Interfaces.AccelerationInput reference_acceleration
    "Slope of a demanded velocity until reference_end"
    annotation(Placement(transformation(extent = {{-120, -64}, {-100, -44}})));
  Interfaces.BooleanInput velocity_control "The demand is a velocity"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.PositionOutput position "Demand now"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.VelocityOutput velocity "Velocity demand, or slope of the position demand, now"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
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
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -60}, {-20, -20}, {20, 50}, {80, 50}}, color = {0, 0, 127}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: x(t) = x_r + v_r (min(t, t_end) - t_r); a demanded velocity is
v(t) = v_r + a_r (min(t, t_end) - t_r) and stays at its last value. The end is an event of its own,
so that no internal step lies across it.</p>
<p>Assumption: the drive interpolates its demand linearly. Limit: the velocity of a position
demand steps at each new slope. Source: CiA 402-2, cyclic synchronous position and velocity mode
with interpolation time period.</p>
</html>"));
end Setpoint;
