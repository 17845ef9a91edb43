within AxisRig.Sensors;
block ThreeLegSeat "Pre-travel of a stylus whose seat rests on three pads, by direction"
  parameter Units.Force force = 2.5 "Spring force that keeps the stylus in its seat"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length length = 50e-3 "From the plane of the pads to the ball centre"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length radius(min = 1e-4) = 10e-3 "Of the circle of the pads"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Angle angle = 0 "Direction of the first pad from x"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Stiffness bending(min = 1) = 0.2e6 "Of the stylus across its axis"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Stiffness axial(min = 1) = 2e6 "Of the stylus along its axis"
    annotation(Dialog(group = "Parameters"));
  Interfaces.DirectionInput normal_x "Normal of the touched surface, towards free space: x"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.DirectionInput normal_y "Normal of the touched surface, towards free space: y"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.DirectionInput normal_z "Normal of the touched surface, towards free space: z"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.LengthOutput pretravel "From contact to the instant at which the first pad lifts"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
  Units.Force trigger_force "Contact force at that instant";
protected
  constant Real weakest(unit = "1") = 1e-3 "Of the share of the contact force that unloads a pad";
  final parameter Real lever(unit = "1") = 2*length/radius "Unloading per force";
  final parameter Real pad_1_x(unit = "1") = cos(angle)
    "Direction of pad 1: x";
  final parameter Real pad_1_y(unit = "1") = sin(angle)
    "Direction of pad 1: y";
  final parameter Real pad_2_x(unit = "1") = cos(angle + 2*Constants.pi/3)
    "Direction of pad 2: x";
  final parameter Real pad_2_y(unit = "1") = sin(angle + 2*Constants.pi/3)
    "Direction of pad 2: y";
  final parameter Real pad_3_x(unit = "1") = cos(angle - 2*Constants.pi/3)
    "Direction of pad 3: x";
  final parameter Real pad_3_y(unit = "1") = sin(angle - 2*Constants.pi/3)
    "Direction of pad 3: y";
  Real towards_pad(unit = "1") "Horizontal normal times the direction of the nearest pad";
equation
  towards_pad = max(normal_x*pad_1_x + normal_y*pad_1_y,
    max(normal_x*pad_2_x + normal_y*pad_2_y, normal_x*pad_3_x + normal_y*pad_3_y));
  trigger_force = force/max(weakest, normal_z + lever*towards_pad);
  pretravel = trigger_force
    *((normal_x^2 + normal_y^2)/bending + normal_z^2/axial);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-60, -60}, {60, 60}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{30, -10}, {50, 10}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-30, 25}, {-10, 45}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-30, -45}, {-10, -25}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: the contact force F n acts on the ball, at the stylus length L below the pads, which
lie on a circle of radius R at the angles phi_i, 120 degrees apart. Force and moments in equilibrium
give the load of pad i: N_i = (F_p - F n_z)/3 - 2 F L/(3 R) (n_x cos phi_i + n_y sin phi_i). The
probe triggers when the first one is 0: F = F_p/(n_z + 2 L/R max_i(n_x cos phi_i + n_y sin phi_i)).
Until then the stylus yields by F ((n_x^2 + n_y^2)/k_b + n_z^2/k_a) along the normal.</p>
<p>Across the axis F lies between F_p R/(2 L) towards a pad and F_p R/L between two pads: ratio 2:1,
every 120 degrees.</p>
<p>Assumptions: pads and contact without friction, stylus along z, small tilt. Limit: from below
(n_z near -1) the force presses the stylus into its seat; the trigger force is then bounded at 1000
seat forces, which means never. The default stiffnesses are chosen, not measured.</p>
<p>Source: moments about the line through two pads; W. T. Estler et al., Error compensation for CMM
touch trigger probes, Precision Engineering 19 (1996), on the three-leg seat.</p>
</html>"));
end ThreeLegSeat;
