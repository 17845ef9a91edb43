within AxisRig.Validation;
model ToolExtension "A tool that tilts beyond both limits of its extension"
  extends Icons.Experiment;
  Kinematics.ToolExtension extension(nominal = 82e-3, hd2 = 0.5, hd3 = 1.1)
    "Extension under test"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Length length "Length now";
equation
  extension.tilt = 1.4*time;
  length = extension.length;
  annotation(
    experiment(StopTime=1, Interval=1.3e-2),
    Documentation(info="<html>
<p>Constant, extended, frozen. Compared: the length.</p>
</html>"));
end ToolExtension;
