within AxisRig.Drives;
model GravityAxis "Vertical axis: weight, counterbalance and a holding brake on the motor"
  extends PartialAxis;
  input Boolean brake_released(start = false) "Coil of the brake, beside the drive's own command";
  parameter Boolean brake_by_drive = true "The power stage releases the brake";
  parameter Units.Force counterbalance = 877 "Upward force of the counterbalance";
  parameter Units.Time brake_opening_time(min = 1e-5) = 60e-3 "From release to no force";
  parameter Units.Time brake_closing_time(min = 1e-5) = 20e-3 "From the end of release to force";
  parameter Units.Force brake_force(min = 1e-3) = 2000 "Holding force, in terms of the slide";
  parameter Units.Stiffness brake_stiffness = 100e6 "Of the closed brake, at the slide";
  final parameter Units.Force weight = mass*gravity - counterbalance "What the motor must carry";
  output Boolean brake_open "The brake has no force";
protected
  constant Units.Acceleration gravity = 9.80665 "Standard acceleration of free fall";
  Mechanics.Slide slide(mass = effective_mass, weight = weight, position_start = position_start);
  Mechanics.LuGreFriction friction;
  Mechanics.HoldingBrake brake(
    opening_time = brake_opening_time,
    closing_time = brake_closing_time,
    holding_force = brake_force,
    stiffness = brake_stiffness);
equation
  brake.released = brake_released or (brake_by_drive and enabled);
  connect(drive.flange, slide.flange);
  connect(friction.flange, slide.flange);
  connect(brake.flange, slide.flange);
  connect(stop.flange, slide.flange);
  position = slide.position;
  velocity = slide.velocity;
  brake_open = brake.open;
  annotation(
    Documentation(info="<html>
<p>Equation: m_eff dv/dt = F_motor - F_friction - F_brake - F_stop - (m g - F_c). Up is
positive.</p>
<p>The brake closes without voltage. After the power stage has gone off the axis falls for the
closing time: 1/2 a t^2 with a = (m g - F_c - F_friction)/m_eff. Default: 300 N of 1177 N are not
balanced.</p>
<p>Assumptions: rigid between motor and slide; constant force of the counterbalance. Limits: those
of HoldingBrake. Source: the parts.</p>
</html>"));
end GravityAxis;
