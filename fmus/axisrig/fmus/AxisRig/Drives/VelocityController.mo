within AxisRig.Drives;
block VelocityController "PI velocity loop with force limit and anti-windup"
  parameter Units.Damping gain = 1e4 "Force per velocity error"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time integral_time(min = 1e-5) = 8e-3 "Integral time"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time anti_windup_time(min = 1e-5) = 8e-3 "How fast the integral part is led back"
    annotation(Dialog(group = "Velocity loop"));
  Interfaces.VelocityInput velocity_reference "Demand"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.VelocityInput velocity "Velocity of the motor encoder"
    annotation(Placement(transformation(extent = {{-120, 50}, {-100, 70}})));
  Interfaces.ForceInput limit_positive "Largest force in positive direction"
    annotation(Placement(transformation(extent = {{-120, 20}, {-100, 40}})));
  Interfaces.ForceInput limit_negative "Largest force in negative direction, as an amount"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.BooleanInput enabled "False: no force and an empty integral part"
    annotation(Placement(transformation(extent = {{-120, -40}, {-100, -20}})));
  Interfaces.BooleanInput force_control "The demand is a force: the loop is open"
    annotation(Placement(transformation(extent = {{-120, -70}, {-100, -50}})));
  Interfaces.ForceInput force_demand "Demand then"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.ForceOutput force_reference "Demand for the current loop"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
  Units.Force integral(start = 0, fixed = true) "Integral part";
  Units.Velocity error "Velocity error";
  Units.Force unlimited "Force that the controller asks for";
protected
  constant Units.Time discharge = 1e-3
    "Time constant of emptying the integral part, or of following a demanded force";
  Units.Force limited "Force within the limit";
equation
  error = velocity_reference - velocity;
  unlimited = if force_control then force_demand else gain*error + integral;
  limited = if unlimited > limit_positive then limit_positive
    elseif unlimited < -limit_negative then -limit_negative else unlimited;
  force_reference = if enabled then limited else 0;
  der(integral) = if not enabled then -integral/discharge
    elseif force_control then (limited - integral)/discharge
    else gain*error/integral_time + (limited - unlimited)/anti_windup_time;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-80, -40}, {80, 40}}, textString = "PI"),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: u = K e + I, F = sat(u), dI/dt = K e/T_n + (F - u)/T_a.</p>
<p>Anti-windup by back-calculation: at the limit the integral part moves to where the demand just
leaves the limit when e changes its sign (for T_a = T_n). The right-hand side stays continuous, so
that no sliding motion along the limit can arise. A larger T_a gives a later release.</p>
<p>While a force is demanded it passes within the limits and the integral part follows it with 1 ms,
so that a velocity loop that closes without an error begins with that force.</p>
<p>Assumption: continuous controller. Limit: not enabled means an integral part that decays
with 1 ms. Source: K. J. Astrom, T. Hagglund, Advanced PID Control, section 3.5.</p>
</html>"));
end VelocityController;
