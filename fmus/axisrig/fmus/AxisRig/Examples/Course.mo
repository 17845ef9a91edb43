within AxisRig.Examples;
block Course "Demand of an axis: forward, hold, back, hold, power off"
  parameter Units.Velocity feed = 0.04 "Forward";
  parameter Units.Time forward_end = 0.5 "Then the demand rests";
  parameter Units.Time back_start = 0.8 "Then it moves back";
  parameter Units.Position back_position = 0.015 "Where the way back begins";
  parameter Units.Velocity back_feed = -0.03 "Back";
  parameter Units.Time back_end = 1.2 "Then the demand rests";
  parameter Units.Time off = 1.8 "Power stage off";
  parameter Units.Force back_limit = 450 "Force limit from the way back on";
  output Units.Position reference_position "Demand at reference_time";
  output Units.Velocity reference_velocity "Slope of the demand until reference_end";
  output Units.Time reference_time "Instant of reference_position";
  output Units.Time reference_end "Instant from which the demand rests";
  output Boolean enabled "Power stage on";
  output Units.Force force_limit "Further limit of the motor force";
equation
  reference_position = if time < back_start then 0 else back_position;
  reference_velocity = if time < back_start then feed else back_feed;
  reference_time = if time < back_start then 0 else back_start;
  reference_end = if time < back_start then forward_end else back_end;
  force_limit = if time < back_start then 1e9 else back_limit;
  enabled = time < off;
  annotation(
    Documentation(info="<html>
<p>With a fixed stop in the way the course holds an axis at its force limit, frees it, lets it rest
and takes its power.</p>
</html>"));
end Course;
