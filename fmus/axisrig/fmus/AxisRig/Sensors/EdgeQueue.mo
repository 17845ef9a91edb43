within AxisRig.Sensors;
block EdgeQueue "Rising edges under way, first in first out, at most four"
  constant Real multiplier(unit = "1") = 16807 "16807 or 48271: two sequences of random numbers";
  parameter Units.Time transit(min = 0) = 0 "How long an edge is under way"
    annotation(Dialog(group = "Parameters"));
  parameter Units.Time spread(min = 0) = 0 "Largest deviation of it to either side"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Integer seed(min = 0, max = 1000000) = 0 "Of the deviations"
    annotation(Dialog(group = "Noise and jitter"));
  Interfaces.BooleanInput u "Input"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.IntegerOutput arrived(start = 0, fixed = true) "Number of edges that have arrived"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.BooleanOutput waiting "An edge is under way"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  constant Units.Time never = 1e60 "Later than any run";
  constant Real modulus(unit = "1") = 2147483647 "Of the random numbers, 2^31 - 1";
  Integer sent(start = 0, fixed = true) "Number of edges that have left";
  Integer write_slot(start = 0, fixed = true) "Next slot to fill";
  Integer read_slot(start = 0, fixed = true) "Slot of the next arrival";
  Units.Time due_0(start = never, fixed = true) "When the edge in slot 0 arrives";
  Units.Time due_1(start = never, fixed = true) "When the edge in slot 1 arrives";
  Units.Time due_2(start = never, fixed = true) "When the edge in slot 2 arrives";
  Units.Time due_3(start = never, fixed = true) "When the edge in slot 3 arrives";
  Units.Time last_due(start = -never, fixed = true) "When the edge sent last arrives";
  Real random(unit = "1") "Random number of the next edge, times the modulus";
  Units.Time due "When an edge that leaves now arrives";
  Units.Time next "When the next edge arrives";
initial equation
  pre(random) = mod(multiplier*(1 + mod(742938285*seed, modulus - 1)), modulus);
equation
  due = max(pre(last_due), time + max(0, transit + spread*(2*pre(random)/modulus - 1)));
  when u then
    sent = pre(sent) + 1;
    write_slot = if pre(write_slot) > 2 then 0 else pre(write_slot) + 1;
    due_0 = if pre(write_slot) == 0 then due else pre(due_0);
    due_1 = if pre(write_slot) == 1 then due else pre(due_1);
    due_2 = if pre(write_slot) == 2 then due else pre(due_2);
    due_3 = if pre(write_slot) == 3 then due else pre(due_3);
    last_due = due;
    random = mod(multiplier*pre(random), modulus);
  end when;
  next = if pre(read_slot) < 1 then due_0 elseif pre(read_slot) < 2 then due_1
    elseif pre(read_slot) < 3 then due_2
    else due_3;
  when sent > pre(arrived) and time >= next then
    arrived = pre(arrived) + 1;
    read_slot = if pre(read_slot) > 2 then 0 else pre(read_slot) + 1;
  end when;
  waiting = sent > arrived;
  assert(sent - arrived < 5, "more than four edges of one direction are under way");
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-70, -20}, {-40, 20}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-35, -20}, {-5, 20}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{0, -20}, {30, 20}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{35, -20}, {65, 20}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: edge k arrives at max(t_k + max(0, transit + spread (2 s(k)/m - 1)), arrival of edge k - 1),
with m = 2^31 - 1, s(k + 1) = a s(k) mod m, s(0) = a (1 + 742938285 seed mod (m - 1)) mod m. Products
stay below 2^53, so that doubles hold them exactly. Seed 0 and a = 16807 give the sequence of the
source.</p>
<p>Assumption: deviations are uniform; numbers need to look random, not to be secret. Limit: four
slots hold the instants of arrival. Source: S. K. Park, K. W. Miller, Random number generators: good
ones are hard to find, Communications of the ACM 31 (1988); the multiplier 48271 in 36 (1993); that of
the seed: G. S. Fishman, L. R. Moore, SIAM J. Sci. Stat. Comput. 7 (1986).</p>
</html>"));
end EdgeQueue;
