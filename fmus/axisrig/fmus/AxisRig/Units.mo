within AxisRig;
package Units "SI types, so that every variable carries its unit"
  type Time = Real(quantity = "Time", unit = "s") "Instant or duration";
  type Position = Real(quantity = "Length", unit = "m", displayUnit = "mm")
    "Place on an axis, or a difference of two"
    annotation(__axisrig(nominal = 0.1));
  type Length = Real(quantity = "Length", unit = "m", displayUnit = "mm", min = 0)
    "Length, never negative"
    annotation(__axisrig(nominal = 0.01));
  type Velocity = Real(quantity = "Velocity", unit = "m/s", displayUnit = "mm/min")
    "Rate of a position"
    annotation(__axisrig(nominal = 0.1));
  type Angle = Real(quantity = "Angle", unit = "rad", displayUnit = "deg");
  type Slope = Real(unit = "1") "Height per length";
  type DampingRatio = Real(unit = "1", min = 0) "Damping over critical damping";
  type Acceleration = Real(quantity = "Acceleration", unit = "m/s2") "Rate of a velocity";
  type Force = Real(quantity = "Force", unit = "N") "Force, or its amount at a linear axis"
    annotation(__axisrig(nominal = 1000));
  type Mass = Real(quantity = "Mass", unit = "kg", min = 0)
    annotation(__axisrig(nominal = 100));
  type Inertia = Real(quantity = "MomentOfInertia", unit = "kg.m2", min = 0) "Moment of inertia";
  type Frequency = Real(quantity = "Frequency", unit = "Hz", min = 0)
    "Frequency, in periods per second";
  type Rate = Real(unit = "1/s", min = 0) "Gain of a loop from position to velocity";
  type Stiffness = Real(unit = "N/m", min = 0) "Force per length"
    annotation(__axisrig(nominal = 1e8));
  type Modulus = Real(quantity = "Pressure", unit = "N/m2", min = 0) "Stress per strain"
    annotation(__axisrig(nominal = 1e11));
  type Exponent = Real(unit = "1", min = 1) "Power of the penetration";
  type Damping = Real(unit = "N.s/m", min = 0) "Force per velocity"
    annotation(__axisrig(nominal = 1e4));
  type ContactDamping = Real(unit = "s/m", min = 0) "Share of the spring force per velocity";
  type AngularVelocity = Real(quantity = "AngularVelocity", unit = "rad/s") "Rate of an angle";
  type Torque = Real(quantity = "Torque", unit = "N.m")
    annotation(__axisrig(nominal = 100));
  type AngularAcceleration = Real(quantity = "AngularAcceleration", unit = "rad/s2")
    "Rate of an angular velocity";
  type TorsionalStiffness = Real(unit = "N.m/rad", min = 0) "Torque per angle"
    annotation(__axisrig(nominal = 1e6));
  type TorsionalDamping = Real(unit = "N.m.s/rad", min = 0) "Torque per angular velocity";
  type Ratio = Real(unit = "1", min = 0) "Ratio of two values of one quantity";
  type Voltage = Real(quantity = "Voltage", unit = "V");
  type Current = Real(quantity = "Current", unit = "A");
  type Resistance = Real(quantity = "Resistance", unit = "Ohm", min = 0) "Electrical resistance";
  type Inductance = Real(quantity = "Inductance", unit = "H", min = 0) "Electrical inductance";
  type TorqueConstant = Real(unit = "N.m/A", min = 0) "Also the voltage per angular velocity";
  type TorsionalContactDamping = Real(unit = "s/rad", min = 0)
    "Share of the spring torque per angular velocity";
  type Share = Real(unit = "1", min = 0, max = 1) "Part of a whole";
  type Direction = Real(unit = "1", min = -1, max = 1) "Component of a unit vector";
  annotation(
    Documentation(info="<html>
<p>Values are in base units and their products, without a prefix; tools may show lengths in mm,
velocities in mm/min and angles in degrees. Usual magnitudes are in the annotation
<code>__axisrig(nominal)</code>, for the FMUs: the attribute would make the compiler keep every alias of
a variable. Source: SI brochure, 9th edition.</p>
</html>"));
end Units;
