within AxisRig.Sensors;
partial model TiltedSensor "Distance sensor at a tool that can be inclined, over a workpiece"
  Interfaces.TimeInput step_time "Beginning of the communication step"
    annotation(Placement(transformation(extent = {{-112, 84}, {-100, 96}})));
  Interfaces.TimeInput step_size(start = 1e-3, min = 1e-9) "Length of the communication step"
    annotation(Placement(transformation(extent = {{-112, 70}, {-100, 82}})));
  parameter Units.Length tool_length = 80e-3 "Length of the tool that is not inclined"
    annotation(Dialog(group = "Tool"));
  parameter Integer quantity(min = 0, max = 2) = 0
    "Measured: 0 the distance along the tool, 1 the orthogonal distance, 2 what an electrode gives"
    annotation(Dialog(group = "Electrode"));
  parameter Units.Length range(min = 1e-6) = 0.5 "Full scale"
    annotation(Dialog(group = "Electrode"));
  parameter Units.Length electrode_radius(min = 1e-6) = 2e-3 "Radius of the electrode"
    annotation(Dialog(group = "Electrode"));
  parameter Real tilt_factor(unit = "1", min = 1, max = 20) = 1
    "Tilt error over that of small angles; ideal disc: 1, real ones: about 5"
    annotation(Dialog(group = "Electrode"));
  parameter Real residual(unit = "1", min = -1, max = 1) = 0 "Share of nonlinearity that is left"
    annotation(Dialog(group = "Electrode"));
  parameter Integer order(min = 0, max = 2) = 0 "Order of the filter; 0: none"
    annotation(Dialog(group = "Filter"));
  parameter Units.Frequency bandwidth(min = 1) = 1000 "Corner or natural frequency of the filter"
    annotation(Dialog(group = "Filter"));
  parameter Units.DampingRatio damping = 0.7 "Of the second order"
    annotation(Dialog(group = "Filter"));
  parameter Units.Length noise = 0 "Standard deviation at noise_distance; grows with d^2"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Length noise_distance(min = 1e-6) = 80e-3 "Distance at which noise is stated"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Time noise_period(min = 1e-6) = 100e-6 "From one random number to the next"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Integer seed(min = 0, max = 1000000) = 1 "Of the noise"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Angle workpiece_tilt_x(min = -1.5, max = 1.5) = 0
    "Tilt of the whole workpiece about X, before that about Y"
    annotation(Dialog(group = "Place of the workpiece"));
  parameter Units.Angle workpiece_tilt_y(min = -1.5, max = 1.5) = 0
    "Tilt of the whole workpiece about Y"
    annotation(Dialog(group = "Place of the workpiece"));
  parameter Units.Position workpiece_x = 0 "Origin of the workpiece: x"
    annotation(Dialog(group = "Place of the workpiece"));
  parameter Units.Position workpiece_y = 0 "Origin of the workpiece: y"
    annotation(Dialog(group = "Place of the workpiece"));
  parameter Units.Position workpiece_z = 0 "Origin of the workpiece: z"
    annotation(Dialog(group = "Place of the workpiece"));
  parameter Units.Position lift = 0 "By how much the workpiece rises along its own z"
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
  Workpieces.Workpiece workpiece(points = 72, slopes = 72) "What the tool points at"
    annotation(Placement(transformation(extent = {{-67, -34}, {-39, -6}})));
  Kinematics.ToolExtension extension(nominal = tool_length) "Virtual length of the tool"
    annotation(Placement(transformation(extent = {{39, -74}, {67, -46}})));

  Interfaces.PositionOutput distance "What the sensor reports"
    annotation(Placement(transformation(extent = {{100, 84}, {112, 96}})));
  Interfaces.PositionOutput distance_true
    "Orthogonal distance: from the clamping point to the nearest point of the surface"
    annotation(Placement(transformation(extent = {{100, 70}, {112, 82}})));
  Interfaces.PositionOutput distance_along "From the clamping point to the surface, along the tool"
    annotation(Placement(transformation(extent = {{100, 56}, {112, 68}})));
  Interfaces.PositionOutput clamping_x "Clamping point: x"
    annotation(Placement(transformation(extent = {{100, 42}, {112, 54}})));
  Interfaces.PositionOutput clamping_y "Clamping point: y"
    annotation(Placement(transformation(extent = {{100, 29}, {112, 41}})));
  Interfaces.PositionOutput clamping_z "Clamping point: z"
    annotation(Placement(transformation(extent = {{100, 15}, {112, 27}})));
  Interfaces.PositionOutput tcp_x "Tool centre point: x"
    annotation(Placement(transformation(extent = {{100, 1}, {112, 13}})));
  Interfaces.PositionOutput tcp_y "Tool centre point: y"
    annotation(Placement(transformation(extent = {{100, -13}, {112, -1}})));
  Interfaces.PositionOutput tcp_z "Tool centre point: z"
    annotation(Placement(transformation(extent = {{100, -27}, {112, -15}})));
  Interfaces.AngleOutput tilt "Inclination of the tool against z of the machine"
    annotation(Placement(transformation(extent = {{100, -41}, {112, -29}})));
  Interfaces.LengthOutput virtual_length "Length of the tool with its virtual extension"
    annotation(Placement(transformation(extent = {{100, -54}, {112, -42}})));
  Interfaces.BooleanOutput valid "In the range, with material in front of the tool, not lost"
    annotation(Placement(transformation(extent = {{100, -68}, {112, -56}})));
  Interfaces.BooleanOutput touching "The clamping point touches the workpiece"
    annotation(Placement(transformation(extent = {{100, -82}, {112, -70}})));
  Interfaces.TimeOutput touch_time(start = 0, fixed = true) "Last instant at which it touched"
    annotation(Placement(transformation(extent = {{100, -91}, {112, -79}})));
  Interfaces.IntegerOutput touch_count(start = 0, fixed = true) "How often it has touched"
    annotation(Placement(transformation(extent = {{100, -100}, {112, -88}})));
