within AxisRig.Examples;
block ControlCourse "Demand of an axis: velocity, force, velocity, position, force, power off"
  parameter Units.Acceleration ramp = 3 "Slope of the first velocity"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time ramp_end = 0.01203 "Then the velocity rests"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time push_start = 0.10003 "Then a force is demanded"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Force push = 400 "That force"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time back_start = 0.20003 "Then a velocity is demanded"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Velocity back_velocity = 0.02 "That velocity at its begin"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Acceleration back_ramp = -1 "Its slope"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time back_end = 0.26003 "Then it rests"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time place_start = 0.35003 "Then a position is demanded"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position place = 0.002 "That position at its begin"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Velocity place_velocity = 0.02 "Its slope"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time place_end = 0.45003 "Then it rests"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time pull_start = 0.50003 "Then a force is demanded"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Force pull = -280 "That force"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time off = 0.55003 "Power stage off"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Force limit_positive = 450
    "Force limit in positive direction from the push on"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Force limit_negative = 300
    "Force limit in negative direction from the way back on"
    annotation(Dialog(group = "Parameters"));
  Interfaces.PositionOutput reference_position "Demand at reference_time"
    annotation(Placement(transformation(extent = {{100, 82}, {116, 98}})));
  Interfaces.VelocityOutput reference_velocity "Slope of it, or velocity demand, at reference_time"
    annotation(Placement(transformation(extent = {{100, 64}, {116, 80}})));
  Interfaces.TimeOutput reference_time "Instant of both"
    annotation(Placement(transformation(extent = {{100, 46}, {116, 62}})));
  Interfaces.TimeOutput reference_end "Instant from which the demand rests"
    annotation(Placement(transformation(extent = {{100, 28}, {116, 44}})));
  Interfaces.BooleanOutput enabled "Power stage on"
    annotation(Placement(transformation(extent = {{100, 10}, {116, 26}})));
  Interfaces.ForceOutput force_limit "Further limit of the motor force"
    annotation(Placement(transformation(extent = {{100, -8}, {116, 8}})));
  Interfaces.ForceOutput force_limit_positive "Further limit, positive direction"
    annotation(Placement(transformation(extent = {{100, -26}, {116, -10}})));
  Interfaces.ForceOutput force_limit_negative "Further limit, negative direction"
    annotation(Placement(transformation(extent = {{100, -44}, {116, -28}})));
  Interfaces.IntegerOutput control "0: position, 1: velocity, 2: force"
    annotation(Placement(transformation(extent = {{100, -62}, {116, -46}})));
  Interfaces.AccelerationOutput reference_acceleration "Slope of the velocity demand"
    annotation(Placement(transformation(extent = {{100, -80}, {116, -64}})));
  Interfaces.ForceOutput reference_force "Force demand"
    annotation(Placement(transformation(extent = {{100, -98}, {116, -82}})));
equation
  control = if time < push_start then 1 elseif time < back_start then 2
    elseif time < place_start then 1 elseif time < pull_start then 0 else 2;
  reference_position = place;
  reference_velocity = if time < push_start then 0
    elseif time < place_start then back_velocity else place_velocity;
  reference_acceleration = if time < push_start then ramp else back_ramp;
  reference_time = if time < push_start then 0
    elseif time < place_start then back_start else place_start;
  reference_end = if time < push_start then ramp_end
    elseif time < place_start then back_end else place_end;
  reference_force = if time < place_start then push else pull;
  force_limit = 1e9;
  force_limit_positive = if time < push_start then 1e9 else limit_positive;
  force_limit_negative = if time < back_start then 1e9 else limit_negative;
  enabled = time < off;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -60}, {-20, 40}, {20, 40}, {60, -20}, {80, -20}}, color = {0, 0, 127}),
      Text(extent = {{-80, -90}, {80, -60}}, textString = "v F x"),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Every kind of control follows every other one that it can follow in a drive, at speed. The limit of
one direction differs from that of the other.</p>
</html>"));
end ControlCourse;
