within AxisRig.Sensors;
model DigitalInput "Terminal that stamps the edges of a probe with a distributed clock"
  Interfaces.BooleanInput signal "Level at the end of the communication step"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.TimeInput rising_time "Last rising edge of it"
    annotation(Placement(transformation(extent = {{-120, 44}, {-100, 64}})));
  Interfaces.TimeInput falling_time "Last falling edge of it"
    annotation(Placement(transformation(extent = {{-120, 8}, {-100, 28}})));
  Interfaces.IntegerInput rising_count "Rising edges since the start"
    annotation(Placement(transformation(extent = {{-120, -28}, {-100, -8}})));
  Interfaces.IntegerInput falling_count "Falling edges since the start"
    annotation(Placement(transformation(extent = {{-120, -64}, {-100, -44}})));
  Interfaces.BooleanInput rearm(start = false) "A rising edge makes room for the next first edge"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  parameter Units.Time rise_delay(min = 0) = 0 "Of the input circuit at rising edges"
    annotation(Dialog(group = "Signal"));
  parameter Units.Time fall_delay(min = 0) = 0 "Of the input circuit at falling edges"
    annotation(Dialog(group = "Signal"));
  parameter Units.Time filter_time(min = 0) = 0 "For how long a level must rest to count"
    annotation(Dialog(group = "Signal"));
  parameter Units.Time jitter(min = 0) = 0 "Largest deviation of a stamp to either side"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Integer seed(min = 0, max = 1000000) = 1 "Of the deviations"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Time clock_error = 0 "Clock of the terminal minus reference clock"
    annotation(Dialog(group = "Clock"));
  parameter Integer clock_seconds(min = 0) = 0 "Reference clock at time 0: seconds since 2000"
    annotation(Dialog(group = "Clock"));
  parameter Integer clock_nanoseconds(min = 0, max = 999999999) = 0
    "Reference clock at time 0: nanoseconds above"
    annotation(Dialog(group = "Clock"));
  parameter Boolean keep_first = false "Stamps hold the first edge until rearm, else the last one"
    annotation(Dialog(group = "Signal"));
  Interfaces.BooleanOutput level "Level after delay and filter"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.IntegerOutput stamped_rising_count "Rising edges stamped since the start"
    annotation(Placement(transformation(extent = {{100, 58}, {120, 78}})));
  Interfaces.IntegerOutput stamped_rising_seconds
    "Stamp of a rising edge: whole seconds since 2000-01-01"
    annotation(Placement(transformation(extent = {{100, 35}, {120, 55}})));
  Interfaces.IntegerOutput stamped_rising_nanoseconds "Stamp of a rising edge: nanoseconds above"
    annotation(Placement(transformation(extent = {{100, 12}, {120, 32}})));
  Interfaces.RealOutput stamped_rising_low_word(unit = "1") "Stamp in nanoseconds, its low 32 bits"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
  Interfaces.IntegerOutput stamped_falling_count "Falling edges stamped since the start"
    annotation(Placement(transformation(extent = {{100, -32}, {120, -12}})));
  Interfaces.IntegerOutput stamped_falling_seconds
    "Stamp of a falling edge: whole seconds since 2000-01-01"
    annotation(Placement(transformation(extent = {{100, -55}, {120, -35}})));
  Interfaces.IntegerOutput stamped_falling_nanoseconds "Stamp of a falling edge: nanoseconds above"
    annotation(Placement(transformation(extent = {{100, -78}, {120, -58}})));
  Interfaces.RealOutput stamped_falling_low_word(unit = "1")
    "Stamp in nanoseconds, its low 32 bits"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  Boolean rose "The last rising edge is past";
  Boolean fell "The last falling edge is past";
  Boolean level_in "Level at the terminal now";
  Boolean level_start(start = false, fixed = true) "Level when the simulation began";
  EdgeQueue rising_path(transit = rise_delay) "Input circuit for rising edges"
    annotation(Placement(transformation(extent = {{-72, 21}, {-34, 59}})));
  EdgeQueue falling_path(transit = fall_delay) "Input circuit for falling edges"
    annotation(Placement(transformation(extent = {{-19, 21}, {19, 59}})));
  LevelFilter filter(rest_time = filter_time) "Filter"
    annotation(Placement(transformation(extent = {{34, 21}, {72, 59}})));
  EdgeStamp rising(
    multiplier = 16807,
    spread = jitter,
    random_seed = seed,
    error = clock_error,
    epoch_seconds = clock_seconds,
    epoch_nanoseconds = clock_nanoseconds,
    hold_first = keep_first)
    "Stamps rising edges"
    annotation(Placement(transformation(extent = {{-72, -59}, {-34, -21}})));
  EdgeStamp falling(
    multiplier = 48271,
    spread = jitter,
    random_seed = seed,
    error = clock_error,
    epoch_seconds = clock_seconds,
    epoch_nanoseconds = clock_nanoseconds,
    hold_first = keep_first)
    "Stamps falling edges"
    annotation(Placement(transformation(extent = {{-19, -59}, {19, -21}})));
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
  connect(rising.low_word, stamped_rising_low_word)
    annotation(Line(points = {{-32, -57}, {34, -57}, {34, 0}, {100, 0}}, color = {0, 0, 127}));
  stamped_falling_count = falling.count;
  stamped_falling_seconds = falling.seconds;
  stamped_falling_nanoseconds = falling.nanoseconds;
  connect(falling.low_word, stamped_falling_low_word)
    annotation(Line(points = {{21, -57}, {60, -57}, {60, -90}, {100, -90}}, color = {0, 0, 127}));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -40}, {-30, -40}, {-30, 40}, {30, 40}, {30, -40}, {80, -40}},
          color = {255, 0, 255}),
      Rectangle(extent = {{-20, -90}, {20, -55}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>The inputs are the outputs of a probe for the same communication step. From them the level at each
instant follows exactly: after the later of the last two edges that are past; before both it is the
level that the earlier one ended. So the stamps do not depend on the length of the step.</p>
<p>Equation: stamp = edge + delay + filter time on the clock. Chain: delay of the input circuit, different for the two directions (EdgeQueue); filter
(LevelFilter); stamp of the filtered edge (EdgeStamp).</p>
<p>Assumptions: the inputs of a step are set before the step. Limits: one rising and one falling edge
in a communication step reach the terminal, of more the last ones; at most four edges of one direction
within the delay. Source: as for the parts.</p>
</html>"));
end DigitalInput;
