within AxisRig;
package Kinematics "Where a tool is and where it points, from the positions of the axes"
  annotation(
    Documentation(info="<html>
<p>Forward transformations of machines with a tool that can be inclined. They are algebraic. Right-handed about
+X, +Y and +Z (ISO 841).</p>
</html>"));
end Kinematics;
