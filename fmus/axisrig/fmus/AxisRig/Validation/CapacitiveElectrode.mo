within AxisRig.Validation;
model CapacitiveElectrode "An electrode that comes down over an inclined plane beside an edge"
  extends Icons.Experiment;
  parameter Units.Angle inclination = 0.2 "Of the surface"
    annotation(Dialog(group = "Parameters"));
  Sensors.CapacitiveElectrode electrode(
    radius = 2e-3,
    tilt_excess = 4,
    nonlinearity = 0.02,
    full_scale = 5.5e-3)
    "Electrode"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Position averaged "Distance of a plane with the same capacitance";
  output Units.Position seen "With the whole tilt error";
  output Units.Position linearised "What the electronics report";
protected
  Units.Position gap "Below the centre";
  Units.Position rise "Of the surface over the radius";
equation
  gap = 6e-3 - 4e-3*time;
  rise = 2e-3*tan(inclination);
  electrode.gaps[1] = gap;
  electrode.gaps[2] = gap - sqrt(2/3)*rise;
  electrode.gaps[3] = gap + sqrt(2/3)*rise;
  electrode.gaps[4] = gap - sqrt(1/6)*rise;
  electrode.gaps[5] = gap + sqrt(1/6)*rise;
  electrode.gaps[6] = gap - sqrt(1/6)*rise;
  electrode.gaps[7] = gap + sqrt(1/6)*rise;
  electrode.slope_x = tan(inclination);
  electrode.slope_y = 0;
  electrode.lost = 0.3*time;
  averaged = electrode.averaged;
  seen = electrode.seen;
  linearised = electrode.linearised;
  annotation(
    experiment(StopTime=1, Interval=1e-2),
    Documentation(info="<html>
<p>From 6 to 2 mm while up to 30 % of the disc are lost. The first gaps are above the range. Compared: all three distances.</p>
</html>"));
end CapacitiveElectrode;
