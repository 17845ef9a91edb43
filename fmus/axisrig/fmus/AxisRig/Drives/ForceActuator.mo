within AxisRig.Drives;
model ForceActuator "Current loop, motor and screw: force at the slide with first-order lag"
  parameter Units.Frequency bandwidth = 800 "Bandwidth of the current loop"
    annotation(Dialog(group = "Motor and current loop"));
  Interfaces.ForceInput force_reference "Demand"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.Flange flange "Slide side"
    annotation(Placement(transformation(extent = {{-10, -110}, {10, -90}})));
  Units.Force force(start = 0, fixed = true) "Force on the slide";
protected
equation
  der(force) = 2*Constants.pi*bandwidth*(force_reference - force);
  flange.f = -force;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-50, -50}, {50, 50}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-80, -40}, {80, 40}}, textString = "M"),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: dF/dt = 2 pi f_c (F_ref - F).</p>
<p>Assumption: the closed current loop is a first-order lag. Limits: no ripple, no voltage limit,
no thermal limit. Source: H. Gross et al., Electrical Feed Drives in Automation, chapter on current
control.</p>
</html>"));
end ForceActuator;
