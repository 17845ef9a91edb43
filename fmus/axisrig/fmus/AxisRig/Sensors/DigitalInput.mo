within AxisRig.Sensors;
model DigitalInput "Terminal that stamps the edges of a probe with a distributed clock"
  input Boolean signal "Level at the end of the communication step";
  input Units.Time rising_time "Last rising edge of it";
  input Units.Time falling_time "Last falling edge of it";
  input Integer rising_count "Rising edges since the start";
  input Integer falling_count "Falling edges since the start";
  input Boolean rearm(start = false) "A rising edge makes room for the next first edge";
  parameter Units.Time rise_delay(min = 0) = 0 "Of the input circuit at rising edges";
  parameter Units.Time fall_delay(min = 0) = 0 "Of the input circuit at falling edges";
  parameter Units.Time filter_time(min = 0) = 0 "For how long a level must rest to count";
  parameter Units.Time jitter(min = 0) = 0 "Largest deviation of a stamp to either side";
  parameter Integer seed(min = 0, max = 1000000) = 1 "Of the deviations";
  parameter Units.Time clock_error = 0 "Clock of the terminal minus reference clock";
  parameter Integer clock_seconds(min = 0) = 0 "Reference clock at time 0: seconds since 2000";
  parameter Integer clock_nanoseconds(min = 0, max = 999999999) = 0
    "Reference clock at time 0: nanoseconds above";
  parameter Boolean keep_first = false "Stamps hold the first edge until rearm, else the last one";
  output Boolean level "Level behind delay and filter";
  output Integer stamped_rising_count "Rising edges stamped since the start";
  output Integer stamped_rising_seconds "Stamp of a rising edge: whole seconds since 2000-01-01";
  output Integer stamped_rising_nanoseconds "Stamp of a rising edge: nanoseconds above";
  output Real stamped_rising_low_word(unit = "1") "Stamp in nanoseconds, its low 32 bits";
  output Integer stamped_falling_count "Falling edges stamped since the start";
  output Integer stamped_falling_seconds "Stamp of a falling edge: whole seconds since 2000-01-01";
  output Integer stamped_falling_nanoseconds "Stamp of a falling edge: nanoseconds above";
  output Real stamped_falling_low_word(unit = "1") "Stamp in nanoseconds, its low 32 bits";
protected
  Boolean rose "The last rising edge lies behind";
  Boolean fell "The last falling edge lies behind";
  Boolean level_in "Level at the terminal now";
  Boolean level_start(start = false, fixed = true) "Level when the simulation began";
  EdgeQueue rising_path(transit = rise_delay);
  EdgeQueue falling_path(transit = fall_delay);
  LevelFilter filter(rest_time = filter_time);
  EdgeStamp rising(
    multiplier = 16807,
    spread = jitter,
    random_seed = seed,
    error = clock_error,
    epoch_seconds = clock_seconds,
    epoch_nanoseconds = clock_nanoseconds,
    hold_first = keep_first);
  EdgeStamp falling(
    multiplier = 48271,
    spread = jitter,
    random_seed = seed,
    error = clock_error,
    epoch_seconds = clock_seconds,
    epoch_nanoseconds = clock_nanoseconds,
    hold_first = keep_first);
equation
  rose = rising_count > 0 and time >= rising_time;
  fell = falling_count > 0 and time >= falling_time;
  level_in = if rose and fell then rising_time > falling_time
    elseif rose then true
    elseif fell then false
    elseif rising_count > 0 and falling_count > 0 then falling_time < rising_time
    elseif rising_count > 0 then false
    elseif falling_count > 0 then true
    else signal;
  when initial() then
    level_start = signal;
  end when;
  rising_path.u = level_in;
  falling_path.u = not level_in;
  filter.u = if level_start then rising_path.arrived >= falling_path.arrived
    else rising_path.arrived > falling_path.arrived;
  level = filter.y;
  rising.u = level;
  rising.rearm = rearm;
  falling.u = not level;
  falling.rearm = rearm;
  stamped_rising_count = rising.count;
  stamped_rising_seconds = rising.seconds;
  stamped_rising_nanoseconds = rising.nanoseconds;
  stamped_rising_low_word = rising.low_word;
  stamped_falling_count = falling.count;
  stamped_falling_seconds = falling.seconds;
  stamped_falling_nanoseconds = falling.nanoseconds;
  stamped_falling_low_word = falling.low_word;
  annotation(
    Documentation(info="<html>
<p>The inputs are the outputs of a probe for the same communication step. From them the level at each
instant follows exactly: after the later of the last two edges that lie behind; before both it is the
level that the earlier one ended. So the stamps do not depend on the length of the step.</p>
<p>Equation: stamp = edge + delay + filter time on the clock. Chain: delay of the input circuit, different for the two directions (EdgeQueue); filter
(LevelFilter); stamp of the filtered edge (EdgeStamp).</p>
<p>Assumptions: the inputs of a step are set before the step. Limits: one rising and one falling edge
in a communication step reach the terminal, of more the last ones; at most four edges of one direction
within the delay. Source: as for the parts.</p>
</html>"));
end DigitalInput;
