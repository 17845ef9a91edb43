within AxisRig.Sensors;
block EdgeStamp "Time stamp of rising edges from a distributed clock"
  constant Real multiplier(unit = "1") = 16807 "16807 or 48271: two sequences of random numbers";
  parameter Units.Time spread(min = 0) = 0 "Largest deviation of a stamp to either side"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Integer random_seed(min = 0, max = 1000000) = 0 "Of the deviations"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Time error = 0 "Clock of the terminal minus reference clock"
    annotation(Dialog(group = "Clock"));
  parameter Integer epoch_seconds(min = 0) = 0 "Reference clock at time 0: seconds since 2000"
    annotation(Dialog(group = "Clock"));
  parameter Integer epoch_nanoseconds(min = 0, max = 999999999) = 0
    "Reference clock at time 0: nanoseconds above"
    annotation(Dialog(group = "Clock"));
  parameter Boolean hold_first = false "Holds the first edge until rearm, else the last one"
    annotation(Dialog(group = "Parameters"));
  Interfaces.BooleanInput u "Signal"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.BooleanInput rearm "A rising edge makes room for the next first edge"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.IntegerOutput count(start = 0, fixed = true) "Rising edges since the start"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.IntegerOutput seconds "Stamp: whole seconds since 2000-01-01"
    annotation(Placement(transformation(extent = {{100, 20}, {120, 40}})));
  Interfaces.IntegerOutput nanoseconds "Stamp: nanoseconds above, 0..999999999"
    annotation(Placement(transformation(extent = {{100, -40}, {120, -20}})));
  Interfaces.RealOutput low_word(unit = "1") "Stamp in nanoseconds, its low 32 bits"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  constant Real modulus(unit = "1") = 2147483647 "Of the random numbers, 2^31 - 1";
  constant Real second_ns(unit = "1") = 1e9 "A second in nanoseconds";
  constant Real word(unit = "1") = 4294967296 "2^32";
  constant Real half_word_ns(unit = "1") = 3388997632 "65536 s in nanoseconds, its low 32 bits";
  Real random(unit = "1") "Random number of the next edge, times the modulus";
  Real stamp(unit = "1", start = 0, fixed = true) "Stamp in nanoseconds since time 0";
  Boolean full(start = false, fixed = true) "A first edge is held";
initial equation
  pre(random) = mod(multiplier*(1 + mod(742938285*random_seed, modulus - 1)), modulus);
equation
  when u then
    count = pre(count) + 1;
    random = mod(multiplier*pre(random), modulus);
    stamp = if pre(full) then pre(stamp)
      else floor((time + error + spread*(2*pre(random)/modulus - 1))*second_ns + 0.5);
  end when;
  // full says it all: the compiler fixes a parameter that decides an if together with pre().
  when u then
    full = hold_first;
  elsewhen rearm then
    full = false;
  end when;
  seconds = epoch_seconds + integer((stamp + epoch_nanoseconds)/second_ns);
  nanoseconds = integer(stamp + epoch_nanoseconds
    - second_ns*floor((stamp + epoch_nanoseconds)/second_ns));
  low_word = mod(half_word_ns*floor(seconds/65536) + second_ns*mod(seconds, 65536) + nanoseconds,
    word);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-40, -40}, {40, 40}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 0}, {0, 32}}, color = {0, 0, 0}),
      Line(points = {{0, 0}, {20, -14}}, color = {0, 0, 0}),
      Line(points = {{-90, -60}, {0, -60}, {0, -44}}, color = {255, 0, 255}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: stamp = clock at time 0 + round(t + error + spread (2 u(k) - 1)), u(k) uniform
within 0..1 (the sequence of EdgeQueue). Distributed clocks count 64 bit nanoseconds since
2000-01-01; neither FMI 2.0 nor a double holds that, so that it is given as two whole numbers,
seconds and nanoseconds; both are exact until 2068. low_word is what devices with 32 bits show; it
wraps every 4.294967296 s. Before the first edge the stamp is that of time 0.</p>
<p>hold_first: the first edge since the last rising edge of rearm is held, as a terminal does that
stamps single events; else the last edge counts.</p>
<p>Assumption: one nanosecond of resolution. Limit: no drift of the clock within the run. Source:
IEC 61158-4-12 (EtherCAT), distributed clocks; time stamping input terminals.</p>
</html>"));
end EdgeStamp;
