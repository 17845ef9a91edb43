within AxisRig.Drives;
model SampledCascade "Drive with sampled velocity loop and motor winding"
  extends PartialCascade;
  parameter Units.Time sample_period(min = 1e-6) = 62.5e-6 "Cycle of the velocity loop";
  parameter Units.TorqueConstant torque_constant(min = 1e-6) = 0.49 "Torque per current";
  parameter Units.Resistance resistance(min = 1e-6) = 3.07 "Of the motor winding";
  parameter Units.Inductance inductance(min = 1e-6) = 6.57e-3 "Of the motor winding";
  parameter Units.Voltage voltage_limit(min = 0) = 300 "What the inverter can give";
  parameter Units.Length screw_lead(min = 1e-4) = 0.01 "Travel per revolution";
protected
  SampledVelocityController velocity_controller(
    period = sample_period,
    gain = velocity_gain,
    integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time);
  MotorWinding actuator(
    bandwidth = current_bandwidth,
    torque_constant = torque_constant,
    resistance = resistance,
    inductance = inductance,
    voltage_limit = voltage_limit,
    screw_lead = screw_lead);
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
<p>Equations: those of Setpoint, PositionController, SampledVelocityController and MotorWinding.</p>
<p>Assumption: position and current loop are continuous. Limit: no dead time of the computation.
Source: H. Gross et al., Electrical Feed Drives in Automation.</p>
</html>"));
end SampledCascade;
