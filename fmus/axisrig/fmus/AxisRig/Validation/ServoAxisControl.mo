within AxisRig.Validation;
model ServoAxisControl "Rigid axis in velocity, force and position control, unequal limits"
  extends Icons.Experiment;
  Examples.ControlCourse course "Demand"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Drives.ServoAxis axis(
    position_start = 1e-4,
    kv = 20,
    feed_forward = 0.3,
    anti_windup_time = 6e-3,
    force_limit_motor = 550,
    stop_position = 0.009,
    weight = 60)
    "Axis under test"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Units.Position position "Slide";
  output Units.Velocity velocity "Slide";
  output Units.Position demand_position "Position demand, the motor encoder without one";
  output Units.Force force "Motor force";
  output Units.Force stop_force "Force of the stop";
equation
  connect(course.reference_position, axis.reference_position)
    annotation(Line(points = {{-18, 18}, {18, 18}}, color = {0, 0, 127}));
  connect(course.reference_velocity, axis.reference_velocity)
    annotation(Line(points = {{-18, 14}, {18, 14}}, color = {0, 0, 127}));
  connect(course.reference_time, axis.reference_time)
    annotation(Line(points = {{-18, 11}, {18, 11}}, color = {0, 0, 127}));
  connect(course.reference_end, axis.reference_end)
    annotation(Line(points = {{-18, 7}, {18, 7}}, color = {0, 0, 127}));
  axis.enabled = course.enabled;
  connect(course.force_limit, axis.force_limit)
    annotation(Line(points = {{-18, 0}, {18, 0}}, color = {0, 0, 127}));
  connect(course.force_limit_positive, axis.force_limit_positive)
    annotation(Line(points = {{-18, -4}, {18, -4}}, color = {0, 0, 127}));
  connect(course.force_limit_negative, axis.force_limit_negative)
    annotation(Line(points = {{-18, -7}, {18, -7}}, color = {0, 0, 127}));
  axis.control = course.control;
  connect(course.reference_acceleration, axis.reference_acceleration)
    annotation(Line(points = {{-18, -14}, {18, -14}}, color = {0, 0, 127}));
  connect(course.reference_force, axis.reference_force)
    annotation(Line(points = {{-18, -18}, {18, -18}}, color = {0, 0, 127}));
  position = axis.position;
  velocity = axis.velocity;
  demand_position = axis.demand_position;
  force = axis.force;
  stop_force = axis.stop_force;
  annotation(
    experiment(StopTime=0.6, Interval=0.00101),
    Documentation(info="<html>
<p>Changes between the kinds of control at speed, contact with the stop under a demanded force, limits
of each direction.</p>
</html>"));
end ServoAxisControl;
