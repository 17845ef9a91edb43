within AxisRig.Workpieces;
block Sine "Sinusoidal profile"
  extends Profile;
  parameter Units.Position amplitude = 0.2e-3 "Half the height from valley to top"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Length wavelength(min = 1e-6) = 0.1 "Length of a wave"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Angle phase = 0 "At s = 0"
    annotation(Dialog(group = "Parameters"));
protected
  final parameter Real number(unit = "rad/m") = 2*Constants.pi/wavelength "Phase per length";
equation
  // Sines take most of the time of a sensor; without amplitude they cost none. The condition moves with
  // s because compilers fix parameters that alone decide an if.
  for i in 1:points loop
    height[i] = noEvent(if abs(amplitude*(1 + s[i]^2)) > 0 then
      amplitude*sin(number*s[i] + phase) else 0);
  end for;
  for i in 1:slopes loop
    slope[i] = noEvent(if abs(amplitude*(1 + s[i]^2)) > 0 then
      amplitude*number*cos(number*s[i] + phase) else 0);
  end for;
  steepest = abs(amplitude)*number;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-80, -80}, {-80, 23}, {-70, 11}, {-60, -4}, {-50, -18}, {-40, -27}, {-30,
          -30}, {-20, -25}, {-10, -14}, {0, 0}, {10, 14}, {20, 25}, {30, 30}, {40, 27}, {50, 18},
          {60, 4}, {70, -11}, {80, -23}, {80, -80}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: h = A sin(2 pi s/l + p). Assumption: pure sine. Limit: none. Source: definition; at the
feed v the height moves with the frequency v/l.</p>
</html>"));
end Sine;
