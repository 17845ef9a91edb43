within AxisRig.Drives;
model ServoAxis "Servo axis with position, velocity and current loop, friction and a fixed stop"
  extends PartialAxis;
  parameter Units.Force weight = 0 "Weight that no counterbalance carries, pulls towards negative";
  parameter Units.Force coulomb_friction(min = 0) = 120 "Coulomb friction";
  parameter Units.Force breakaway_friction(min = 0) = 160 "Breakaway force";
  parameter Units.Velocity stribeck_velocity(min = 1e-6) = 5e-3
    "Velocity over which breakaway falls to Coulomb";
  parameter Units.Damping viscous_friction = 800 "Viscous friction";
  parameter Units.Velocity friction_slope_velocity(min = 1e-6) = 1e-4
    "Velocity over which friction changes its sign";
protected
  Mechanics.Slide slide(mass = effective_mass, weight = weight, position_start = position_start);
  Mechanics.GuidewayFriction friction(
    coulomb = coulomb_friction,
    breakaway = breakaway_friction,
    stribeck = stribeck_velocity,
    viscous = viscous_friction,
    slope = friction_slope_velocity);
equation
  connect(drive.flange, slide.flange);
  connect(friction.flange, slide.flange);
  connect(stop.flange, slide.flange);
  position = slide.position;
  velocity = slide.velocity;
  annotation(
    Documentation(info="<html>
<p>The cascade: straight setpoint, P position loop, PI velocity loop with force limit and
anti-windup, first-order current loop; then one rigid mass with friction, a weight and a fixed stop.
The parts hold the equations. Equation of the mass: m_eff = m + J (2 pi/h)^2 with the screw lead
h.</p>
<p>Steady lag in motion with constant v: (1 - f) v/Kv. Contact at standstill with the stop at the
force limit: penetration (F_lim - F_g)/k.</p>
<p>Assumptions and limits: rigid between motor and slide (motor_position = position), no backlash,
no brake; continuous controllers. The default values describe a 2.2 Nm motor on a 10 mm screw.
Source: the parts.</p>
</html>"));
end ServoAxis;
