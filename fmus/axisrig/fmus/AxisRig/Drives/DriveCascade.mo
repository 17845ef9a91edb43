within AxisRig.Drives;
model DriveCascade "Drive with continuous velocity loop and current loop of first order"
  extends PartialCascade;
protected
  VelocityController velocity_controller(
    gain = velocity_gain,
    integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time);
  ForceActuator actuator(bandwidth = current_bandwidth);
equation
  velocity_controller.velocity_reference = velocity_reference;
  velocity_controller.velocity = motor_velocity;
  velocity_controller.limit_positive = limit_positive;
  velocity_controller.limit_negative = limit_negative;
  velocity_controller.enabled = enabled;
  velocity_controller.force_control = force_control;
  velocity_controller.force_demand = reference_force;
  actuator.force_reference = velocity_controller.force_reference;
  connect(actuator.flange, flange);
  force = actuator.force;
  annotation(
    Documentation(info="<html>
<p>Equations: those of Setpoint, PositionController, VelocityController and ForceActuator.</p>
<p>Assumption: all loops are continuous. Limit: no sampling, no voltage limit
(<code>SampledCascade</code> has both). Source: H. Gross et al., Electrical Feed Drives in
Automation.</p>
</html>"));
end DriveCascade;
