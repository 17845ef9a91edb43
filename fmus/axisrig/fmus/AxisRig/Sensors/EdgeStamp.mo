within AxisRig.Sensors;
block EdgeStamp "Time stamp of rising edges from a distributed clock"
  constant Real multiplier(unit = "1") = 16807 "16807 or 48271: two sequences of random numbers";
  parameter Units.Time spread(min = 0) = 0 "Largest deviation of a stamp to either side";
  parameter Integer random_seed(min = 0, max = 1000000) = 0 "Of the deviations";
  parameter Units.Time error = 0 "Clock of the terminal minus reference clock";
  parameter Integer epoch_seconds(min = 0) = 0 "Reference clock at time 0: seconds since 2000";
  parameter Integer epoch_nanoseconds(min = 0, max = 999999999) = 0
    "Reference clock at time 0: nanoseconds above";
  parameter Boolean hold_first = false "Holds the first edge until rearm, else the last one";
  input Boolean u "Signal";
  input Boolean rearm "A rising edge makes room for the next first edge";
  output Integer count(start = 0, fixed = true) "Rising edges since the start";
  output Integer seconds "Stamp: whole seconds since 2000-01-01";
  output Integer nanoseconds "Stamp: nanoseconds above, 0..999999999";
  output Real low_word(unit = "1") "Stamp in nanoseconds, its low 32 bits";
protected
  constant Real modulus(unit = "1") = 2147483647;
  constant Real second_ns(unit = "1") = 1e9;
  constant Real word(unit = "1") = 4294967296;
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
