within AxisRig.Validation;
model SampledVelocityController "The sampled loop on a mass, in the limit and out of it"
  extends Icons.Experiment;
  Drives.SampledVelocityController controller(
    period = 62.5e-6,
    gain = 7e4,
    integral_time = 8e-3,
    anti_windup_time = 5e-3)
    "Velocity loop under test"
    annotation(Placement(transformation(extent = {{-60, 20}, {-20, 60}})));
  Drives.ForceActuator actuator(bandwidth = 800) "Current loop and motor"
    annotation(Placement(transformation(extent = {{20, 20}, {60, 60}})));
  Mechanics.Slide slide(mass = 190, weight = 40) "Moving mass"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
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
  connect(controller.force_reference, actuator.force_reference)
    annotation(Line(points = {{-18, 40}, {18, 40}}, color = {0, 0, 127}));
  connect(actuator.flange, slide.flange)
    annotation(Line(points = {{40, 20}, {0, 20}, {0, -60}, {-40, -60}}, color = {0, 127, 0}));
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
