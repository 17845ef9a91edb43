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
  input Units.Force force_limit "Further limit of the motor force in both directions";
  input Units.Force force_limit_positive "Further limit of the motor force in positive direction";
  input Units.Force force_limit_negative "The same in negative direction, as an amount";
  input Integer control "What is controlled; 0: position, 1: velocity, 2: force";
  input Units.Acceleration reference_acceleration "Velocity control: slope of the demand";
  input Units.Force reference_force "Force control: demand";
  Interfaces.Flange flange "Motor with its encoder, in terms of the slide";
  Units.Velocity motor_velocity "Velocity of the motor encoder";
  Units.Position demand_position "Position demand";
  Units.Force force "Motor force on the slide";
  Units.Velocity velocity_reference "Demand for the velocity loop";
  Units.Force limit_positive "Limit of the motor force now, positive direction";
  Units.Force limit_negative "Limit of the motor force now, negative direction";
  Boolean force_control "A force is demanded";
protected
  Boolean velocity_control "A velocity is demanded";
  Units.Force limit "Limit of the motor force now, both directions";
  Setpoint setpoint;
  PositionController position_controller(kv = kv, feed_forward = feed_forward);
equation
  setpoint.reference_position = reference_position;
  setpoint.reference_velocity = reference_velocity;
  setpoint.reference_time = reference_time;
  setpoint.reference_end = reference_end;
  setpoint.reference_acceleration = reference_acceleration;
  setpoint.velocity_control = velocity_control;
  position_controller.demand_position = setpoint.position;
  position_controller.demand_velocity = setpoint.velocity;
  position_controller.position = flange.s;
  velocity_control = control == 1;
  force_control = control == 2;
  velocity_reference = if velocity_control then setpoint.velocity
    else position_controller.velocity_reference;
  motor_velocity = der(flange.s);
  demand_position = if velocity_control or force_control then flange.s else setpoint.position;
  limit = if force_limit < force_limit_motor then force_limit else force_limit_motor;
  limit_positive = if force_limit_positive < limit then force_limit_positive else limit;
  limit_negative = if force_limit_negative < limit then force_limit_negative else limit;
  annotation(
    Documentation(info="<html>
<p>Equation: v_ref = Kv (x_d - x) + f v_d with the position x of the motor encoder; in velocity
control v_ref = v_r + a_r (min(t, t_end) - t_r). The smallest of the three force limits of a direction
counts, whatever is controlled. Without a position demand demand_position is the position. A model
that extends this one adds velocity loop, current loop and motor.</p>
<p>Assumption: everything in terms of the slide. Limit: the sampling of the position loop is left
out. Source: H. Gross, J. Hamann, G. Wiegaertner, Electrical Feed Drives in Automation.</p>
</html>"));
end PartialCascade;
