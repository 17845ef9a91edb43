within AxisRig.Mechanics;
model ElasticJoint "Spring and damper between two flanges, with backlash"
  parameter Units.Stiffness stiffness = 120e6 "Stiffness in contact"
    annotation(Dialog(group = "Contact"));
  parameter Units.Damping damping = 6e3 "Damping in contact"
    annotation(Dialog(group = "Contact"));
  parameter Units.Length backlash = 0 "Free travel between both contacts; 0: always joined"
    annotation(Dialog(group = "Elastic parts"));
  Interfaces.Flange flange_a "Driving side"
    annotation(Placement(transformation(extent = {{-110, -10}, {-90, 10}})));
  Interfaces.Flange flange_b "Driven side"
    annotation(Placement(transformation(extent = {{90, -10}, {110, 10}})));
  Units.Position twist "How far the driving side is ahead";
  Units.Force force "Force on the driven side";
protected
  Boolean preloaded "Without backlash both contacts are closed";
  Units.Length reach "Twist at which a contact closes; out of reach when preloaded";
  Units.Velocity twist_rate "How fast the driving side gains";
  Units.Force ahead "Force of the contact when the driving side is ahead";
  Units.Force behind "Force of the contact when the driving side lags";
equation
  twist = flange_a.s - flange_b.s;
  twist_rate = der(flange_a.s) - der(flange_b.s);
  preloaded = backlash <= 0;
  // Rest without backlash is no place for relations: noise would cross them again and again.
  reach = if preloaded then 1e3 else backlash/2;
  ahead = stiffness*(twist - reach) + damping*twist_rate;
  behind = stiffness*(twist + reach) + damping*twist_rate;
  force = if preloaded then stiffness*twist + damping*twist_rate
    elseif twist > reach and ahead > 0 then ahead
    elseif twist < -reach and behind < 0 then behind
    else 0;
  flange_a.f = force;
  flange_b.f = -force;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, 20}, {-50, 20}, {-40, 40}, {-20, 0}, {0, 40}, {20, 0}, {40, 40}, {50,
          20}, {80, 20}}, color = {0, 0, 0}),
      Line(points = {{-80, -30}, {-10, -30}}, color = {0, 0, 0}),
      Rectangle(extent = {{-10, -45}, {30, -15}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{30, -30}, {80, -30}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: F = k e_c + d de/dt with e = s_a - s_b and e_c = e - b/2 for e &gt; b/2, e + b/2 for
e &lt; -b/2; a contact only pushes, and between both there is no force. Without backlash (preloaded
nut) F = k e + d de/dt throughout.</p>
<p>Assumption: no mass of its own. Limit: the damper acts from the first touch, so that the force
jumps there. Source: M. Nordin, P.-O. Gutman, Controlling mechanical systems with backlash,
Automatica 38 (2002).</p>
</html>"));
end ElasticJoint;
