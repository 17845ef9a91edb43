within AxisRig;
package Drives "Drive controllers and the axes they move"
  annotation(
    Documentation(info="<html><p>The cascade of a servo drive and the complete axis.</p></html>"));
end Drives;
