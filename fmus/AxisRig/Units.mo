within AxisRig;
package Units "SI types, so that every variable carries its unit"
  type Time = Real(quantity = "Time", unit = "s");
  type Position = Real(quantity = "Length", unit = "m");
  type Length = Real(quantity = "Length", unit = "m", min = 0);
  type Velocity = Real(quantity = "Velocity", unit = "m/s");
  type Angle = Real(quantity = "Angle", unit = "rad");
  type Slope = Real(unit = "1") "Height per length";
  type DampingRatio = Real(unit = "1", min = 0) "Damping over critical damping";
  type Force = Real(quantity = "Force", unit = "N");
  type Mass = Real(quantity = "Mass", unit = "kg", min = 0);
  type Inertia = Real(quantity = "MomentOfInertia", unit = "kg.m2", min = 0);
  type Frequency = Real(quantity = "Frequency", unit = "Hz", min = 0);
  type Rate = Real(unit = "1/s", min = 0) "Gain of a loop from position to velocity";
  type Stiffness = Real(unit = "N/m", min = 0);
  type Exponent = Real(unit = "1", min = 1) "Power of the penetration";
  type Damping = Real(unit = "N.s/m", min = 0) "Force per velocity";
  type ContactDamping = Real(unit = "s/m", min = 0) "Share of the spring force per velocity";
  type Share = Real(unit = "1", min = 0, max = 1);
  type Direction = Real(unit = "1", min = -1, max = 1) "Component of a unit vector";
  annotation(
    Documentation(info="<html>
<p>Only base units and their products: no prefix, no display unit. Source: SI brochure, 9th
edition.</p>
</html>"));
end Units;
