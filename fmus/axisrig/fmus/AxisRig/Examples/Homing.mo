within AxisRig.Examples;
model Homing "An axis looks for its home switch, and takes the edge on its way back"
  extends Icons.Experiment;
  parameter Units.Velocity search = -0.03 "Towards the switch"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Velocity creep = 0.01 "Away from it"
    annotation(Dialog(group = "Parameters"));
  Drives.ServoAxis axis(
    position_start = 0.01,
    coulomb_friction = 0,
    breakaway_friction = 0)
    "Axis in velocity control"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Sensors.PositionSwitch home_switch(low = -1, high = 0, hysteresis = 50e-6)
    "Closed below 0"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  Integer phase(start = 0, fixed = true) "0: searches, 1: goes back, 2: has found it";
  Units.Position home(start = 0, fixed = true) "Axis at the edge that counts";
  Units.Position position "Axis";
  Units.Time closing_time "Switch closes";
  Units.Time opening_time "Switch opens: home";
equation
  when home_switch.signal then
    phase = 1;
    home = pre(home);
  elsewhen not home_switch.signal then
    phase = 2;
    home = axis.motor_position;
  end when;
  axis.reference_position = 0;
  axis.reference_velocity = if phase == 0 then search elseif phase == 1 then creep else 0;
  axis.reference_time = 0;
  axis.reference_end = 1e3;
  axis.enabled = true;
  axis.force_limit = 1e9;
  axis.force_limit_positive = 1e9;
  axis.force_limit_negative = 1e9;
  axis.control = 1;
  axis.reference_acceleration = 0;
  axis.reference_force = 0;
  home_switch.step_time = 0;
  home_switch.step_size = 1;
  home_switch.x_start = axis.position;
  home_switch.x_rate_start = 0;
  home_switch.x_end = axis.position;
  home_switch.x_rate_end = 0;
  position = axis.position;
  closing_time = home_switch.rising_time;
  opening_time = home_switch.falling_time;
  annotation(
    experiment(StopTime = 0.6, Interval = 2e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Down with 30 mm/s until the switch closes at 0, up with 10 mm/s until it opens at 50 um: that edge is home.
Reference: <code>Resources/ReferenceResults/Homing.csv</code>, integrated from the equations.</p>
</html>"));
end Homing;
