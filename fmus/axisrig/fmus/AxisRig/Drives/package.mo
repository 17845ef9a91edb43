within AxisRig;
package Drives "Drive controllers and the axes they move"
  annotation(
    Documentation(info="<html><p>The parts of a drive, its cascade and complete axes.</p></html>"));
end Drives;
