within AxisRig;
package Sensors "Sensors that read positions and never act back on the machine"
  annotation(
    Documentation(info="<html>
<p>Touch probes, distance sensors, second encoder, digital input, and their parts. Sensors that look at
three axes have the inputs of MovingSensor; those at an inclined tool (TiltedSensor) have a kinematic of package
Kinematics in them and the same four inputs for each axis.</p>
</html>"));
end Sensors;
