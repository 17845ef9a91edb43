within AxisRig.Validation;
model ThreeLegSeat "Pre-travel while the normal turns"
  extends Icons.Experiment;
  Sensors.ThreeLegSeat seat(
    force = 2.5,
    length = 50e-3,
    radius = 10e-3,
    angle = 0.2,
    bending = 0.2e6,
    axial = 2e6)
    "Seat of the stylus"
    annotation(Placement(transformation(extent = {{-20, -20}, {20, 20}})));
  output Units.Length pretravel "From contact to the first lifting pad";
equation
  seat.normal_x = sin(1.6*time)*cos(9*time);
  seat.normal_y = sin(1.6*time)*sin(9*time);
  seat.normal_z = cos(1.6*time);
  pretravel = seat.pretravel;
  annotation(
    experiment(StopTime=1, Interval=1e-2),
    Documentation(info="<html>
<p>From the axis of the stylus to the horizontal, turning one and a half times. Compared: pretravel.</p>
</html>"));
end ThreeLegSeat;
