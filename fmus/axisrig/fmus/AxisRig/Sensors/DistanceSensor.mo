within AxisRig.Sensors;
model DistanceSensor "Capacitive distance sensor at a nozzle above a workpiece"
  extends MovingSensor;
  parameter Units.Length range(min = 1e-6) = 10e-3 "Full scale"
    annotation(Dialog(group = "Electrode"));
  parameter Units.Length electrode_radius(min = 1e-6) = 2e-3 "Radius of the electrode"
    annotation(Dialog(group = "Electrode"));
  parameter Real tilt_factor(unit = "1", min = 1, max = 20) = 1
    "Tilt error over that of small angles; ideal disc: 1, real ones: about 5"
    annotation(Dialog(group = "Electrode"));
  parameter Real residual(unit = "1", min = -1, max = 1) = 0 "Share of nonlinearity that is left"
    annotation(Dialog(group = "Electrode"));
  parameter Integer order(min = 0, max = 2) = 1 "Order of the filter; 0: none"
    annotation(Dialog(group = "Filter"));
  parameter Units.Frequency bandwidth(min = 1) = 1000 "Corner or natural frequency of the filter"
    annotation(Dialog(group = "Filter"));
  parameter Units.DampingRatio damping = 0.7 "Of the second order"
    annotation(Dialog(group = "Filter"));
  parameter Units.Length noise = 0 "Standard deviation at noise_distance; grows with d^2"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Length noise_distance(min = 1e-6) = 1e-3 "Distance at which noise is stated"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Time noise_period(min = 1e-6) = 100e-6 "From one random number to the next"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Integer seed(min = 0, max = 1000000) = 1 "Of the noise"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Position lift = 0 "By how much the workpiece rises; negative: it sinks"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Time lift_begin = 0 "When it begins to"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Time lift_end = 0 "When it is there; not after lift_begin: a step"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Position lift_2 = 0 "A second time, on top of the first"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Time lift_2_begin = 0 "When it begins to"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Time lift_2_end = 0 "When it is there; not after lift_2_begin: a step"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Position sway = 0 "Amplitude with which the workpiece goes up and down"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Frequency sway_frequency = 1 "How often"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Time sway_begin = 0 "When it begins to"
    annotation(Dialog(group = "Motion of the workpiece"));
  parameter Units.Time lost_begin = 0 "When the signal is lost"
    annotation(Dialog(group = "Loss of the signal"));
  parameter Units.Time lost_end = 0 "When it is back; not after lost_begin: it is never lost"
    annotation(Dialog(group = "Loss of the signal"));
  Workpieces.Workpiece workpiece(points = 7, slopes = 1) "What lies below"
    annotation(Placement(transformation(extent = {{-67, -34}, {-39, -6}})));

  Interfaces.PositionOutput distance "What the sensor reports"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.PositionOutput distance_true "From the nozzle straight down to the surface"
    annotation(Placement(transformation(extent = {{100, 50}, {120, 70}})));
  Interfaces.BooleanOutput valid "Within the range, not over an edge, and not lost"
    annotation(Placement(transformation(extent = {{100, 20}, {120, 40}})));
  Interfaces.BooleanOutput touching "The nozzle touches the workpiece"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
  Interfaces.TimeOutput touch_time(start = 0, fixed = true) "Last instant at which it touched"
    annotation(Placement(transformation(extent = {{100, -40}, {120, -20}})));
  Interfaces.IntegerOutput touch_count(start = 0, fixed = true) "How often it has touched"
    annotation(Placement(transformation(extent = {{100, -70}, {120, -50}})));
  Interfaces.LengthOutput clearance "Distance that the nozzle can move without touching or leaving"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  constant Units.Length rounding = 1e-13 "By how much two steps may disagree where they meet";
  constant Units.Length smallest = 1e-12 "Below it a length counts as this";
  constant Real wide(unit = "1") = 0.816496580927726 "sqrt(2/3)";
  constant Real near(unit = "1") = 0.408248290463863 "sqrt(1/6)";
  constant Real far(unit = "1") = 0.7071067811865476 "sqrt(1/2)";
  Units.Position nearest "Smallest gap";
  Units.Length upright "Distance to the height at which a touch begins or ends";
  Units.Length to_axis "From the axis of the hole, not 0";
  Units.Length hole_radius "Radius of the hole, not 0";
  Real lost_hole(unit = "1") "Share of the disc above the hole";
  Real side(unit = "1") "Where the wall cuts the disc, -1..1";
  Real lost_side(unit = "1") "Share of the disc outside edge or side";
  Real lost(unit = "1") "Share of the disc without material below";
  Boolean is_lost "There is no signal now";
  Workpieces.Movement movement(
    lift = lift,
    lift_begin = lift_begin,
    lift_end = lift_end,
    lift_2 = lift_2,
    lift_2_begin = lift_2_begin,
    lift_2_end = lift_2_end,
    sway = sway,
    sway_frequency = sway_frequency,
    sway_begin = sway_begin)
    "Motion of the workpiece"
    annotation(Placement(transformation(extent = {{-14, -34}, {14, -6}})));
  CapacitiveElectrode electrode(
    radius = electrode_radius,
    tilt_excess = tilt_factor - 1,
    nonlinearity = residual,
    full_scale = range)
    "Electrode"
    annotation(Placement(transformation(extent = {{39, -34}, {67, -6}})));
  SensorFilter filter(number = order, corner = bandwidth, damping_ratio = damping) "Filter"
    annotation(Placement(transformation(extent = {{-67, -74}, {-39, -46}})));
  // Without noise no number is drawn: the first would come after 1e6 s, longer than any run. Products,
  // since compilers fix parameters that decide an if; noise below 1e-30 is none. A filter keeps the
  // instants, at which its internal steps end.
  SampledNoise noise_source(
    period = noise_period + 1e6*max(0, 1 - 1e30*abs(noise) - order),
    random_seed = seed)
    "Random numbers"
    annotation(Placement(transformation(extent = {{-14, -74}, {14, -46}})));
