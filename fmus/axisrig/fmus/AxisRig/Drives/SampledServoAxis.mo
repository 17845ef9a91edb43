within AxisRig.Drives;
model SampledServoAxis "Rigid axis with sampled velocity loop, motor winding and LuGre friction"
  extends PartialAxis(
    redeclare SampledCascade drive(
      sample_period = sample_period,
      torque_constant = torque_constant,
      resistance = resistance,
      inductance = inductance,
      voltage_limit = voltage_limit,
      screw_lead = screw_lead));
  parameter Units.Force weight = 0 "Weight that no counterbalance carries, pulls towards negative"
    annotation(Dialog(group = "Masses and transmission"));
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
protected
  Mechanics.Slide slide(mass = effective_mass, weight = weight, position_start = position_start)
    "Moving mass"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
  Mechanics.LuGreFriction friction "Friction of the guideway"
    annotation(Placement(transformation(extent = {{20, -60}, {60, -20}})));
equation
  connect(drive.flange, slide.flange)
    annotation(Line(points = {{-40, 25}, {-40, 25}, {-40, -60}, {-40, -60}}, color = {0, 127, 0}));
  connect(friction.flange, slide.flange)
    annotation(Line(points = {{40, -60}, {-40, -60}}, color = {0, 127, 0}));
  connect(stop.flange, slide.flange)
    annotation(Line(points = {{40, 25}, {0, 25}, {0, -60}, {-40, -60}}, color = {0, 127, 0}));
  position = slide.position;
  velocity = slide.velocity;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-70, -40}, {70, -20}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-30, -20}, {30, 30}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{-70, -50}, {70, -50}}, color = {0, 0, 0}),
      Text(extent = {{-30, 30}, {30, 80}}, textString = "T"),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>As ServoAxis, nearer to a digital drive: the velocity loop computes every 62.5 us and holds its
demand, the current loop feeds a winding with a voltage limit, friction sticks.
Equations: those of the parts.</p>
<p>Assumption: rigid between motor and slide. Limit: position and current loop are continuous.
Source: the parts.</p>
</html>"));
end SampledServoAxis;
