within AxisRig.Mechanics;
model CrossBeam "Rigid beam on two parallel guideways"
  parameter Units.Mass mass(min = 1e-3) = 400 "Beam with what it carries"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Inertia inertia(min = 1e-6) = 150 "About the vertical through the centre of mass"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Length span(min = 1e-3) = 2 "Between both guideways"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Position offset = 0 "Centre of mass from the middle, towards the first guideway"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Position position_start = 0 "Position of both ends at the start"
    annotation(Dialog(group = "Start"));
  Interfaces.Flange flange_1 "End on the first guideway"
    annotation(Placement(transformation(extent = {{-110, -10}, {-90, 10}})));
  Interfaces.Flange flange_2 "End on the second guideway"
    annotation(Placement(transformation(extent = {{90, -10}, {110, 10}})));
  Units.Position position(start = position_start, fixed = true) "Centre of mass";
  Units.Velocity velocity(start = 0, fixed = true) "Velocity of the centre of mass";
  Units.Angle yaw(start = 0, fixed = true) "Positive when the first end is ahead";
  Units.AngularVelocity yaw_rate(start = 0, fixed = true) "How fast it turns";
equation
  der(position) = velocity;
  der(yaw) = yaw_rate;
  mass*der(velocity) = flange_1.f + flange_2.f;
  inertia*der(yaw_rate) = (span/2 - offset)*flange_1.f - (span/2 + offset)*flange_2.f;
  flange_1.s = position + (span/2 - offset)*yaw;
  flange_2.s = position - (span/2 + offset)*yaw;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-80, -15}, {80, 15}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -60}, {-80, 60}}, color = {0, 0, 0}),
      Line(points = {{80, -60}, {80, 60}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: m d2x/dt2 = f_1 + f_2, I d2w/dt2 = l_1 f_1 - l_2 f_2 with l_1 = L/2 - o,
l_2 = L/2 + o; ends at x + l_1 w and x - l_2 w.</p>
<p>Assumption: small angles (1 mm over 2 m is 0.5 mrad). Limit: the beam does not bend. Source:
Newton and Euler, plane motion of a rigid body.</p>
</html>"));
end CrossBeam;
