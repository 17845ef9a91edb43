within AxisRig.Workpieces;
partial block Profile "Surface that changes in one direction only"
  extends Surface;
  parameter Units.Angle azimuth = 0 "Direction of the profile from x towards y";
protected
  final parameter Real along_x(unit = "1") = cos(azimuth) "x of the direction of the profile";
  final parameter Real along_y(unit = "1") = sin(azimuth) "y of the direction of the profile";
  Units.Position s[points] "Place on the profile";
  Units.Slope slope[slopes] "Derivative of the height by s";
equation
  for i in 1:points loop
    s[i] = along_x*x[i] + along_y*y[i];
  end for;
  for i in 1:slopes loop
    slope_x[i] = along_x*slope[i];
    slope_y[i] = along_y*slope[i];
  end for;
  annotation(
    Documentation(info="<html>
<p>Equations: s = x cos a + y sin a, dh/dx = h'(s) cos a, dh/dy = h'(s) sin a.</p>
</html>"));
end Profile;
