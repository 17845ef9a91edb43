within AxisRig.Drives;
block PositionController "Proportional position loop with a share of velocity feed-forward"
  parameter Units.Rate kv = 10 "Velocity demand per position error"
    annotation(Dialog(group = "Position loop"));
  parameter Units.Share feed_forward = 0 "Share f of the demanded velocity that is added"
    annotation(Dialog(group = "Position loop"));
  Interfaces.PositionInput demand_position "Position demand"
    annotation(Placement(transformation(extent = {{-120, 80}, {-100, 100}})));
  Interfaces.VelocityInput demand_velocity "Velocity of the demand"
    annotation(Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
  Interfaces.PositionInput position "Position of the motor encoder"
    annotation(Placement(transformation(extent = {{-120, -100}, {-100, -80}})));
  Interfaces.VelocityOutput velocity_reference "Demand for the velocity loop"
    annotation(Placement(transformation(extent = {{100, -10}, {120, 10}})));
equation
  velocity_reference = kv*(demand_position - position) + feed_forward*demand_velocity;
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Text(extent = {{-80, -40}, {80, 40}}, textString = "P"),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: v_ref = Kv (x_d - x) + f v_d.</p>
<p>With a velocity loop without steady error the lag in steady motion is (1 - f) v/Kv.
Assumption: continuous controller. Limit: the sampling of the position loop is left out.</p>
<p>Source: H. Gross, J. Hamann, G. Wiegaertner, Electrical Feed Drives in Automation, chapter on
position control.</p>
</html>"));
end PositionController;