protected
  constant Integer beam = 5 "Newton steps along the tool; points 2 to 6";
  constant Integer below = 7 "Point straight below, in the frame of the workpiece";
  constant Integer side = 7 "Points of the search to either side, from 8 and from 15 on";
  constant Integer corner = 22 "First of the two corners of the ramp";
  constant Integer line = 7 "Places that a search on the line looks at";
  constant Integer chain = 24 "First point of the first of three searches on the line";
  constant Integer newton = 2 "Newton steps in the plane";
  constant Integer plane = 66 "First point of the search in the plane";
  constant Units.Length rounding = 1e-13 "By how much two steps may disagree where they meet";
  constant Units.Length near = 1e-6 "Between points whose slopes are compared";
  constant Units.Length smallest = 1e-12 "Below it a length counts as this";
  constant Real flat(unit = "1") = 0.05 "A bend below it is taken for this";
  constant Real steep(unit = "1") = 0.01 "A tool closer to level than this sees nothing";
  constant Real wide(unit = "1") = 0.816496580927726 "sqrt(2/3)";
  constant Real half_wide(unit = "1") = 0.408248290463863 "sqrt(1/6)";
  Real cos_x(unit = "1") "Of the tilt about X";
  Real sin_x(unit = "1") "Of the tilt about X";
  Real cos_y(unit = "1") "Of the tilt about Y";
  Real sin_y(unit = "1") "Of the tilt about Y";
  // What rises the most decides in which direction the nearest point is looked for.
  Real twice_x(unit = "1") "x of the direction of the search with twice its angle";
  Real twice_y(unit = "1") "y of the direction of the search with twice its angle";
  Units.Angle search "Direction of the search, from x towards y of the workpiece";
  Real search_x(unit = "1") "x of it";
  Real search_y(unit = "1") "y of it";
  Units.Length bounded "By how much surfaces can rise that have a top";
  Units.Length unbounded "By how much the others can";
  Units.Length window "How far to the side the nearest point can be";
  Units.Length spacing "Between the points of the search";
  Real passed(unit = "1") "Share of the step that has passed";
  Real u_x(unit = "1") "Direction of the tool: x";
  Real u_y(unit = "1") "Direction of the tool: y";
  Real u_z(unit = "1") "Direction of the tool: z";
  Units.Position p_x "Clamping point in the frame of the workpiece: x";
  Units.Position p_y "Clamping point in the frame of the workpiece: y";
  Units.Position p_z "Clamping point in the frame of the workpiece, less its lift: z";
  Real b_x(unit = "1") "Direction of the beam in the frame of the workpiece: x";
  Real b_y(unit = "1") "Direction of the beam in the frame of the workpiece: y";
  Real b_z(unit = "1") "Direction of the beam in the frame of the workpiece: z";
  Real falls(unit = "1") "How steeply the beam falls, not 0";
  Units.Position way[6] "Along the beam, from step to step";
  Real closing[5](each unit = "1") "By how much the gap closes for each length of the beam";
  Units.Position gap "Straight down in the frame of the workpiece; negative: below the surface";
  Real square[17](each unit = "m2") "Squared distances of points of the search";
  Real least_left[7](each unit = "m2") "Least so far on the left";
  Real least_right[7](each unit = "m2") "Least so far on the right";
  Units.Position at_left[7] "Where on the left";
  Units.Position at_right[7] "Where on the right";
  Units.Position trial[3, 7] "Places that three searches on the line look at";
  Units.Position line_e[3, 7] "Height of the surface above the clamping point there";
  Units.Slope line_slope[3, 7] "Its slope along the line there";
  Units.Position line_f[3, 7] "Slope of half the squared distance there";
  Real line_bend[3, 7](each unit = "1") "Bend of half the squared distance there";
  Real line_square[3, 7](each unit = "m2") "Squared distance there";
  Units.Position best_at[3, 7] "Best place so far";
  Units.Position best_f[3, 7] "Slope of half the squared distance at it";
  Real best_bend[3, 7](each unit = "1") "Bend of half the squared distance at it";
  Real best_square[3, 7](each unit = "m2") "Squared distance at it";
  Units.Length longest[3, 7] "Longest next step";
  Units.Position q_x[3] "Way of the search in the plane: x";
  Units.Position q_y[3] "Way of the search in the plane: y";
  Units.Position e[2] "Height of the surface above the clamping point";
  Units.Position f_x[2] "Slope of half the squared distance: x";
  Units.Position f_y[2] "Slope of half the squared distance: y";
  Real j_xx[2](each unit = "1") "Bend of half the squared distance: x, x";
  Real j_xy[2](each unit = "1") "Bend of half the squared distance: x, y";
  Real j_yy[2](each unit = "1") "Bend of half the squared distance: y, y";
  Real lifted[2](each unit = "1") "What is added so that the bend is upwards everywhere";
  Real determinant[2](each unit = "1") "Of the bend";
  Units.Position step_x[2] "Newton step: x";
  Units.Position step_y[2] "Newton step: y";
  Real shorter[2](each unit = "1") "Share of the step that is taken";
  Units.Position best_of_three "Best place on the line";
  Real nearest(unit = "m2") "Least squared distance";
  Units.Position orthogonal "Distance from the surface; negative: below it";
  Real slant(unit = "1") "Cosine between tool and normal, times length of the normal";
  Real incidence(unit = "1") "Tangent of the angle between tool and normal where the beam hits";
  Units.Position along "Along the tool, within 0..range";
  Units.Position measured "What is measured, within 0..range";
  Boolean is_lost "There is no signal now";
  Boolean is_hit "There is material in front of the tool";
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
  // As in DistanceSensor: without noise no number is drawn.
  SampledNoise noise_source(
    period = noise_period + 1e6*max(0, 1 - 1e30*abs(noise) - order),
    random_seed = seed)
    "Random numbers"
    annotation(Placement(transformation(extent = {{-14, -74}, {14, -46}})));
