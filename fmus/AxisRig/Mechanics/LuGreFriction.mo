within AxisRig.Mechanics;
model LuGreFriction "Friction with bristles: sticks, yields before it slides, Stribeck and viscous"
  extends PartialFriction;
  parameter Units.Force coulomb = 120 "Force at creeping motion beyond the Stribeck range";
  parameter Units.Force breakaway(min = 1e-9) = 160 "Largest force before sliding";
  parameter Units.Velocity stribeck(min = 1e-9) = 5e-3
    "Velocity over which breakaway falls to Coulomb";
  parameter Units.Damping viscous = 800 "Force that grows with the velocity";
  parameter Units.Stiffness bristle_stiffness = 20e6 "Stiffness while it sticks";
  parameter Units.Damping bristle_damping = 4e3 "Damping while it sticks";
  Units.Position deflection(start = 0, fixed = true) "Mean deflection of the bristles";
protected
  constant Units.Velocity rest = 1e-11 "Below it the magnitude of the velocity is rounded off";
  Units.Velocity speed "Magnitude of the velocity";
  Units.Velocity deflection_rate "How fast the bristles bend";
  Units.Force sliding "Force of steady sliding without the viscous part";
equation
  speed = if velocity > rest then velocity elseif velocity < -rest then -velocity
    else noEvent(if velocity > rest then velocity elseif velocity < -rest then -velocity
      else velocity*(velocity/rest)*(1.5 - 0.5*(velocity/rest)^2));
  sliding = coulomb + (breakaway - coulomb)*exp(-(velocity/stribeck)^2);
  deflection_rate = velocity - bristle_stiffness*speed/sliding*deflection;
  der(deflection) = deflection_rate;
  flange.f = bristle_stiffness*deflection + bristle_damping*deflection_rate + viscous*velocity;
  annotation(
    Documentation(info="<html>
<p>Equation: dz/dt = v - s0 |v| z/g(v), F = s0 z + s1 dz/dt + k_v v with
g(v) = F_c + (F_s - F_c) exp(-(v/v_s)^2).</p>
<p>Steady sliding gives g(v) sign(v) + k_v v. Below F_s it is a spring of stiffness s0: it holds its
position, and the slide yields by F/s0 (8 um at 160 N) before it slides.</p>
<p>Assumption: one mean bristle. Within 1e-11 m/s, |v| is replaced by a polynomial with the same
value and slope at both ends, so that rest is no sequence of events. Limits: the pole s0 |v|/g grows
with the speed (83 000 1/s at 0.5 m/s), the internal step must stay below 2.7 g/(s0 |v|); repeated
load below F_s makes it drift. The values are chosen, not measured.</p>
<p>Source: C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, A new model for control of
systems with friction, IEEE Transactions on Automatic Control 40 (1995).</p>
</html>"));
end LuGreFriction;
