within AxisRig.Workpieces;
block Sine "Sinusoidal profile"
  extends Profile;
  parameter Units.Position amplitude = 0.2e-3 "Half the height from valley to top";
  parameter Units.Length wavelength(min = 1e-6) = 0.1 "Length of a wave";
  parameter Units.Angle phase = 0 "At s = 0";
protected
  constant Real pi = 3.141592653589793;
  final parameter Real number(unit = "rad/m") = 2*pi/wavelength "Phase per length";
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
    Documentation(info="<html>
<p>Equation: h = A sin(2 pi s/l + p). Assumption: pure sine. Limit: none. Source: definition; at the
feed v the height moves with the frequency v/l.</p>
</html>"));
end Sine;
