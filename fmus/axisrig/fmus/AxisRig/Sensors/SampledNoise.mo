within AxisRig.Sensors;
block SampledNoise "Normally distributed numbers that repeat with a seed"
  parameter Units.Time period(min = 1e-6) = 100e-6 "From one number to the next"
    annotation(Dialog(group = "Parameters"));
  parameter Integer random_seed(min = 0, max = 1000000) = 1 "Same seed, same numbers"
    annotation(Dialog(group = "Noise and jitter"));
  Interfaces.RealOutput y(unit = "1", start = 0, fixed = true) "Number with mean 0 and deviation 1"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
protected
  constant Real modulus(unit = "1") = 2147483647 "Of the random numbers, 2^31 - 1";
  Real radius_state(unit = "1") "State of the first sequence";
  Real angle_state(unit = "1") "State of the second sequence";
initial equation
  pre(radius_state) = 1 + mod(742938285*random_seed, modulus - 1);
  pre(angle_state) = 1 + mod(950706376*random_seed, modulus - 1);
equation
  when sample(period, period) then
    radius_state = mod(16807*pre(radius_state), modulus);
    angle_state = mod(48271*pre(angle_state), modulus);
    y = sqrt(-2*log(mod(16807*pre(radius_state), modulus)/modulus))
      *cos(2*Constants.pi*mod(48271*pre(angle_state), modulus)/modulus);
  end when;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, 10}, {-60, 10}, {-60, -30}, {-40, -30}, {-40, 40}, {-20, 40}, {-20,
          -10}, {0, -10}, {0, 55}, {20, 55}, {20, -45}, {40, -45}, {40, 15}, {60, 15}, {60, -20},
          {80, -20}}, color = {0, 0, 127}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: two sequences a(k+1) = 16807 a(k) mod m and b(k+1) = 48271 b(k) mod m, m = 2^31 - 1,
begin with a(0) = 1 + (742938285 seed mod (m - 1)) and b(0) = 1 + (950706376 seed mod (m - 1)); number k,
from k T on, is sqrt(-2 ln(a(k)/m)) cos(2 pi b(k)/m), k = 1, 2, ... Before T it is 0.</p>
<p>Assumption: white noise up to half the rate of the numbers. Limits: the number rests for a period,
so that the spectrum falls with sin(x)/x; period of the sequences 2^31 - 2; products stay below 2^53,
so that doubles hold them exactly.</p>
<p>Source: G. E. P. Box, M. E. Muller, Annals of Mathematical Statistics 29 (1958); S. K. Park, K. W.
Miller, Communications of the ACM 31 (1988) and 36 (1993); multipliers of the seed: G. S. Fishman, L. R.
Moore, SIAM J. Sci. Stat. Comput. 7 (1986).</p>
</html>"));
end SampledNoise;
