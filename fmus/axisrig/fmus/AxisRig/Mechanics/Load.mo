within AxisRig.Mechanics;
model Load "Force from outside"
  input Units.Force force "Force on the part that it is joined to";
  Interfaces.Flange flange "Where it acts";
equation
  flange.f = -force;
  annotation(
    Documentation(info="<html>
<p>Equation: f = -F. Assumption: the force does not depend on the motion, or the model around says
how. Limit: none. Source: sign of the flange.</p>
</html>"));
end Load;
