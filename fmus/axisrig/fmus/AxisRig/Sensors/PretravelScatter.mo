within AxisRig.Sensors;
block PretravelScatter "By how much the pre-travel of each touch differs from the usual one"
  parameter Units.Length scatter(min = 0) = 0 "Standard deviation from touch to touch"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Position first = 0 "More in the first touch than in the later ones"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Position drift = 0 "More with every touch"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Position least = -1e3 "The difference is never below it"
    annotation(Dialog(group = "Parameters"));
  parameter Integer random_seed(min = 0, max = 1000000) = 1 "Same seed, same numbers"
    annotation(Dialog(group = "Noise and jitter"));
  Interfaces.BooleanInput u "Contact; the next touch is drawn when it ends"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.PositionOutput y "Difference of the touch that is or comes next"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
  final parameter Units.Position first_difference =
    max(least, scatter*first_number + first) "Difference of the first touch";
protected
  constant Real modulus(unit = "1") = 2147483647 "Of the random numbers, 2^31 - 1";
  final parameter Real radius_first(unit = "1") =
    mod(48271*(1 + mod(1226874159*random_seed, modulus - 1)), modulus)
    "State of the first sequence at the first touch";
  final parameter Real angle_first(unit = "1") =
    mod(69621*(1 + mod(62089911*random_seed, modulus - 1)), modulus)
    "State of the second sequence at the first touch";
  final parameter Real first_number(unit = "1") =
    sqrt(-2*log(radius_first/modulus))*cos(2*Constants.pi*angle_first/modulus)
    "Normal number of the first touch";
  Real radius_state(unit = "1") "State of the first sequence";
  Real angle_state(unit = "1") "State of the second sequence";
  Integer ended(start = 0, fixed = true) "Touches that have ended";
  Real number(unit = "1") "Normal number of the touch, with mean 0 and deviation 1";
initial equation
  pre(radius_state) = radius_first;
  pre(angle_state) = angle_first;
  pre(number) = first_number;
equation
  when not u then
    radius_state = mod(48271*pre(radius_state), modulus);
    angle_state = mod(69621*pre(angle_state), modulus);
    number = sqrt(-2*log(mod(48271*pre(radius_state), modulus)/modulus))
      *cos(2*Constants.pi*mod(69621*pre(angle_state), modulus)/modulus);
    ended = pre(ended) + 1;
  end when;
  y = max(least, scatter*number + drift*ended + first*max(0, 1 - ended));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -60}, {80, -60}}, color = {0, 0, 0}),
      Ellipse(extent = {{-75, 25}, {-60, 40}}, fillColor = {0, 0, 127},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-40, -25}, {-25, -10}}, fillColor = {0, 0, 127},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{-5, 0}, {10, 15}}, fillColor = {0, 0, 127},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{30, -15}, {45, 0}}, fillColor = {0, 0, 127},
          fillPattern = FillPattern.Solid),
      Ellipse(extent = {{60, 10}, {75, 25}}, fillColor = {0, 0, 127},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: touch k = 1, 2, ... has max(least, s n(k) + d (k - 1) + f), f only for k = 1, with
n(k) = sqrt(-2 ln(a(k)/m)) cos(2 pi b(k)/m), a(k+1) = 48271 a(k) mod m, b(k+1) = 69621 b(k) mod m,
m = 2^31 - 1, a(0) = 1 + (1226874159 seed mod (m - 1)), b(0) = 1 + (62089911 seed mod (m - 1)).
The number of a touch is there before it and stays until it ends, so that it has one switching point.</p>
<p>Assumptions: touches differ independently and normally; the drift goes with the touches, not with
time. Limits: other multipliers of the seed than EdgeQueue and SampledNoise have, so that one seed
serves a probe without making its radio and its pre-travel alike; products stay below 2^53, so that
doubles hold them exactly.</p>
<p>Source: as SampledNoise; multiplier 69621: S. K. Park, K. W. Miller, P. K. Stockmeyer, Communications
of the ACM 36 (1993); multipliers of the seed: G. S. Fishman, L. R. Moore, SIAM J. Sci. Stat.
Comput. 7 (1986).</p>
</html>"));
end PretravelScatter;
