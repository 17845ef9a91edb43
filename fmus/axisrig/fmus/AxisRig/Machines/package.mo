within AxisRig;
package Machines "Axis and sensor in one model, for a master that knows neither"
  annotation(
    Documentation(info="<html>
<p>A sensor in an FMU of its own wants the motion of each communication step, which only a master can give
that knows of it. Here the sensor reads the axis at every instant: the interface is that of an axis, and
the sensor has outputs only. Edges have an instant and a number, so that a step of any length loses none.</p>
</html>"));
end Machines;
