within AxisRig.Mechanics;
model ViscousFriction "Friction in proportion to the velocity"
  extends PartialFriction;
  parameter Units.Damping viscous = 100 "Force per velocity";
equation
  flange.f = viscous*velocity;
  annotation(
    Documentation(info="<html>
<p>Equation: F = k_v v.</p>
<p>Assumption: lubricated bearings and seals of a motor, whose dry part is small. Limit: nothing holds
at rest. Source: Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994).</p>
</html>"));
end ViscousFriction;
