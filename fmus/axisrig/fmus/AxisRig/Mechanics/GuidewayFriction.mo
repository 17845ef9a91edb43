within AxisRig.Mechanics;
model GuidewayFriction "Coulomb, Stribeck and viscous friction against the ground"
  extends PartialFriction;
  parameter Units.Force coulomb = 120 "Force at creeping motion above the Stribeck range"
    annotation(Dialog(group = "Friction"));
  parameter Units.Force breakaway = 160 "Largest force at the beginning of the motion"
    annotation(Dialog(group = "Friction"));
  parameter Units.Velocity stribeck = 5e-3 "Velocity over which breakaway falls to Coulomb"
    annotation(Dialog(group = "Friction"));
  parameter Units.Damping viscous = 800 "Force that grows with the velocity"
    annotation(Dialog(group = "Friction"));
  parameter Units.Velocity slope = 1e-4 "Velocity over which the force changes its sign"
    annotation(Dialog(group = "Friction"));
equation
  flange.f = (coulomb + (breakaway - coulomb)*exp(-(velocity/stribeck)^2))*tanh(velocity/slope)
    + viscous*velocity;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -60}, {80, -60}}, color = {0, 0, 0}),
      Line(points = {{-72, -74}, {-60, -60}}, color = {0, 0, 0}),
      Line(points = {{-52, -74}, {-40, -60}}, color = {0, 0, 0}),
      Line(points = {{-32, -74}, {-20, -60}}, color = {0, 0, 0}),
      Line(points = {{-12, -74}, {0, -60}}, color = {0, 0, 0}),
      Line(points = {{8, -74}, {20, -60}}, color = {0, 0, 0}),
      Line(points = {{28, -74}, {40, -60}}, color = {0, 0, 0}),
      Line(points = {{48, -74}, {60, -60}}, color = {0, 0, 0}),
      Line(points = {{68, -74}, {80, -60}}, color = {0, 0, 0}),
      Line(points = {{-70, -50}, {-40, -20}, {-10, -30}, {-4, 0}, {0, 20}, {10, 40}, {30, 20},
          {70, 60}}, color = {0, 0, 127}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: F = (F_c + (F_s - F_c) exp(-(v/v_s)^2)) tanh(v/v_0) + k_v v.</p>
<p>Assumption: the sign function is replaced by tanh, which keeps the force smooth. Limits: at rest
under load the slide creeps with v = v_0 F/F_s instead of sticking, and there is no pre-sliding;
the values are chosen, not measured. v_0 times the effective mass over F_s is a time constant
(0.12 ms) which shortens the internal step; LuGreFriction holds its position and is smoother when
the motion reverses.</p>
<p>Source: Armstrong-Helouvry, Dupont, Canudas de Wit, A survey of models, analysis tools and
compensation methods for the control of machines with friction, Automatica 30 (1994).</p>
</html>"));
end GuidewayFriction;
