within AxisRig.Mechanics;
model LinearStop "Obstacle that can only push, spring with damper"
  extends PartialStop;
  parameter Units.Stiffness stiffness = 20e6 "Stiffness of the contact"
    annotation(Dialog(group = "Contact"));
  parameter Units.Damping damping = 4e3 "Damping of the contact"
    annotation(Dialog(group = "Contact"));
protected
  Units.Force both "Spring and damper";
equation
  both = stiffness*penetration + damping*velocity;
  force = if penetration > 0 and both > 0 then both else 0;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{60, -70}, {76, 70}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Line(points = {{-60, 20}, {-30, 20}, {-20, 35}, {0, 5}, {20, 35}, {30, 20}, {60, 20}},
          color = {0, 0, 0}),
      Line(points = {{-60, -20}, {60, -20}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: F = max(0, k p + d dp/dt) while p &gt; 0.</p>
<p>Assumption: the damper acts from the first touch, so that the force jumps to d v there. Limit:
the jump is not what a real contact does; <code>FixedStop</code> is continuous. Source: K. L.
Johnson, Contact Mechanics, chapter 11 (Kelvin-Voigt element).</p>
</html>"));
end LinearStop;
