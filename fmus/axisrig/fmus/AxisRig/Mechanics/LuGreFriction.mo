within AxisRig.Mechanics;
model LuGreFriction "Friction with bristles: sticks, yields before it slides, Stribeck and viscous"
  extends PartialFriction;
  parameter Units.Force coulomb(min = 0) = 120
    "Force at creeping motion above the Stribeck range"
    annotation(Dialog(group = "Friction"));
  parameter Units.Force breakaway(min = 0) = 160 "Largest force before sliding"
    annotation(Dialog(group = "Friction"));
  parameter Units.Velocity stribeck(min = 1e-9) = 5e-3
    "Velocity over which breakaway falls to Coulomb"
    annotation(Dialog(group = "Friction"));
  parameter Units.Damping viscous = 800 "Force that grows with the velocity"
    annotation(Dialog(group = "Friction"));
  parameter Units.Stiffness bristle_stiffness(min = 1) = 20e6 "Stiffness while it sticks"
    annotation(Dialog(group = "Friction"));
  parameter Units.Damping bristle_damping = 4e3 "Damping while it sticks"
    annotation(Dialog(group = "Friction"));
  Units.Force bristle(start = 0, fixed = true) "Force of the bent bristles";
protected
  constant Units.Velocity rest = 1e-11 "Below it the magnitude of the velocity is rounded off";
  constant Units.Force least = 1e-9 "Keeps the division defined without friction";
  constant Units.Rate fastest = 5e4 "How fast the bristles follow at most";
  Units.Velocity speed "Magnitude of the velocity";
  Units.Force sliding "Force of steady sliding without the viscous part";
  Real bristle_rate(unit = "N/s") "How fast the force of the bristles changes";
equation
  speed = if velocity > rest then velocity elseif velocity < -rest then -velocity
    else noEvent(if velocity > rest then velocity elseif velocity < -rest then -velocity
      else velocity*(velocity/rest)*(1.5 - 0.5*(velocity/rest)^2));
  sliding = least + coulomb + (breakaway - coulomb)*exp(-(velocity/stribeck)^2);
  // Both branches have the same value where they meet.
  bristle_rate = noEvent(if bristle_stiffness*speed > fastest*sliding
    then fastest*((if velocity > 0 then sliding else -sliding) - bristle)
    else bristle_stiffness*(velocity - speed/sliding*bristle));
  der(bristle) = bristle_rate;
  flange.f = bristle + bristle_damping/bristle_stiffness*bristle_rate + viscous*velocity;
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
      Line(points = {{-50, -60}, {-40, -30}, {-36, 0}}, color = {0, 0, 127}),
      Line(points = {{-30, -60}, {-20, -30}, {-16, 0}}, color = {0, 0, 127}),
      Line(points = {{-10, -60}, {0, -30}, {4, 0}}, color = {0, 0, 127}),
      Line(points = {{10, -60}, {20, -30}, {24, 0}}, color = {0, 0, 127}),
      Line(points = {{30, -60}, {40, -30}, {44, 0}}, color = {0, 0, 127}),
      Rectangle(extent = {{-70, 0}, {70, 40}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: dz/dt = v - s0 |v| z/g(v), F = s0 z + s1 dz/dt + k_v v with
g(v) = F_c + (F_s - F_c) exp(-(v/v_s)^2); the state is the force s0 z.</p>
<p>Steady sliding gives g(v) sign(v) + k_v v. Below F_s it is a spring of stiffness s0: it holds its
position, and the slide yields by F/s0 (8 um at 160 N) before it slides.</p>
<p>Assumption: one mean bristle. Two changes keep it solvable in steps of some 10 us: within 1e-11 m/s, |v|
is a polynomial with the same value and slope at both ends, so that rest is no sequence of events;
and where the bristles would follow faster than in 20 us (default: above 0.3 m/s) they follow in
20 us, with the same steady force. Without friction (both forces zero) nothing but the viscous part
is left.</p>
<p>Limits: repeated load below F_s makes it drift; the values are chosen, not measured.</p>
<p>Source: C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, A new model for control of
systems with friction, IEEE Transactions on Automatic Control 40 (1995).</p>
</html>"));
end LuGreFriction;
