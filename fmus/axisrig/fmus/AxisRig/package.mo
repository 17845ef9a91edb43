within;
package AxisRig "Plants of a CNC axis under test: servo axes and the sensors that watch them"
  annotation(
    Documentation(info="<html>
<p>Plain Modelica without any other library, so that every tool can load it. All quantities are in
SI units; the unit of each variable stands in its type (package <code>Units</code>).</p>
<p>Which models become an FMU stands in <code>fmus/axisrig/fmus/models.csv</code>. Everything else is a part of them,
a validation or an example.</p>
</html>"));
end AxisRig;
