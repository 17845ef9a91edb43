within AxisRig.Examples;
model Gantry "A gantry with its centre of mass off the middle goes and comes to rest"
  extends Icons.Experiment;
  parameter Units.Velocity feed = 0.05 "Of both sides"
    annotation(Dialog(group = "Parameters"));
  Drives.GantryPair gantry(
    kv = 20,
    feed_forward = 0.3,
    anti_windup_time = 9e-3,
    mass_offset = 0.2)
    "Two drives, one beam"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  Units.Position position_1 "First end of the beam";
  Units.Position position_2 "Second end of the beam";
  Units.Position skew "First end minus second end";
  Units.Force force_1 "First motor";
  Units.Force force_2 "Second motor";
equation
  gantry.reference_position_1 = 0;
  gantry.reference_velocity_1 = feed;
  gantry.reference_time_1 = 0;
  gantry.reference_end_1 = 0.4;
  gantry.enabled_1 = true;
  gantry.force_limit_1 = 1e9;
  gantry.force_limit_positive_1 = 1e9;
  gantry.force_limit_negative_1 = 1e9;
  gantry.control_1 = 0;
  gantry.reference_acceleration_1 = 0;
  gantry.reference_force_1 = 0;
  gantry.reference_position_2 = 0;
  gantry.reference_velocity_2 = feed;
  gantry.reference_time_2 = 0;
  gantry.reference_end_2 = 0.4;
  gantry.enabled_2 = true;
  gantry.force_limit_2 = 1e9;
  gantry.force_limit_positive_2 = 1e9;
  gantry.force_limit_negative_2 = 1e9;
  gantry.control_2 = 0;
  gantry.reference_acceleration_2 = 0;
  gantry.reference_force_2 = 0;
  position_1 = gantry.position_1;
  position_2 = gantry.position_2;
  skew = gantry.skew;
  force_1 = gantry.force_1;
  force_2 = gantry.force_2;
  annotation(
    experiment(StopTime = 0.8, Interval = 4e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>The centre of mass is 0.2 m towards the first side. With equal demands the beam is askew only while the speed
changes. Reference: <code>Resources/ReferenceResults/Gantry.csv</code>, integrated from the equations.</p>
</html>"));
end Gantry;
