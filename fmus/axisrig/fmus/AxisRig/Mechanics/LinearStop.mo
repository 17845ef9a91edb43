within AxisRig.Mechanics;
model LinearStop "Obstacle that can only push, spring with damper"
  extends PartialStop;
  parameter Units.Stiffness stiffness = 20e6 "Stiffness of the contact";
  parameter Units.Damping damping = 4e3 "Damping of the contact";
protected
  Units.Force both "Spring and damper";
equation
  both = stiffness*penetration + damping*velocity;
  force = if penetration > 0 and both > 0 then both else 0;
  annotation(
    Documentation(info="<html>
<p>Equation: F = max(0, k p + d dp/dt) while p &gt; 0.</p>
<p>Assumption: the damper acts from the first touch, so that the force jumps to d v there. Limit:
the jump is not what a real contact does; <code>FixedStop</code> is continuous. Source: K. L.
Johnson, Contact Mechanics, chapter 11 (Kelvin-Voigt element).</p>
</html>"));
end LinearStop;
