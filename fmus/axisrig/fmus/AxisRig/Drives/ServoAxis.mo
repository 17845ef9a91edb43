within AxisRig.Drives;
model ServoAxis "Servo axis with position, velocity and current loop, friction and a fixed stop"
  extends PartialAxis;
  parameter Units.Force weight = 0 "Weight that no counterbalance carries, pulls towards negative"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Force coulomb_friction(min = 0) = 120 "Coulomb friction"
    annotation(Dialog(group = "Friction"));
  parameter Units.Force breakaway_friction(min = 0) = 160 "Breakaway force"
    annotation(Dialog(group = "Friction"));
  parameter Units.Velocity stribeck_velocity(min = 1e-6) = 5e-3
    "Velocity over which breakaway falls to Coulomb"
    annotation(Dialog(group = "Friction"));
  parameter Units.Damping viscous_friction = 800 "Viscous friction"
    annotation(Dialog(group = "Friction"));
  parameter Units.Velocity friction_slope_velocity(min = 1e-6) = 1e-4
    "Velocity over which friction changes its sign"
    annotation(Dialog(group = "Friction"));
protected
  Mechanics.Slide slide(mass = effective_mass, weight = weight, position_start = position_start)
    "Moving mass"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
  Mechanics.GuidewayFriction friction(
    coulomb = coulomb_friction,
    breakaway = breakaway_friction,
    stribeck = stribeck_velocity,
    viscous = viscous_friction,
    slope = friction_slope_velocity)
    "Friction of the guideway"
    annotation(Placement(transformation(extent = {{20, -60}, {60, -20}})));
equation
  connect(drive.flange, slide.flange)
    annotation(Line(points = {{-40, 25}, {-40, 25}, {-40, -60}, {-40, -60}}, color = {0, 127, 0}));
  connect(friction.flange, slide.flange)
    annotation(Line(points = {{40, -60}, {-40, -60}}, color = {0, 127, 0}));
  connect(stop.flange, slide.flange)
    annotation(Line(points = {{40, 25}, {0, 25}, {0, -60}, {-40, -60}}, color = {0, 127, 0}));
  position = slide.position;
  velocity = slide.velocity;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-70, -40}, {70, -20}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-30, -20}, {30, 30}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{-70, -50}, {70, -50}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
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
