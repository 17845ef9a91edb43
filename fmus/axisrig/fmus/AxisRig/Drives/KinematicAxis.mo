within AxisRig.Drives;
model KinematicAxis "Axis without mass: the load is where the demand is"
  Interfaces.PositionInput reference_position "Demand at reference_time"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.VelocityInput reference_velocity "Slope of the demand until reference_end"
    annotation(Placement(transformation(extent = {{-120, 35}, {-100, 55}})));
  Interfaces.TimeInput reference_time "Instant of reference_position"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.TimeInput reference_end "Instant from which the demand rests"
    annotation(Placement(transformation(extent = {{-120, -55}, {-100, -35}})));
  Interfaces.BooleanInput enabled(start = false) "Power stage on; off: the axis is at rest"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));

  parameter Units.Position position_start = 0 "Position at the start"
    annotation(Dialog(group = "Start"));
  parameter Units.Length noise = 0 "Standard deviation of what the motor encoder reports"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Units.Time noise_period(min = 1e-6) = 100e-6 "From one random number to the next"
    annotation(Dialog(group = "Noise and jitter"));
  parameter Integer seed(min = 0, max = 1000000) = 1 "Of the noise"
    annotation(Dialog(group = "Noise and jitter"));

  Interfaces.PositionOutput position "Position of the slide (truth)"
    annotation(Placement(transformation(extent = {{100, 80}, {120, 100}})));
  Interfaces.VelocityOutput velocity "Velocity of the slide (truth)"
    annotation(Placement(transformation(extent = {{100, 35}, {120, 55}})));
  Interfaces.PositionOutput motor_position "Motor encoder, in terms of the slide"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
  Interfaces.VelocityOutput motor_velocity "Velocity of the motor encoder, in terms of the slide"
    annotation(Placement(transformation(extent = {{100, -55}, {120, -35}})));
  Interfaces.PositionOutput demand_position "Position demand"
    annotation(Placement(transformation(extent = {{100, -100}, {120, -80}})));
protected
  Units.Position held "Where it rests without power";
  Boolean moving "The demand still moves";
  // Without noise no number is drawn: the first would come after 1e6 s, longer than any run. Products,
  // since compilers fix parameters that decide an if; noise below 1e-30 is none.
  Sensors.SampledNoise noise_source(
    period = noise_period + 1e6*max(0, 1 - 1e30*abs(noise)),
    random_seed = seed)
    "Random numbers"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
initial equation
  pre(held) = position_start;
equation
  moving = time <= reference_end;
  demand_position = reference_position
    + reference_velocity*((if moving then time else reference_end) - reference_time);
  when not enabled then
    held = demand_position;
  end when;
  position = if enabled then demand_position else held;
  velocity = if enabled and moving then reference_velocity else 0;
  motor_position = position + noise*noise_source.y;
  motor_velocity = velocity;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Line(points = {{-70, -50}, {70, -50}}, color = {0, 0, 0}),
      Rectangle(extent = {{-30, -20}, {30, 30}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    experiment(StopTime = 1, Interval = 1e-3, Tolerance = 1e-9),
    Documentation(info="<html>
<p>Equations: with power x(t) = x_r + v_r (min(t, t_end) - t_r), without power x rests where
the demand was when the power went. The motor encoder reports x + s g(k), g a normal number that changes every
noise_period (<code>Sensors.SampledNoise</code>).</p>
<p>For loops whose dead time shall be whole cycles of the fieldbus: nothing but the interpolation of
the demand lies between set and actual position. At reference_end itself the velocity is still that
of the way there.</p>
<p>Assumption: a drive without lag and a brake that closes at once. Limits: no force, no stop, no
other control than that of the position; a demand that steps moves the axis in no time. Source:
definition.</p>
</html>"));
end KinematicAxis;
