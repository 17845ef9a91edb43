within AxisRig.Mechanics;
model HoldingBrake "Brake closed by springs: takes time to open and to close"
  extends PartialFriction;
  parameter Units.Time opening_time(min = 1e-5) = 60e-3 "From release to no force";
  parameter Units.Time closing_time(min = 1e-5) = 20e-3 "From the end of the release to full force";
  parameter Units.Force holding_force(min = 1e-3) = 2000 "Largest force of the closed brake";
  parameter Units.Stiffness stiffness = 100e6 "Stiffness of the closed brake";
  parameter Units.Damping damping = 20e3 "Damping of the closed brake";
  input Boolean released "Coil under voltage";
  Boolean open(start = false, fixed = true) "No force";
  Units.Force force "Force against the motion";
  Real travel(unit = "1", start = 0, fixed = true) "Of the armature: 0 closed, 1 open";
protected
  constant Units.Velocity rest = 1e-11 "Below it the magnitude of the velocity is rounded off";
  constant Units.Time relaxation = 1e-3 "How fast the open brake loses its deflection";
  Units.Position deflection(start = 0, fixed = true) "How far the closed brake has yielded";
  Units.Velocity speed "Magnitude of the velocity";
  Units.Velocity deflection_rate "How fast it yields";
equation
  der(travel) = if released and travel < 1 then 1/opening_time
    elseif not released and travel > 0 then -1/closing_time else 0;
  when travel >= 1 then
    open = true;
  elsewhen travel <= 0 then
    open = false;
  end when;
  speed = if velocity > rest then velocity elseif velocity < -rest then -velocity
    else noEvent(if velocity > rest then velocity elseif velocity < -rest then -velocity
      else velocity*(velocity/rest)*(1.5 - 0.5*(velocity/rest)^2));
  deflection_rate = if open then -deflection/relaxation
    else velocity - stiffness*speed/holding_force*deflection;
  der(deflection) = deflection_rate;
  force = if open then 0 else stiffness*deflection + damping*deflection_rate;
  flange.f = force;
  annotation(
    Documentation(info="<html>
<p>Equation: the armature travels from 0 to 1 in the opening time while released, back in the
closing time while not. At 1 the brake opens, at 0 it closes. Closed: dz/dt = v - k |v| z/F_h, F = k
z + d dz/dt (LuGre without Stribeck); open: F = 0.</p>
<p>At rest it carries up to F_h and yields by F/k; a larger load slips at F_h.</p>
<p>Assumption: the force is there at once when the armature has arrived. Limits: no wear, no heat; a
release shorter than the opening time does nothing. Times and force are chosen after catalogues of
motor brakes. Source: Canudas de Wit et al., IEEE Transactions on Automatic Control 40 (1995).</p>
</html>"));
end HoldingBrake;
