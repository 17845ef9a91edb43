within AxisRig.Drives;
model GravityAxis "Vertical axis: weight, counterbalance and a holding brake on the motor"
  extends PartialAxis;
  Interfaces.BooleanInput brake_released(start = false)
    "Coil of the brake, beside the drive's own command"
    annotation(Placement(transformation(origin = {0, 110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
  parameter Boolean brake_by_drive = true "The power stage releases the brake"
    annotation(Dialog(group = "Brake"));
  parameter Units.Force counterbalance = 877 "Upward force of the counterbalance"
    annotation(Dialog(group = "Masses and transmission"));
  parameter Units.Time brake_opening_time(min = 1e-5) = 60e-3 "From release to no force"
    annotation(Dialog(group = "Brake"));
  parameter Units.Time brake_closing_time(min = 1e-5) = 20e-3 "From the end of release to force"
    annotation(Dialog(group = "Brake"));
  parameter Units.Force brake_force(min = 1e-3) = 2000 "Holding force, in terms of the slide"
    annotation(Dialog(group = "Brake"));
  parameter Units.Stiffness brake_stiffness = 100e6 "Of the closed brake, at the slide"
    annotation(Dialog(group = "Brake"));
  final parameter Units.Force weight = mass*Constants.standard_gravity - counterbalance
    "What the motor must carry";
  Interfaces.BooleanOutput brake_open "The brake has no force"
    annotation(Placement(transformation(origin = {60, -110},
      extent = {{-10, -10}, {10, 10}}, rotation = -90)));
protected
  Mechanics.Slide slide(mass = effective_mass, weight = weight, position_start = position_start)
    "Moving mass"
    annotation(Placement(transformation(extent = {{-72, -59}, {-34, -21}})));
  Mechanics.LuGreFriction friction "Friction of the guideway"
    annotation(Placement(transformation(extent = {{-19, -59}, {19, -21}})));
  Mechanics.HoldingBrake brake(
    opening_time = brake_opening_time,
    closing_time = brake_closing_time,
    holding_force = brake_force,
    stiffness = brake_stiffness)
    "Holding brake"
    annotation(Placement(transformation(extent = {{34, -59}, {72, -21}})));
equation
  brake.released = brake_released or (brake_by_drive and enabled);
  connect(drive.flange, slide.flange)
    annotation(Line(points = {{-40, 25}, {-46, 25}, {-46, -59}, {-53, -59}}, color = {0, 127, 0}));
  connect(friction.flange, slide.flange)
    annotation(Line(points = {{0, -59}, {-53, -59}}, color = {0, 127, 0}));
  connect(brake.flange, slide.flange)
    annotation(Line(points = {{53, -59}, {-53, -59}}, color = {0, 127, 0}));
  connect(stop.flange, slide.flange)
    annotation(Line(points = {{40, 25}, {-6, 25}, {-6, -59}, {-53, -59}}, color = {0, 127, 0}));
  position = slide.position;
  velocity = slide.velocity;
  brake_open = brake.open;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-10, -70}, {10, 70}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-50, -20}, {10, 30}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{60, 40}, {60, -30}}, color = {0, 0, 0}),
      Polygon(points = {{50, -30}, {70, -30}, {60, -55}}, fillColor = {0, 127, 0},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
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
