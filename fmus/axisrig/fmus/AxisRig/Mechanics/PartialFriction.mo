within AxisRig.Mechanics;
partial model PartialFriction "What every friction against the ground has in common"
  Interfaces.Flange flange "Moving side";
  Units.Velocity velocity "Velocity against the ground";
equation
  velocity = der(flange.s);
  annotation(
    Documentation(info="<html>
<p>Equation: v = ds/dt. A model that extends this one says how the force of the flange follows.</p>
<p>Assumption: the ground does not move. Limit: one axis, no lateral motion. Source: geometry.</p>
</html>"));
end PartialFriction;