equation
  passed = (time - step_time)/step_size;
  tilt = atan2(sqrt(u_x^2 + u_y^2), u_z);
  extension.tilt = tilt;
  virtual_length = extension.length;
  tcp_x = clamping_x - virtual_length*u_x;
  tcp_y = clamping_y - virtual_length*u_y;
  tcp_z = clamping_z - virtual_length*u_z;
  cos_x = cos(workpiece_tilt_x);
  sin_x = sin(workpiece_tilt_x);
  cos_y = cos(workpiece_tilt_y);
  sin_y = sin(workpiece_tilt_y);
  // Into the frame of the workpiece, Ry(tilt_y) Rx(tilt_x)
  p_x = cos_y*(clamping_x - workpiece_x) - sin_y*(clamping_z - workpiece_z);
  p_y = sin_y*sin_x*(clamping_x - workpiece_x) + cos_x*(clamping_y - workpiece_y)
    + cos_y*sin_x*(clamping_z - workpiece_z);
  p_z = sin_y*cos_x*(clamping_x - workpiece_x) - sin_x*(clamping_y - workpiece_y)
    + cos_y*cos_x*(clamping_z - workpiece_z) - movement.height;
  b_x = -(cos_y*u_x - sin_y*u_z);
  b_y = -(sin_y*sin_x*u_x + cos_x*u_y + cos_y*sin_x*u_z);
  b_z = -(sin_y*cos_x*u_x - sin_x*u_y + cos_y*cos_x*u_z);
  // Straight down
  workpiece.x[below] = p_x;
  workpiece.y[below] = p_y;
  gap = p_z - workpiece.height[below];
  // Along the tool: the beam meets the surface
  falls = max(steep, -b_z);
  way[1] = gap/falls;
  for i in 1:beam loop
    workpiece.x[i + 1] = p_x + way[i]*b_x;
    workpiece.y[i + 1] = p_y + way[i]*b_y;
    closing[i] = max(0.1*falls,
      falls + workpiece.slope_x[i + 1]*b_x + workpiece.slope_y[i + 1]*b_y);
    way[i + 1] = way[i] + (p_z - way[i]*falls - workpiece.height[i + 1])/closing[i];
  end for;
  workpiece.x[1] = p_x + way[beam + 1]*b_x;
  workpiece.y[1] = p_y + way[beam + 1]*b_y;
  // The nearest point: first on a line
  twice_x = workpiece.ramp.steepest*cos(2*workpiece.ramp.azimuth)
    + workpiece.step.steepest*cos(2*workpiece.step.azimuth)
    + workpiece.sine.steepest*cos(2*workpiece.sine.azimuth)
    + workpiece.waviness.steepest*cos(2*workpiece.waviness.azimuth)
    + workpiece.inclined.steepest*cos(2*workpiece.inclined.azimuth)
    + min(1, workpiece.cylinder.steepest)*cos(2*workpiece.cylinder.azimuth);
  twice_y = workpiece.ramp.steepest*sin(2*workpiece.ramp.azimuth)
    + workpiece.step.steepest*sin(2*workpiece.step.azimuth)
    + workpiece.sine.steepest*sin(2*workpiece.sine.azimuth)
    + workpiece.waviness.steepest*sin(2*workpiece.waviness.azimuth)
    + workpiece.inclined.steepest*sin(2*workpiece.inclined.azimuth)
    + min(1, workpiece.cylinder.steepest)*sin(2*workpiece.cylinder.azimuth);
  search = 0.5*atan2(twice_y, twice_x + smallest);
  search_x = cos(search);
  search_y = sin(search);
  bounded = abs(workpiece.ramp.rise) + abs(workpiece.step.rise) + 2*abs(workpiece.sine.amplitude)
    + 2*sum(abs(workpiece.waviness.amplitude[i]) for i in 1:4);
  unbounded = 1e3*(workpiece.inclined.steepest + workpiece.cylinder.steepest);
  window = min(2*abs(gap)*workpiece.steepest/(1 + workpiece.steepest^2),
    sqrt(max(0, gap^2 - max(0, abs(gap) - bounded - unbounded)^2)));
  spacing = window/side;
  for i in 1:side loop
    workpiece.x[below + i] = p_x - i*spacing*search_x;
    workpiece.y[below + i] = p_y - i*spacing*search_y;
    workpiece.x[below + side + i] = p_x + i*spacing*search_x;
    workpiece.y[below + side + i] = p_y + i*spacing*search_y;
  end for;
  workpiece.x[corner] = p_x + (workpiece.ramp.start - workpiece.ramp.s[below])
    *cos(workpiece.ramp.azimuth);
  workpiece.y[corner] = p_y + (workpiece.ramp.start - workpiece.ramp.s[below])
    *sin(workpiece.ramp.azimuth);
  workpiece.x[corner + 1] = p_x + (workpiece.ramp.start + workpiece.ramp.length
    - workpiece.ramp.s[below])*cos(workpiece.ramp.azimuth);
  workpiece.y[corner + 1] = p_y + (workpiece.ramp.start + workpiece.ramp.length
    - workpiece.ramp.s[below])*sin(workpiece.ramp.azimuth);
  for i in 1:2*side + 2 loop
    square[i] = (workpiece.x[below + i] - p_x)^2 + (workpiece.y[below + i] - p_y)^2
      + (workpiece.height[below + i] - p_z)^2;
  end for;
  least_left[1] = square[1];
  at_left[1] = -spacing;
  least_right[1] = square[side + 1];
  at_right[1] = spacing;
  for i in 2:side loop
    least_left[i] = min(least_left[i - 1], square[i]);
    at_left[i] = noEvent(if square[i] < least_left[i - 1] then -i*spacing else at_left[i - 1]);
    least_right[i] = min(least_right[i - 1], square[side + i]);
    at_right[i] = noEvent(if square[side + i] < least_right[i - 1] then i*spacing
      else at_right[i - 1]);
  end for;
  // Then by Newton's method on the line, from below and from the best point to either side; a step
  // that makes it worse is not taken, and the next one is shorter
  trial[1, 1] = 0;
  trial[2, 1] = at_left[side];
  trial[3, 1] = at_right[side];
  for k in 1:3 loop
    for i in 1:line loop
      workpiece.x[chain + 2*(line*(k - 1) + i - 1)] = p_x + trial[k, i]*search_x;
      workpiece.y[chain + 2*(line*(k - 1) + i - 1)] = p_y + trial[k, i]*search_y;
      workpiece.x[chain + 1 + 2*(line*(k - 1) + i - 1)] = p_x + (trial[k, i] + near)*search_x;
      workpiece.y[chain + 1 + 2*(line*(k - 1) + i - 1)] = p_y + (trial[k, i] + near)*search_y;
      line_e[k, i] = workpiece.height[chain + 2*(line*(k - 1) + i - 1)] - p_z;
      line_slope[k, i] = search_x*workpiece.slope_x[chain + 2*(line*(k - 1) + i - 1)]
        + search_y*workpiece.slope_y[chain + 2*(line*(k - 1) + i - 1)];
      line_f[k, i] = trial[k, i] + line_e[k, i]*line_slope[k, i];
      line_bend[k, i] = max(flat, 1 + line_slope[k, i]^2 + line_e[k, i]/near
        *(search_x*workpiece.slope_x[chain + 1 + 2*(line*(k - 1) + i - 1)]
          + search_y*workpiece.slope_y[chain + 1 + 2*(line*(k - 1) + i - 1)]
          - line_slope[k, i]));
      line_square[k, i] = trial[k, i]^2 + line_e[k, i]^2;
    end for;
    best_at[k, 1] = trial[k, 1];
    best_f[k, 1] = line_f[k, 1];
    best_bend[k, 1] = line_bend[k, 1];
    best_square[k, 1] = line_square[k, 1];
    longest[k, 1] = spacing;
    for i in 2:line loop
      trial[k, i] = best_at[k, i - 1]
        - max(-longest[k, i - 1], min(longest[k, i - 1], best_f[k, i - 1]/best_bend[k, i - 1]));
      best_at[k, i] = noEvent(if line_square[k, i] < best_square[k, i - 1] then trial[k, i]
        else best_at[k, i - 1]);
      best_f[k, i] = noEvent(if line_square[k, i] < best_square[k, i - 1] then line_f[k, i]
        else best_f[k, i - 1]);
      best_bend[k, i] = noEvent(if line_square[k, i] < best_square[k, i - 1]
        then line_bend[k, i] else best_bend[k, i - 1]);
      best_square[k, i] = min(line_square[k, i], best_square[k, i - 1]);
      longest[k, i] = noEvent(if line_square[k, i] < best_square[k, i - 1] then longest[k, i - 1]
        else 0.3*longest[k, i - 1]);
    end for;
  end for;
  // At last in the plane, from the best of the three
  q_x[1] = p_x + search_x*best_of_three;
  q_y[1] = p_y + search_y*best_of_three;
  best_of_three = noEvent(
    if best_square[1, line] <= min(best_square[2, line], best_square[3, line])
    then best_at[1, line]
    elseif best_square[2, line] <= best_square[3, line] then best_at[2, line]
    else best_at[3, line]);
  for i in 1:newton loop
    workpiece.x[plane + 3*(i - 1)] = q_x[i];
    workpiece.y[plane + 3*(i - 1)] = q_y[i];
    workpiece.x[plane + 1 + 3*(i - 1)] = q_x[i] + near;
    workpiece.y[plane + 1 + 3*(i - 1)] = q_y[i];
    workpiece.x[plane + 2 + 3*(i - 1)] = q_x[i];
    workpiece.y[plane + 2 + 3*(i - 1)] = q_y[i] + near;
    e[i] = workpiece.height[plane + 3*(i - 1)] - p_z;
    f_x[i] = q_x[i] - p_x + e[i]*workpiece.slope_x[plane + 3*(i - 1)];
    f_y[i] = q_y[i] - p_y + e[i]*workpiece.slope_y[plane + 3*(i - 1)];
    j_xx[i] = 1 + workpiece.slope_x[plane + 3*(i - 1)]^2 + e[i]/near
      *(workpiece.slope_x[plane + 1 + 3*(i - 1)] - workpiece.slope_x[plane + 3*(i - 1)]);
    j_xy[i] = workpiece.slope_x[plane + 3*(i - 1)]*workpiece.slope_y[plane + 3*(i - 1)]
      + e[i]/near
      *(workpiece.slope_y[plane + 1 + 3*(i - 1)] - workpiece.slope_y[plane + 3*(i - 1)]);
    j_yy[i] = 1 + workpiece.slope_y[plane + 3*(i - 1)]^2 + e[i]/near
      *(workpiece.slope_y[plane + 2 + 3*(i - 1)] - workpiece.slope_y[plane + 3*(i - 1)]);
    lifted[i] = max(0, flat - 0.5*(j_xx[i] + j_yy[i])
      + sqrt(0.25*(j_xx[i] - j_yy[i])^2 + j_xy[i]^2));
    determinant[i] = (j_xx[i] + lifted[i])*(j_yy[i] + lifted[i]) - j_xy[i]^2;
    step_x[i] = -((j_yy[i] + lifted[i])*f_x[i] - j_xy[i]*f_y[i])/determinant[i];
    step_y[i] = -((j_xx[i] + lifted[i])*f_y[i] - j_xy[i]*f_x[i])/determinant[i];
    shorter[i] = min(1, spacing/max(smallest, sqrt(step_x[i]^2 + step_y[i]^2)));
    q_x[i + 1] = q_x[i] + shorter[i]*step_x[i];
    q_y[i + 1] = q_y[i] + shorter[i]*step_y[i];
  end for;
  workpiece.x[plane + 3*newton] = q_x[newton + 1];
  workpiece.y[plane + 3*newton] = q_y[newton + 1];
  square[2*side + 3] = (q_x[newton + 1] - p_x)^2 + (q_y[newton + 1] - p_y)^2
    + (workpiece.height[plane + 3*newton] - p_z)^2;
  nearest = min(min(best_square[1, line], min(best_square[2, line], best_square[3, line])),
    min(square[2*side + 1], min(square[2*side + 2], square[2*side + 3])));
  // The condition moves because compilers fix parameters that alone decide an if. A level
  // workpiece needs no search.
  orthogonal = noEvent(if workpiece.steepest*(1 + p_x^2) > 0 then
    (if gap < 0 then -sqrt(nearest) else sqrt(nearest)) else gap);
  distance_true = orthogonal;
  distance_along = way[beam + 1];
  // Tangent plane where the beam hits, seen from the tool
  slant = max(steep, -(b_z - workpiece.slope_x[1]*b_x - workpiece.slope_y[1]*b_y));
  incidence = sqrt(max(0,
    1 + workpiece.slope_x[1]^2 + workpiece.slope_y[1]^2 - slant^2))/slant;
  along = max(0, min(range, distance_along));
  electrode.gaps[1] = along;
  electrode.gaps[2] = along + wide*electrode_radius*incidence;
  electrode.gaps[3] = along - wide*electrode_radius*incidence;
  electrode.gaps[4] = along + half_wide*electrode_radius*incidence;
  electrode.gaps[5] = along - half_wide*electrode_radius*incidence;
  electrode.gaps[6] = along + half_wide*electrode_radius*incidence;
  electrode.gaps[7] = along - half_wide*electrode_radius*incidence;
  electrode.slope_x = incidence;
  electrode.slope_y = 0;
  electrode.lost = 0;
  measured = max(0, min(range, 0.5*(1 - quantity)*(2 - quantity)*along
    + quantity*(2 - quantity)*orthogonal
    + 0.5*quantity*(quantity - 1)*electrode.linearised));
  is_lost = time >= lost_begin and time < lost_end;
  is_hit = -b_z > steep and workpiece.beyond <= 0;
  filter.u = if is_lost or not is_hit then range elseif touching then 0 else measured;
  valid = measured < range and is_hit and not is_lost;
  touching = gap <= (if pre(touching) then rounding else 0) and workpiece.beyond <= 0;
  when touching then
    touch_time = time;
    touch_count = pre(touch_count) + 1;
  end when;
  distance = if touching and not is_lost then 0
    else max(0, min(range, filter.y + noise*(filter.y/noise_distance)^2*noise_source.y));
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Polygon(points = {{-60, 70}, {-20, 90}, {10, 20}, {-10, 10}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{0, 15}, {35, -60}}, color = {255, 0, 0}),
      Rectangle(extent = {{-80, -80}, {80, -60}}, fillColor = {200, 170, 120},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equations: the beam leaves the clamping point against the direction u of the tool; the workpiece is turned
as a whole by Ry(tilt_y) Rx(tilt_x) about its origin, and moves along its own z (Movement).</p>
<p>distance_true is the distance from the clamping point to the nearest point of the surface, negative below it.
Over a workpiece without slopes it is exact in closed form. Else 14 points to either side, as far as the
nearest point can be, the corners of a ramp, and three searches by Newton's method (7 places on a line along
what rises the most, then 2 steps in the plane; bend of the surface from slopes 1 um apart) give candidates. The
least distance counts, so that the number is never too small. Error (tests/fmus/test_tilted_sensor.py, against
scipy): below 1e-9 m for each single surface while gap times largest curvature stays below 50, and for
mixtures of surfaces in different directions while it stays below 0.3; above that the nearest of several places
can be missed, for a flank of 1 mm and 2.8 mm height 80 mm below the tool by up to 0.1 mm.</p>
<p>distance_along is found by 5 Newton steps, exact on planes; error below 1e-9 m while slope times tangent of
the inclination stays below 0.1.</p>
<p>Measured is the distance along the tool, the orthogonal one, or what a disc electrode across the tool gives
(CapacitiveElectrode over the tangent plane where the beam hits). Filter, noise and loss as DistanceSensor.</p>
<p>Limits: borders take the signal away at once when the beam passes them, and the surface is continued
for distance_true; the first point where the beam meets the surface is not looked for where it meets it more
than once; touching looks at the clamping point alone.</p>
</html>"));
end TiltedSensor;
