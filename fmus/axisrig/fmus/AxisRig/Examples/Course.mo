within AxisRig.Examples;
block Course "Demand of an axis: forward, hold, back, hold, power off"
  parameter Units.Velocity feed = 0.04 "Forward"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time forward_end = 0.5 "Then the demand rests"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time back_start = 0.8 "Then it moves back"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Position back_position = 0.015 "Where the way back begins"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Velocity back_feed = -0.03 "Back"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time back_end = 1.2 "Then the demand rests"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time off = 1.8 "Power stage off"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Force back_limit = 450 "Force limit from the way back on"
    annotation(Dialog(group = "Parameters"));
  Interfaces.PositionOutput reference_position "Demand at reference_time"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.VelocityOutput reference_velocity "Slope of the demand until reference_end"
    annotation(Placement(transformation(extent = {{100, 44}, {120, 64}})));
  Interfaces.TimeOutput reference_time "Instant of reference_position"
    annotation(Placement(transformation(extent = {{100, 8}, {120, 28}})));
  Interfaces.TimeOutput reference_end "Instant from which the demand rests"
    annotation(Placement(transformation(extent = {{100, -28}, {120, -8}})));
  Interfaces.BooleanOutput enabled "Power stage on"
    annotation(Placement(transformation(extent = {{100, -64}, {120, -44}})));
  Interfaces.ForceOutput force_limit "Further limit of the motor force"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
equation
  reference_position = if time < back_start then 0 else back_position;
  reference_velocity = if time < back_start then feed else back_feed;
  reference_time = if time < back_start then 0 else back_start;
  reference_end = if time < back_start then forward_end else back_end;
  force_limit = if time < back_start then 1e9 else back_limit;
  enabled = time < off;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -60}, {-20, 40}, {20, 40}, {60, -20}, {80, -20}}, color = {0, 0, 127}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>With a fixed stop in the way the course holds an axis at its force limit, frees it, lets it rest
and takes its power.</p>
</html>"));
end Course;
