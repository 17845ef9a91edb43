within AxisRig.Validation;
model VelocityController "A mass follows a step of the velocity demand through the force limit"
  Drives.VelocityController controller(
    gain = 7e4,
    integral_time = 8e-3,
    anti_windup_time = 5e-3);
  Drives.ForceActuator actuator(bandwidth = 800);
  Mechanics.Slide slide(mass = 190, weight = 40);
  output Units.Velocity velocity "Velocity of the mass";
  output Units.Force force "Force of the motor";
  output Units.Force integral "Integral part";
equation
  controller.velocity_reference = if time < 0.1001 then 0.05 else -0.02;
  controller.velocity = slide.velocity;
  controller.limit_positive = 400;
  controller.limit_negative = 400;
  controller.force_control = false;
  controller.force_demand = 0;
  controller.enabled = time < 0.17;
  actuator.force_reference = controller.force_reference;
  connect(actuator.flange, slide.flange);
  velocity = slide.velocity;
  force = actuator.force;
  integral = controller.integral;
  annotation(
    experiment(StopTime=0.2, Interval=0.001),
    Documentation(info="<html>
<p>Saturation in both directions, return from it, power off at 0.17 s.</p>
</html>"));
end VelocityController;
