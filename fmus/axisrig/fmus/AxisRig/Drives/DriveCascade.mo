within AxisRig.Drives;
model DriveCascade "Drive with continuous velocity loop and current loop of first order"
  extends PartialCascade;
protected
  VelocityController velocity_controller(
    gain = velocity_gain,
    integral_time = velocity_integral_time,
    anti_windup_time = anti_windup_time)
    "Velocity loop"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
  ForceActuator actuator(bandwidth = current_bandwidth) "Current loop and motor"
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
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: those of Setpoint, PositionController, VelocityController and ForceActuator.</p>
<p>Assumption: all loops are continuous. Limit: no sampling, no voltage limit
(<code>SampledCascade</code> has both). Source: H. Gross et al., Electrical Feed Drives in
Automation.</p>
</html>"));
end DriveCascade;
