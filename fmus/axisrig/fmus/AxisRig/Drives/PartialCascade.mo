within AxisRig.Drives;
partial model PartialCascade "Setpoint and position loop of a drive; it moves a motor at its flange"
  parameter Units.Rate kv = 10 "Gain of the position loop"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Share feed_forward = 0 "Share of velocity feed-forward"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Damping velocity_gain = 7.2e4 "Proportional gain of the velocity loop"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time velocity_integral_time(min = 1e-5) = 8e-3
    "Integral time of the velocity loop"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Time anti_windup_time(min = 1e-5) = 8e-3
    "Back-calculation time of the velocity loop"
    annotation(Dialog(group = "Velocity loop"));
  parameter Units.Frequency current_bandwidth(min = 1) = 800 "Bandwidth of the current loop"
    annotation(Dialog(group = "Motor and current loop"));
  parameter Units.Force force_limit_motor(min = 0) = 4000
    "Largest motor force, in terms of the slide"
    annotation(Dialog(group = "Motor and current loop"));
  Interfaces.PositionInput reference_position "Demand at reference_time"
    annotation(Placement(transformation(extent = {{-116, 82}, {-100, 98}})));
  Interfaces.VelocityInput reference_velocity "Slope of the demand until reference_end"
    annotation(Placement(transformation(extent = {{-116, 64}, {-100, 80}})));
  Interfaces.TimeInput reference_time "Instant of reference_position"
    annotation(Placement(transformation(extent = {{-116, 46}, {-100, 62}})));
  Interfaces.TimeInput reference_end "Instant from which the demand rests"
    annotation(Placement(transformation(extent = {{-116, 28}, {-100, 44}})));
  Interfaces.BooleanInput enabled "Power stage on"
    annotation(Placement(transformation(extent = {{-116, 10}, {-100, 26}})));
  Interfaces.ForceInput force_limit "Further limit of the motor force in both directions"
    annotation(Placement(transformation(extent = {{-116, -8}, {-100, 8}})));
  Interfaces.ForceInput force_limit_positive
    "Further limit of the motor force in positive direction"
    annotation(Placement(transformation(extent = {{-116, -26}, {-100, -10}})));
  Interfaces.ForceInput force_limit_negative "The same in negative direction, as an amount"
    annotation(Placement(transformation(extent = {{-116, -44}, {-100, -28}})));
  Interfaces.IntegerInput control "What is controlled; 0: position, 1: velocity, 2: force"
    annotation(Placement(transformation(extent = {{-116, -62}, {-100, -46}})));
  Interfaces.AccelerationInput reference_acceleration "Velocity control: slope of the demand"
    annotation(Placement(transformation(extent = {{-116, -80}, {-100, -64}})));
  Interfaces.ForceInput reference_force "Force control: demand"
    annotation(Placement(transformation(extent = {{-116, -98}, {-100, -82}})));
  Interfaces.Flange flange "Motor with its encoder, in terms of the slide"
    annotation(Placement(transformation(extent = {{-10, -110}, {10, -90}})));
  Units.Velocity motor_velocity "Velocity of the motor encoder";
  Units.Position demand_position "Position demand";
  Units.Force force "Motor force on the slide";
  Units.Velocity velocity_reference "Demand for the velocity loop";
  Units.Force limit_positive "Limit of the motor force now, positive direction";
  Units.Force limit_negative "Limit of the motor force now, negative direction";
  Boolean force_control "A force is demanded";
protected
  Boolean velocity_control "A velocity is demanded";
  Units.Force limit "Limit of the motor force now, both directions";
  Setpoint setpoint "Demand between two instants"
    annotation(Placement(transformation(extent = {{-60, 25}, {-20, 65}})));
  PositionController position_controller(kv = kv, feed_forward = feed_forward) "Position loop"
    annotation(Placement(transformation(extent = {{20, 25}, {60, 65}})));
equation
  connect(reference_position, setpoint.reference_position)
    annotation(Line(points = {{-100, 90}, {-81, 90}, {-81, 63}, {-62, 63}}, color = {0, 0, 127}));
  connect(reference_velocity, setpoint.reference_velocity)
    annotation(Line(points = {{-100, 72}, {-81, 72}, {-81, 56}, {-62, 56}}, color = {0, 0, 127}));
  connect(reference_time, setpoint.reference_time)
    annotation(Line(points = {{-100, 54}, {-81, 54}, {-81, 49}, {-62, 49}}, color = {0, 0, 127}));
  connect(reference_end, setpoint.reference_end)
    annotation(Line(points = {{-100, 36}, {-81, 36}, {-81, 41}, {-62, 41}}, color = {0, 0, 127}));
  connect(reference_acceleration, setpoint.reference_acceleration)
    annotation(Line(points = {{-100, -72}, {-81, -72}, {-81, 34}, {-62, 34}}, color = {0, 0, 127}));
  setpoint.velocity_control = velocity_control;
  connect(setpoint.position, position_controller.demand_position)
    annotation(Line(points = {{-18, 63}, {18, 63}}, color = {0, 0, 127}));
  connect(setpoint.velocity, position_controller.demand_velocity)
    annotation(Line(points = {{-18, 27}, {0, 27}, {0, 45}, {18, 45}}, color = {0, 0, 127}));
  position_controller.position = flange.s;
  velocity_control = control == 1;
  force_control = control == 2;
  velocity_reference = if velocity_control then setpoint.velocity
    else position_controller.velocity_reference;
  motor_velocity = der(flange.s);
  demand_position = if velocity_control or force_control then flange.s else setpoint.position;
  limit = if force_limit < force_limit_motor then force_limit else force_limit_motor;
  limit_positive = if force_limit_positive < limit then force_limit_positive else limit;
  limit_negative = if force_limit_negative < limit then force_limit_negative else limit;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, 0}, {-50, 0}}, color = {0, 0, 0}),
      Rectangle(extent = {{-50, -25}, {-10, 25}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-10, 0}, {20, 0}}, color = {0, 0, 0}),
      Ellipse(extent = {{20, -25}, {70, 25}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: v_ref = Kv (x_d - x) + f v_d with the position x of the motor encoder; in velocity
control v_ref = v_r + a_r (min(t, t_end) - t_r). The smallest of the three force limits of a direction
counts, whatever is controlled. Without a position demand demand_position is the position. A model
that extends this one adds velocity loop, current loop and motor.</p>
<p>Assumption: everything in terms of the slide. Limit: the sampling of the position loop is left
out. Source: H. Gross, J. Hamann, G. Wiegaertner, Electrical Feed Drives in Automation.</p>
</html>"));
end PartialCascade;
