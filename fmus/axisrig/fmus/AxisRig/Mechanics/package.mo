within AxisRig;
package Mechanics "Moving parts"
  annotation(
    Documentation(info="<html>
<p>Masses, friction, stops, brake, elastic joints and beam, joined by flanges.</p>
</html>"));
end Mechanics;
