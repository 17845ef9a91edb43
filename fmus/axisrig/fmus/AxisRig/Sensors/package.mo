within AxisRig;
package Sensors "Sensors that read positions and never act back on the machine"
  annotation(
    Documentation(info="<html>
<p>Touch probes, distance sensor, second encoder, digital input, and their parts. Sensors that look at
three axes have the inputs of MovingSensor.</p>
</html>"));
end Sensors;
