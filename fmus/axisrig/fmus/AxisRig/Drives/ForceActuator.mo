within AxisRig.Drives;
model ForceActuator "Current loop, motor and screw: force at the slide with first-order lag"
  parameter Units.Frequency bandwidth = 800 "Bandwidth of the current loop";
  input Units.Force force_reference "Demand";
  Interfaces.Flange flange "Slide side";
  Units.Force force(start = 0, fixed = true) "Force on the slide";
protected
  constant Real pi = 3.141592653589793;
equation
  der(force) = 2*pi*bandwidth*(force_reference - force);
  flange.f = -force;
  annotation(
    Documentation(info="<html>
<p>Equation: dF/dt = 2 pi f_c (F_ref - F).</p>
<p>Assumption: the closed current loop is a first-order lag. Limits: no ripple, no voltage limit,
no thermal limit. Source: H. Gross et al., Electrical Feed Drives in Automation, chapter on current
control.</p>
</html>"));
end ForceActuator;
