within AxisRig.Validation;
model ContactBounce "A contact closes and opens, once while it still bounces"
  extends Icons.Experiment;
  Sensors.ContactBounce contact(closing_count = 3, opening_count = 2, duration = 1.3e-3)
    "Contact that bounces"
    annotation(Placement(transformation(extent = {{-60, 20}, {-20, 60}})));
  Sensors.EdgeCounter rising "Counts rising edges"
    annotation(Placement(transformation(extent = {{20, 20}, {60, 60}})));
  Sensors.EdgeCounter falling "Counts falling edges"
    annotation(Placement(transformation(extent = {{-60, -60}, {-20, -20}})));
  output Units.Time rising_time "Last rising edge";
  output Units.Time falling_time "Last falling edge";
  output Integer rising_count "Rising edges";
  output Boolean bouncing "Between first and last edge";
equation
  contact.u = time > 0.01003 and time < 0.02003 or time > 0.03003 and time < 0.03074;
  rising.u = contact.y;
  falling.u = not contact.y;
  rising_time = rising.last;
  falling_time = falling.last;
  rising_count = rising.count;
  bouncing = contact.bouncing;
  annotation(
    experiment(StopTime=0.04, Interval=1e-4),
    Documentation(info="<html>
<p>Three openings after closing, two closings after opening. Compared: instants and number of the
edges, and whether the contact bounces.</p>
</html>"));
end ContactBounce;
