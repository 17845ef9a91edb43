within AxisRig.Mechanics;
model HoldingBrake "Brake closed by springs: takes time to open and to close"
  extends PartialFriction;
  parameter Units.Time opening_time(min = 1e-5) = 60e-3 "From release to no force"
    annotation(Dialog(group = "Brake"));
  parameter Units.Time closing_time(min = 1e-5) = 20e-3 "From the end of the release to full force"
    annotation(Dialog(group = "Brake"));
  parameter Units.Force holding_force(min = 1e-3) = 2000 "Largest force of the closed brake"
    annotation(Dialog(group = "Brake"));
  parameter Units.Stiffness stiffness = 100e6 "Stiffness of the closed brake"
    annotation(Dialog(group = "Brake"));
  parameter Units.Damping damping(min = 1) = 20e3 "Damping of the closed brake"
    annotation(Dialog(group = "Brake"));
  Interfaces.BooleanInput released "Coil under voltage"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Boolean open(start = false, fixed = true) "No force";
  Units.Force force "Force against the motion";
  Real travel(unit = "1", start = 0, fixed = true) "Of the armature: 0 closed, 1 open";
protected
  Units.Position deflection(start = 0, fixed = true) "How far the closed brake has yielded";
  Units.Force sticking "Force while it sticks";
equation
  der(travel) = if released and travel < 1 then 1/opening_time
    elseif not released and travel > 0 then -1/closing_time else 0;
  when travel >= 1 then
    open = true;
  elsewhen travel <= 0 then
    open = false;
  end when;
  sticking = stiffness*deflection + damping*velocity;
  force = if open then 0
    elseif sticking > holding_force then holding_force
    elseif sticking < -holding_force then -holding_force
    else sticking;
  der(deflection) = (force - stiffness*deflection)/damping;
  flange.f = force;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-50, -50}, {50, 50}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-20, 50}, {20, 80}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-20, -80}, {20, -50}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: the armature travels from 0 to 1 in the opening time while released, back in the closing
time while not. At 1 the brake opens, at 0 it closes. Closed: F = k z + d v within the holding force
F_h, slipping at F_h; d dz/dt = F - k z, which is dz/dt = v while it sticks. Open: F = 0.</p>
<p>At rest it carries up to F_h and yields by F/k without drift; a larger load slips.</p>
<p>Assumption: the force is there at once when the armature has arrived. Limits: no wear, no heat; a
release shorter than the opening time does nothing. Times and force are chosen after catalogues of
motor brakes. Source: spring and damper in series with a slider (W. D. Iwan, A distributed-element
model for hysteresis, J. Applied Mechanics 33 (1966)).</p>
</html>"));
end HoldingBrake;