equation
  connect(x.position, workpiece.x[1])
    annotation(Line(points = {{-32, 45}, {-50, 45}, {-50, -7}, {-68, -7}}, color = {0, 0, 127}));
  workpiece.x[2] = x.position + wide*electrode_radius;
  workpiece.x[3] = x.position - wide*electrode_radius;
  workpiece.x[4] = x.position + near*electrode_radius;
  workpiece.x[5] = x.position - near*electrode_radius;
  workpiece.x[6] = x.position + near*electrode_radius;
  workpiece.x[7] = x.position - near*electrode_radius;
  connect(y.position, workpiece.y[1])
    annotation(Line(points = {{21, 45}, {-24, 45}, {-24, -33}, {-68, -33}}, color = {0, 0, 127}));
  connect(y.position, workpiece.y[2])
    annotation(Line(points = {{21, 45}, {-24, 45}, {-24, -33}, {-68, -33}}, color = {0, 0, 127}));
  connect(y.position, workpiece.y[3])
    annotation(Line(points = {{21, 45}, {-24, 45}, {-24, -33}, {-68, -33}}, color = {0, 0, 127}));
  workpiece.y[4] = y.position + far*electrode_radius;
  workpiece.y[5] = y.position + far*electrode_radius;
  workpiece.y[6] = y.position - far*electrode_radius;
  workpiece.y[7] = y.position - far*electrode_radius;
  for i in 1:7 loop
    electrode.gaps[i] = z.position - workpiece.height[i] - movement.height;
  end for;
  distance_true = z.position - workpiece.height[1] - movement.height;
  nearest = min(electrode.gaps[1], min(
    min(min(electrode.gaps[2], electrode.gaps[3]), min(electrode.gaps[4], electrode.gaps[5])),
    min(electrode.gaps[6], electrode.gaps[7])));
  to_axis = max(smallest, workpiece.hole.from_axis);
  hole_radius = max(smallest, workpiece.hole.radius);
  lost_hole = (electrode_radius^2*acos(max(-1, min(1,
      (to_axis^2 + electrode_radius^2 - hole_radius^2)/(2*to_axis*electrode_radius))))
    + hole_radius^2*acos(max(-1, min(1,
      (to_axis^2 + hole_radius^2 - electrode_radius^2)/(2*to_axis*hole_radius))))
    - 0.5*sqrt(max(0, (electrode_radius + hole_radius - to_axis)
      *(to_axis + electrode_radius - hole_radius)*(to_axis - electrode_radius + hole_radius)
      *(to_axis + electrode_radius + hole_radius))))/(Constants.pi*electrode_radius^2);
  side = max(-1, min(1, -max(workpiece.border.beyond, workpiece.cylinder.beyond)/electrode_radius));
  lost_side = (acos(side) - side*sqrt(1 - side^2))/Constants.pi;
  lost = min(1, lost_hole + lost_side);
  connect(workpiece.slope_x[1], electrode.slope_x)
    annotation(Line(points = {{-38, -16}, {38, -16}}, color = {0, 0, 127}));
  connect(workpiece.slope_y[1], electrode.slope_y)
    annotation(Line(points = {{-38, -24}, {38, -24}}, color = {0, 0, 127}));
  electrode.lost = lost;
  is_lost = time >= lost_begin and time < lost_end;
  filter.u = if is_lost then range elseif touching then 0 else electrode.linearised;
  valid = electrode.seen < range and not is_lost;
  touching = nearest <= (if pre(touching) then rounding else 0) and lost < 1;
  when touching then
    touch_time = time;
    touch_count = pre(touch_count) + 1;
  end when;
  distance = if touching and not is_lost then 0
    else max(0, min(range, filter.y + noise*(filter.y/noise_distance)^2*noise_source.y));
  upright = max(0, abs(distance_true) - workpiece.steepest*electrode_radius)
    /sqrt(1 + workpiece.steepest^2);
  // Below the top a touch begins and ends at the wall too, where the disc is wholly outside it.
  clearance = noEvent(if distance_true > 0 then upright
    else min(upright, abs(workpiece.beyond - electrode_radius)));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-30, 80}, {30, 80}, {10, 20}, {-10, 20}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 20}, {0, -50}}, color = {255, 0, 0}),
      Rectangle(extent = {{-80, -80}, {80, -56}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: the gaps at seven points of the electrode give a distance (CapacitiveElectrode), which
is limited to 0..range, filtered (SensorFilter) and disturbed: distance = y + noise (y/d_n)^2 g(k), g a
normal number that changes every noise_period (SampledNoise). The capacitance falls with 1/d, so that a
constant noise of the electronics is one of the distance that grows with d^2.</p>
<p>Edge and hole: the share of the disc without material adds no capacitance; it is the area that a
straight wall cuts off a circle, or the lens that two circles have in common. When too little is left,
the output runs to full scale and valid is false, at once, before the filter. When a point of the
electrode is on the surface, the electrode is short-circuited: the output is 0 at once, and touching is
true.</p>
<p>The workpiece may move in time (Workpieces.Movement). From lost_begin to lost_end there is no signal:
the output runs to full scale as over a hole, whatever is below.</p>
<p>clearance: with the largest slope L no touch begins or ends within (|d| - L r)/sqrt(1 + L^2); below
the top (d negative) neither within the way to where the disc is just outside the material, |e - r| with
the distance e of Workpiece. Changes of valid and motions of the workpiece are not in it.</p>
<p>Assumptions: electrode level in x, y; tip and electrode are one. Limits: see CapacitiveElectrode;
touching looks at the seven points; beside an edge the surface is continued, so that leaving the
material sideways below its top still touches until the whole disc is outside; edge and hole shall not
cut the disc at the same place. Source: plate capacitor; circular segment and lens.</p>
</html>"));
end DistanceSensor;
