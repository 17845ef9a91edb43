within AxisRig.Validation;
model DigitalInput "Edges known by their instants reach a terminal"
  extends Icons.Experiment;
  Sensors.DigitalInput digital_input(
    rise_delay = 3e-6,
    fall_delay = 70e-6,
    filter_time = 200e-6,
    jitter = 0.4e-6,
    seed = 3,
    clock_error = 0.9e-6,
    clock_seconds = 846000003,
    clock_nanoseconds = 999000000)
    "Terminal"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Boolean level "Level after delay and filter";
  output Integer rising_nanoseconds "Stamp";
  output Integer falling_nanoseconds "Stamp";
  output Integer falling_seconds "Stamp";
  output Integer falling_count "Stamped edges";
  output Real falling_low_word(unit = "1") "Stamp, low 32 bits";
equation
  digital_input.signal = time >= 0.01 and time < 0.02 or time >= 0.03 and time < 0.0301;
  digital_input.rising_time = if time < 0.025 then 0.01004 else 0.03004;
  digital_input.falling_time = if time < 0.025 then 0.02005 else 0.03014;
  digital_input.rising_count = if time < 0.025 then 1 else 2;
  digital_input.falling_count = if time < 0.025 then 1 else 2;
  digital_input.rearm = false;
  level = digital_input.level;
  rising_nanoseconds = digital_input.stamped_rising_nanoseconds;
  falling_nanoseconds = digital_input.stamped_falling_nanoseconds;
  falling_seconds = digital_input.stamped_falling_seconds;
  falling_count = digital_input.stamped_falling_count;
  falling_low_word = digital_input.stamped_falling_low_word;
  annotation(
    experiment(StopTime=0.04, Interval=1.01e-4),
    Documentation(info="<html>
<p>A pulse of 10 ms passes with a stamp for each edge, one of 0.1 ms does not pass the filter. Compared:
level and stamps.</p>
</html>"));
end DigitalInput;
