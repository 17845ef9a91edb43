within AxisRig.Drives;
partial model PartialCascade "Setpoint and position loop of a drive; it moves a motor at its flange"
  parameter Units.Rate kv = 10 "Gain of the position loop";
  parameter Units.Share feed_forward = 0 "Share of velocity feed-forward";
  parameter Units.Damping velocity_gain = 7.2e4 "Proportional gain of the velocity loop";
  parameter Units.Time velocity_integral_time(min = 1e-5) = 8e-3
    "Integral time of the velocity loop";
  parameter Units.Time anti_windup_time(min = 1e-5) = 8e-3
    "Back-calculation time of the velocity loop";
  parameter Units.Frequency current_bandwidth(min = 1) = 800 "Bandwidth of the current loop";
  parameter Units.Force force_limit_motor(min = 0) = 4000
    "Largest motor force, in terms of the slide";
  input Units.Position reference_position "Demand at reference_time";
  input Units.Velocity reference_velocity "Slope of the demand until reference_end";
  input Units.Time reference_time "Instant of reference_position";
  input Units.Time reference_end "Instant from which the demand rests";
  input Boolean enabled "Power stage on";
  input Units.Force force_limit "Further limit of the motor force";
  Interfaces.Flange flange "Motor with its encoder, in terms of the slide";
  Units.Velocity motor_velocity "Velocity of the motor encoder";
  Units.Position demand_position "Position demand";
  Units.Force force "Motor force on the slide";
  Units.Velocity velocity_reference "Demand for the velocity loop";
  Units.Force limit "Limit of the motor force now";
protected
  Setpoint setpoint;
  PositionController position_controller(kv = kv, feed_forward = feed_forward);
equation
  setpoint.reference_position = reference_position;
  setpoint.reference_velocity = reference_velocity;
  setpoint.reference_time = reference_time;
  setpoint.reference_end = reference_end;
  position_controller.demand_position = setpoint.position;
  position_controller.demand_velocity = setpoint.velocity;
  position_controller.position = flange.s;
  velocity_reference = position_controller.velocity_reference;
  motor_velocity = der(flange.s);
  demand_position = setpoint.position;
  limit = if force_limit < force_limit_motor then force_limit else force_limit_motor;
  annotation(
    Documentation(info="<html>
<p>Equation: v_ref = Kv (x_d - x) + f v_d with the position x of the motor encoder. A model that
extends this one adds velocity loop, current loop and motor.</p>
<p>Assumption: everything in terms of the slide. Limit: the sampling of the position loop is left
out. Source: H. Gross, J. Hamann, G. Wiegaertner, Electrical Feed Drives in Automation.</p>
</html>"));
end PartialCascade;
