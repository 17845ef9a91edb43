within AxisRig.Mechanics;
model FixedStop "Obstacle that can only push, contact by Hunt and Crossley"
  extends PartialStop;
  parameter Units.Stiffness stiffness = 20e6 "Force over penetration at the reference penetration"
    annotation(Dialog(group = "Contact"));
  parameter Units.Exponent exponent = 1 "Power of the penetration; 1: straight, 1.5: Hertz"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.Length reference_penetration(min = 1e-9) = 1e-5
    "Where the stiffness counts; without meaning for exponent 1"
    annotation(Dialog(group = "Fixed stop"));
  parameter Units.ContactDamping damping = 20 "Share of the spring force per velocity"
    annotation(Dialog(group = "Contact"));
protected
  Units.Length depth "Penetration while there is one";
equation
  depth = noEvent(if penetration > 0 then penetration else 0);
  force = if penetration > 0 and 1 + damping*velocity > 0
    then stiffness*depth*(depth/reference_penetration)^(exponent - 1)*(1 + damping*velocity)
    else 0;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{60, -70}, {76, 70}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-60, -30}, {20, 30}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{20, 0}, {60, 0}}, color = {255, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: F = max(0, k p (p/p_r)^(n-1) (1 + a dp/dt)) while p &gt; 0. With n = 1 it is
F = k p (1 + a dp/dt); a = 0 then gives a plain spring.</p>
<p>The damping share a makes the force continuous at touch and lets it end at zero when the slide
leaves; the velocity is never set, so energy is only lost. Coefficient of restitution e at the
speed v of impact from a v (1 + e) = ln((1 + a v)/(1 - a e v)). The largest force exceeds the
v sqrt(k m) of an undamped stop: by 9 % at a v = 2 and n = 1.</p>
<p>Assumption: no mass moves with the stop. Limit: one point of contact; stops of machines have 20 to
500 N/um. Source: K. H. Hunt, F. R. E. Crossley, Coefficient of restitution interpreted as damping
in vibroimpact, J. Applied Mechanics 42 (1975).</p>
</html>"));
end FixedStop;
