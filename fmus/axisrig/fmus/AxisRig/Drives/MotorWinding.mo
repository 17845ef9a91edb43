within AxisRig.Drives;
model MotorWinding "Motor winding with current controller and voltage limit"
  parameter Units.Frequency bandwidth = 800 "Bandwidth of the current loop"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.TorqueConstant torque_constant(min = 1e-6) = 0.49 "Torque per current"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Resistance resistance(min = 1e-6) = 3.07 "Between two phases"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Inductance inductance(min = 1e-6) = 6.57e-3 "Between two phases"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Voltage voltage_limit(min = 0) = 300 "What the inverter can give"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Length screw_lead(min = 1e-4) = 0.01 "Travel per revolution"
    annotation(Dialog(group = "Masses and transmission"));
  Interfaces.ForceInput force_reference "Demand"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.Flange flange "Slide side"
    annotation(Placement(transformation(extent = {{-10, -110}, {10, -90}})));
  Units.Force force "Force on the slide";
  Units.Current current(start = 0, fixed = true) "Current of the winding";
  Units.Voltage voltage "Voltage at the winding";
protected
  constant Units.Angle turn = 2*Constants.pi "One revolution";
  Units.Current error "Current error";
  Units.Voltage asked "Voltage that the controller asks for";
  Units.Voltage integral(start = 0, fixed = true) "Integral part";
  Units.AngularVelocity speed "Speed of the motor";
equation
  speed = turn/screw_lead*der(flange.s);
  error = screw_lead/(turn*torque_constant)*force_reference - current;
  asked = 2*Constants.pi*bandwidth*inductance*error + integral;
  voltage = if asked > voltage_limit then voltage_limit
    elseif asked < -voltage_limit then -voltage_limit else asked;
  der(integral) = 2*Constants.pi*bandwidth*resistance*error
    + resistance/inductance*(voltage - asked);
  inductance*der(current) = voltage - resistance*current - torque_constant*speed;
  force = turn/screw_lead*torque_constant*current;
  flange.f = -force;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-60, -15}, {-30, 15}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-30, -15}, {0, 15}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{0, -15}, {30, 15}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{30, -15}, {60, 15}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, 0}, {-60, 0}}, color = {0, 0, 0}),
      Line(points = {{60, 0}, {80, 0}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: L di/dt = u - R i - K_t w, F = (2 pi/h) K_t i; controller u = sat(K e + I),
dI/dt = K/T e + (sat(u) - u) R/L with K = 2 pi f_c L, K/T = 2 pi f_c R.</p>
<p>With these gains the closed loop is the lag 1/(1 + s/(2 pi f_c)) at standstill; motion disturbs
it by the induced voltage. Back-calculation keeps the integral part at the voltage limit.</p>
<p>Assumptions: one equivalent winding, so that K_t in N.m/A is the voltage constant in V.s/rad too;
continuous controller. Limits: no saturation of iron, no cogging, no temperature. Numbers: a 2.2 Nm
servo motor. Source: H. Gross et al., Electrical Feed Drives in Automation, chapter on current
control.</p>
</html>"));
end MotorWinding;
