within AxisRig;
package Sensors "Sensors that read positions and never act back on the machine"
  annotation(
    Documentation(info="<html><p>Touch probe and its parts.</p></html>"));
end Sensors;
