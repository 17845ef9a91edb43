within AxisRig.Validation;
model MotorWinding "A step of the force demand at a moving motor, above the voltage limit"
  extends Icons.Experiment;
  Drives.MotorWinding winding(
    bandwidth = 800,
    torque_constant = 0.49,
    resistance = 3.07,
    inductance = 6.57e-3,
    voltage_limit = 100,
    screw_lead = 0.01)
    "Motor with its current loop"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Mechanics.Slide slide(mass = 190, velocity_start = 0.1) "Moving mass"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Units.Force force "Force on the mass";
  output Units.Current current "Current";
  output Units.Voltage voltage "Voltage";
  output Units.Velocity velocity "Velocity of the mass";
equation
  winding.force_reference = if time < 0.0101 then 1500 else -800;
  connect(winding.flange, slide.flange)
    annotation(Line(points = {{-40, -20}, {40, -20}}, color = {0, 127, 0}));
  force = winding.force;
  current = winding.current;
  voltage = winding.voltage;
  velocity = slide.velocity;
  annotation(
    experiment(StopTime=0.03, Interval=0.0002),
    Documentation(info="<html>
<p>The current rises as fast as the voltage allows, then follows the demand.</p>
</html>"));
end MotorWinding;
