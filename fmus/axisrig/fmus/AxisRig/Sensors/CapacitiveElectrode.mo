within AxisRig.Sensors;
block CapacitiveElectrode "What a disc electrode reports of the gaps below it"
  parameter Units.Length radius(min = 1e-6) = 2e-3 "Radius of the disc"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Share tilt_excess(max = 20) = 0 "Tilt factor minus that of the ideal disc"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Share nonlinearity(min = -1) = 0 "Share of nonlinearity that is left"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length full_scale(min = 1e-6) = 10e-3 "Full scale"
    annotation(Dialog(group = "Parameters"));
  Interfaces.PositionInput gaps[7] "Gaps at the points of the disc"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.SlopeInput slope_x "Slope of the surface below the centre: x"
    annotation(Placement(transformation(extent = {{-120, 20}, {-100, 40}})));
  Interfaces.SlopeInput slope_y "Slope of the surface below the centre: y"
    annotation(Placement(transformation(extent = {{-120, -40}, {-100, -20}})));
  Interfaces.ShareInput lost "Share of the disc without material below"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.PositionOutput averaged "Distance of a plane with the same capacitance"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.PositionOutput seen "The same with the excess of the tilt error"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
  Interfaces.PositionOutput linearised "What the linearised electronics report, within 0..full_scale"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  constant Units.Length smallest = 1e-6 "Gaps below count as this";
  constant Units.Share least = 1e-9 "Shares of the disc below count as this";
  Real share_per_gap[7](each unit = "1/m") "Weight over gap";
  Units.Position limited "seen, within 0..full_scale";
equation
  share_per_gap[1] = 0.25/max(smallest, gaps[1]);
  for i in 2:7 loop
    share_per_gap[i] = 0.125/max(smallest, gaps[i]);
  end for;
  averaged = 1/(max(least, 1 - lost)*sum(share_per_gap));
  seen = max(0, averaged
    - tilt_excess*radius^2*(slope_x^2 + slope_y^2)/(4*max(smallest, averaged)));
  limited = if seen < full_scale then seen else full_scale;
  linearised = limited + nonlinearity*limited*(1 - limited/full_scale);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-50, 0}, {50, 20}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 20}, {0, 70}}, color = {0, 0, 0}),
      Rectangle(extent = {{-80, -50}, {80, -30}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: each element of the disc is a plate capacitor, so that the disc reports the harmonic mean
of the gaps: 1/d = (1 - lost) mean(1/d_i). The mean over the disc is a rule with seven points, exact
for polynomials up to the fifth degree: weight 1/4 in the centre and 1/8 at the six points with
sqrt(2/3) of the radius. Over a plane inclined by b it gives
d (1 + sqrt(1 - (r tan b/d)^2))/2, to 1e-5 for r tan b/d up to 0.3; for small tilt
d - (r tan b)^2/(4 d).</p>
<p>Electrodes in practice show the tilt error k (r tan b)^2/(4 d) with k about 5; tilt_excess is k - 1. What the
linearisation leaves within the range: d + c d (1 - d/full_scale), c within 0.5 to 2 %.</p>
<p>Assumptions: no stray field; what is outside a border adds nothing. Limit: a flank shorter than the
disc is seen in steps of an eighth. Source: plate capacitor; Abramowitz, Stegun, Handbook of Mathematical
Functions, 25.4.61; Lion Precision, Capacitive sensor operation, note on probe tilt.</p>
</html>"));
end CapacitiveElectrode;
