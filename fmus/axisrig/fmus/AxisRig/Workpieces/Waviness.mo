within AxisRig.Workpieces;
block Waviness "Sum of sinusoidal profiles"
  extends Profile;
  constant Integer waves = 4 "How many";
  parameter Units.Position amplitude[waves] = {0.1e-3, 0.3e-3, 0.6e-3, 1e-3} "Of each wave"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length wavelength[waves](each min = 1e-6) = {0.05, 0.15, 0.3, 0.5} "Of each wave"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Angle phase[waves] = {0, 1, 2, 3} "Of each wave at s = 0"
    annotation(Dialog(group = "Parameters"));
protected
  Units.Position part[points, waves] "Height of each wave";
  Units.Slope part_slope[slopes, waves] "Slope of each wave";
  Units.Slope part_steepest[waves] "Largest slope of each wave";
equation
  // Sines take most of the time of a sensor; waves without amplitude cost none. The condition moves with
  // s because compilers fix parameters that alone decide an if.
  for i in 1:points loop
    for k in 1:waves loop
      part[i, k] = noEvent(if abs(amplitude[k]*(1 + s[i]^2)) > 0 then
        amplitude[k]*sin(2*Constants.pi*s[i]/wavelength[k] + phase[k]) else 0);
    end for;
    height[i] = sum(part[i, :]);
  end for;
  for i in 1:slopes loop
    for k in 1:waves loop
      part_slope[i, k] = noEvent(if abs(amplitude[k]*(1 + s[i]^2)) > 0 then
        2*Constants.pi*amplitude[k]/wavelength[k]
          *cos(2*Constants.pi*s[i]/wavelength[k] + phase[k]) else 0);
    end for;
    slope[i] = sum(part_slope[i, :]);
  end for;
  for k in 1:waves loop
    part_steepest[k] = 2*Constants.pi*abs(amplitude[k])/wavelength[k];
  end for;
  steepest = sum(part_steepest);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, -15}, {-70, -26}, {-60, -23}, {-50, -12}, {-40, -8},
          {-30, -15}, {-20, -22}, {-10, -17}, {0, 0}, {10, 17}, {20, 22}, {30, 15}, {40, 8}, {50,
          12}, {60, 23}, {70, 26}, {80, 15}, {80, -80}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: h = sum of A_k sin(2 pi s/l_k + p_k). The largest slope is the sum of those of the
waves. Assumption: waves in one direction with fixed phases. Limit: the bound is reached only where
all waves are steepest at one place. Source: Fourier series; wavelengths of 50 to 1000 mm with
amplitudes of about a 500th are typical of sheet, chosen, not measured.</p>
</html>"));
end Waviness;
