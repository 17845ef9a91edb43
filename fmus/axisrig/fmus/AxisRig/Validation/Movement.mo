within AxisRig.Validation;
model Movement "A workpiece that is lifted, lowered and swayed; another that steps"
  extends Icons.Experiment;
  Workpieces.Movement gradual(
    lift = 1.1e-3,
    lift_begin = 0.0503,
    lift_end = 0.1207,
    lift_2 = -0.6e-3,
    lift_2_begin = 0.1011,
    lift_2_end = 0.2203,
    sway = 0.3e-3,
    sway_frequency = 7,
    sway_begin = 0.2503)
    "Lifts by ramps"
    annotation(Placement(transformation(extent = {{-60, -20}, {-20, 20}})));
  Workpieces.Movement sudden(
    lift = 2.8e-3,
    lift_begin = 0.1303,
    lift_2 = -2.7e-3,
    lift_2_begin = 0.2904)
    "Lifts by steps"
    annotation(Placement(transformation(extent = {{20, -20}, {60, 20}})));
  output Units.Position gradual_height "Of the one that is lifted, lowered and swayed";
  output Units.Position sudden_height "Of the one that steps";
equation
  gradual_height = gradual.height;
  sudden_height = sudden.height;
  annotation(
    experiment(StopTime=0.5, Interval=1.003e-3),
    Documentation(info="<html>
<p>Two ramps that overlap and a sine; two steps. Compared: both heights.</p>
</html>"));
end Movement;
