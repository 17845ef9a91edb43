within AxisRig;
package Mechanics "Moving parts"
  annotation(
    Documentation(info="<html>
<p>Slide, guideway friction and fixed stop, joined by flanges.</p>
</html>"));
end Mechanics;
