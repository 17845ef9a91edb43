within AxisRig.Drives;
model ScrewAxis "Ball screw axis: motor and slide joined by an elastic screw with backlash"
  extends PartialAxis;
  parameter Units.Force weight = 0 "Weight that no counterbalance carries, pulls towards negative";
  parameter Units.Stiffness screw_stiffness = 120e6 "Screw, nut and bearing, at the slide";
  parameter Units.Damping screw_damping = 6e3 "Damping of the screw, at the slide";
  parameter Units.Damping motor_friction = 100 "Viscous friction of the motor, at the slide";
  parameter Units.Length backlash = 0 "Free travel of the nut; 0: preloaded nut";
protected
  Mechanics.Slide rotor(mass = rotor_mass, position_start = position_start);
  Mechanics.Slide slide(mass = mass, weight = weight, position_start = position_start);
  Mechanics.ElasticJoint screw(
    stiffness = screw_stiffness,
    damping = screw_damping,
    backlash = backlash);
  Mechanics.ViscousFriction bearings(viscous = motor_friction);
  Mechanics.LuGreFriction friction;
equation
  connect(drive.flange, rotor.flange);
  connect(bearings.flange, rotor.flange);
  connect(rotor.flange, screw.flange_a);
  connect(screw.flange_b, slide.flange);
  connect(friction.flange, slide.flange);
  connect(stop.flange, slide.flange);
  position = slide.position;
  velocity = slide.velocity;
  annotation(
    Documentation(info="<html>
<p>Equation: rotor J (2 pi/h)^2 dv_m/dt = F_motor - k_m v_m - F_s,
slide m dv/dt = F_s - F_friction - F_stop -
F_g with F_s of ElasticJoint. The encoder sits on the motor: motor_position differs from position by
F_s/k and half the backlash, with the sign of the load.</p>
<p>Modes with the default values: 159 Hz with the motor locked, sqrt(k/m)/(2 pi), and 261 Hz free,
sqrt(k/m + k/m_r)/(2 pi).</p>
<p>Assumptions: two masses; dry friction acts on the slide. Limits: no bending of the screw, stiffness
does not depend on the position. Source: the parts; two masses with LuGre friction and backlash are
the usual form in literature, e.g. Mechanical Sciences 12 (2021) 791.</p>
</html>"));
end ScrewAxis;
