within AxisRig.Drives;
model SampledCascade "Drive with sampled velocity loop and motor winding"
  extends PartialCascade;
  parameter Units.Time sample_period(min = 1e-6) = 62.5e-6 "Cycle of the velocity loop"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.TorqueConstant torque_constant(min = 1e-6) = 0.49 "Torque per current"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Resistance resistance(min = 1e-6) = 3.07 "Of the motor winding"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Inductance inductance(min = 1e-6) = 6.57e-3 "Of the motor winding"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Voltage voltage_limit(min = 0) = 300 "What the inverter can give"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Length screw_lead(min = 1e-4) = 0.01 "Travel per revolution"
    annotation(Dialog(group = "Masses and transmission"));
protected
  SampledVelocityController velocity_controller(
    period = sample_period,
    gain = velocity_gain,
    integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time)
    "Velocity loop"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
  MotorWinding actuator(
    bandwidth = current_bandwidth,
    torque_constant = torque_constant,
    resistance = resistance,
    inductance = inductance,
    voltage_limit = voltage_limit,
    screw_lead = screw_lead)
    "Current loop and motor"
    annotation(Placement(transformation(extent = {{20, -60}, {60, -20}})));
equation
  velocity_controller.velocity_reference = velocity_reference;
  velocity_controller.velocity = motor_velocity;
  velocity_controller.limit_positive = limit_positive;
  velocity_controller.limit_negative = limit_negative;
  velocity_controller.enabled = enabled;
  velocity_controller.force_control = force_control;
  connect(reference_force, velocity_controller.force_demand)
    annotation(Line(points = {{-100, -90}, {-81, -90}, {-81, -58}, {-62, -58}}, color = {0, 0, 127}));
  connect(velocity_controller.force_reference, actuator.force_reference)
    annotation(Line(points = {{-18, -40}, {18, -40}}, color = {0, 0, 127}));
  connect(actuator.flange, flange)
    annotation(Line(points = {{40, -60}, {20, -60}, {20, -100}, {0, -100}}, color = {0, 127, 0}));
  force = actuator.force;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, 0}, {-50, 0}}, color = {0, 0, 0}),
      Rectangle(extent = {{-50, -25}, {-10, 25}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-10, 0}, {20, 0}}, color = {0, 0, 0}),
      Ellipse(extent = {{20, -25}, {70, 25}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-50, -70}, {-10, -30}}, textString = "T"),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: those of Setpoint, PositionController, SampledVelocityController and MotorWinding.</p>
<p>Assumption: position and current loop are continuous. Limit: no dead time of the computation.
Source: H. Gross et al., Electrical Feed Drives in Automation.</p>
</html>"));
end SampledCascade;
