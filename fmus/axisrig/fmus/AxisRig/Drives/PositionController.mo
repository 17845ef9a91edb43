within AxisRig.Drives;
block PositionController "Proportional position loop with a share of velocity feed-forward"
  parameter Units.Rate kv = 10 "Velocity demand per position error";
  parameter Units.Share feed_forward = 0 "Share f of the demanded velocity that is added";
  input Units.Position demand_position "Position demand";
  input Units.Velocity demand_velocity "Velocity of the demand";
  input Units.Position position "Position of the motor encoder";
  output Units.Velocity velocity_reference "Demand for the velocity loop";
equation
  velocity_reference = kv*(demand_position - position) + feed_forward*demand_velocity;
  annotation(
    Documentation(info="<html>
<p>Equation: v_ref = Kv (x_d - x) + f v_d.</p>
<p>With a velocity loop without steady error the lag in steady motion is (1 - f) v/Kv.
Assumption: continuous controller. Limit: the sampling of the position loop is left out.</p>
<p>Source: H. Gross, J. Hamann, G. Wiegaertner, Electrical Feed Drives in Automation, chapter on
position control.</p>
</html>"));
end PositionController;
