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
  parameter Units.Force weight = 0 "Weight that no counterbalance carries, pulls towards negative";
  parameter Units.Time sample_period(min = 1e-6) = 62.5e-6 "Cycle of the velocity loop";
  parameter Units.TorqueConstant torque_constant(min = 1e-6) = 0.49 "Torque per current";
  parameter Units.Resistance resistance(min = 1e-6) = 3.07 "Of the motor winding";
  parameter Units.Inductance inductance(min = 1e-6) = 6.57e-3 "Of the motor winding";
  parameter Units.Voltage voltage_limit(min = 0) = 300 "What the inverter can give";
protected
  Mechanics.Slide slide(mass = effective_mass, weight = weight, position_start = position_start);
  Mechanics.LuGreFriction friction;
equation
  connect(drive.flange, slide.flange);
  connect(friction.flange, slide.flange);
  connect(stop.flange, slide.flange);
  position = slide.position;
  velocity = slide.velocity;
  annotation(
    Documentation(info="<html>
<p>As ServoAxis, nearer to a digital drive: the velocity loop computes every 62.5 us and holds its
demand, the current loop feeds a winding with a voltage limit, friction sticks.
Equations: those of the parts.</p>
<p>Assumption: rigid between motor and slide. Limit: position and current loop are continuous.
Source: the parts.</p>
</html>"));
end SampledServoAxis;
