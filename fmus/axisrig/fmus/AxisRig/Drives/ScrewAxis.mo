within AxisRig.Drives;
model ScrewAxis "Ball screw axis: motor and slide joined by an elastic screw with backlash"
  extends PartialAxis;
  parameter Units.Force weight = 0 "Weight that no counterbalance carries, pulls towards negative"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Stiffness screw_stiffness = 120e6 "Screw, nut and bearing, at the slide"
    annotation(Dialog(group = "Elastic parts"));
  parameter Units.Damping screw_damping = 6e3 "Damping of the screw, at the slide"
    annotation(Dialog(group = "Elastic parts"));
  parameter Units.Damping motor_friction = 100 "Viscous friction of the motor, at the slide"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Length backlash = 0 "Free travel of the nut; 0: preloaded nut"
    annotation(Dialog(group = "Elastic parts"));
protected
  Mechanics.Slide rotor(mass = rotor_mass, position_start = position_start)
    "Rotating parts, in terms of the slide"
    annotation(Placement(transformation(extent = {{-67, -34}, {-39, -6}})));
  Mechanics.Slide slide(mass = mass, weight = weight, position_start = position_start)
    "Moving mass"
    annotation(Placement(transformation(extent = {{-14, -34}, {14, -6}})));
  Mechanics.ElasticJoint screw(
    stiffness = screw_stiffness,
    damping = screw_damping,
    backlash = backlash)
    "Ball screw"
    annotation(Placement(transformation(extent = {{39, -34}, {67, -6}})));
  Mechanics.ViscousFriction bearings(viscous = motor_friction) "Friction of the motor"
    annotation(Placement(transformation(extent = {{-67, -74}, {-39, -46}})));
  Mechanics.LuGreFriction friction "Friction of the guideway"
    annotation(Placement(transformation(extent = {{-14, -74}, {14, -46}})));
equation
  connect(drive.flange, rotor.flange)
    annotation(Line(points = {{-40, 25}, {-46, 25}, {-46, -34}, {-53, -34}}, color = {0, 127, 0}));
  connect(bearings.flange, rotor.flange)
    annotation(Line(points = {{-53, -74}, {-53, -74}, {-53, -34}, {-53, -34}}, color = {0, 127, 0}));
  connect(rotor.flange, screw.flange_a)
    annotation(Line(points = {{-53, -34}, {-7, -34}, {-7, -20}, {39, -20}}, color = {0, 127, 0}));
  connect(screw.flange_b, slide.flange)
    annotation(Line(points = {{67, -20}, {34, -20}, {34, -34}, {0, -34}}, color = {0, 127, 0}));
  connect(friction.flange, slide.flange)
    annotation(Line(points = {{0, -74}, {0, -74}, {0, -34}, {0, -34}}, color = {0, 127, 0}));
  connect(stop.flange, slide.flange)
    annotation(Line(points = {{40, 25}, {20, 25}, {20, -34}, {0, -34}}, color = {0, 127, 0}));
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
      Line(points = {{-68, -40}, {-60, -20}}, color = {0, 0, 0}),
      Line(points = {{-56, -40}, {-48, -20}}, color = {0, 0, 0}),
      Line(points = {{-44, -40}, {-36, -20}}, color = {0, 0, 0}),
      Line(points = {{-32, -40}, {-24, -20}}, color = {0, 0, 0}),
      Line(points = {{-20, -40}, {-12, -20}}, color = {0, 0, 0}),
      Line(points = {{-8, -40}, {0, -20}}, color = {0, 0, 0}),
      Line(points = {{4, -40}, {12, -20}}, color = {0, 0, 0}),
      Line(points = {{16, -40}, {24, -20}}, color = {0, 0, 0}),
      Line(points = {{28, -40}, {36, -20}}, color = {0, 0, 0}),
      Line(points = {{40, -40}, {48, -20}}, color = {0, 0, 0}),
      Line(points = {{52, -40}, {60, -20}}, color = {0, 0, 0}),
      Ellipse(extent = {{-95, -50}, {-65, -10}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
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
