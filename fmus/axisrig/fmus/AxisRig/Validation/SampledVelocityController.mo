within AxisRig.Validation;
model SampledVelocityController "The sampled loop on a mass, in the limit and out of it"
  Drives.SampledVelocityController controller(
    period = 62.5e-6,
    gain = 7e4,
    integral_time = 8e-3,
    anti_windup_time = 5e-3);
  Drives.ForceActuator actuator(bandwidth = 800);
  Mechanics.Slide slide(mass = 190, weight = 40);
  output Units.Velocity velocity "Velocity of the mass";
  output Units.Force force "Force of the motor";
  output Units.Force integral "Integral part";
equation
  controller.velocity_reference = if time < 0.05003 then 0.02 else -0.02;
  controller.velocity = slide.velocity;
  controller.limit_positive = 400;
  controller.limit_negative = 400;
  controller.force_control = false;
  controller.force_demand = 0;
  controller.enabled = time < 0.17003;
  actuator.force_reference = controller.force_reference;
  connect(actuator.flange, slide.flange);
  velocity = slide.velocity;
  force = actuator.force;
  integral = controller.integral;
  annotation(
    experiment(StopTime=0.2, Interval=0.00103),
    Documentation(info="<html>
<p>Linear between two instants of the controller: the reference is the exact discrete
simulation.</p>
</html>"));
end SampledVelocityController;
