within AxisRig.Examples;
block ControlCourse "Demand of an axis: velocity, force, velocity, position, force, power off"
  parameter Units.Acceleration ramp = 3 "Slope of the first velocity";
  parameter Units.Time ramp_end = 0.01203 "Then the velocity rests";
  parameter Units.Time push_start = 0.10003 "Then a force is demanded";
  parameter Units.Force push = 400 "That force";
  parameter Units.Time back_start = 0.20003 "Then a velocity is demanded";
  parameter Units.Velocity back_velocity = 0.02 "That velocity at its begin";
  parameter Units.Acceleration back_ramp = -1 "Its slope";
  parameter Units.Time back_end = 0.26003 "Then it rests";
  parameter Units.Time place_start = 0.35003 "Then a position is demanded";
  parameter Units.Position place = 0.002 "That position at its begin";
  parameter Units.Velocity place_velocity = 0.02 "Its slope";
  parameter Units.Time place_end = 0.45003 "Then it rests";
  parameter Units.Time pull_start = 0.50003 "Then a force is demanded";
  parameter Units.Force pull = -280 "That force";
  parameter Units.Time off = 0.55003 "Power stage off";
  parameter Units.Force limit_positive = 450
    "Force limit in positive direction from the push on";
  parameter Units.Force limit_negative = 300
    "Force limit in negative direction from the way back on";
  output Units.Position reference_position "Demand at reference_time";
  output Units.Velocity reference_velocity "Slope of it, or velocity demand, at reference_time";
  output Units.Time reference_time "Instant of both";
  output Units.Time reference_end "Instant from which the demand rests";
  output Boolean enabled "Power stage on";
  output Units.Force force_limit "Further limit of the motor force";
  output Units.Force force_limit_positive "Further limit, positive direction";
  output Units.Force force_limit_negative "Further limit, negative direction";
  output Integer control "0: position, 1: velocity, 2: force";
  output Units.Acceleration reference_acceleration "Slope of the velocity demand";
  output Units.Force reference_force "Force demand";
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
    Documentation(info="<html>
<p>Every kind of control follows every other one that it can follow in a drive, at speed. The limit of
one direction differs from that of the other.</p>
</html>"));
end ControlCourse;
