within;
// SPDX-License-Identifier: Apache-2.0
package AxisRig "Plants of a CNC axis under test: servo axes and the sensors that watch them"
  annotation(
    version = "0.2.0",
    versionDate = "2026-11-29",
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, lineColor = {0, 0, 127},
          fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-80, -50}, {80, -30}}, fillColor = {128, 128, 128},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-40, -30}, {30, 20}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{-5, 20}, {-5, 60}}),
      Ellipse(extent = {{-15, 60}, {5, 80}}, fillColor = {255, 0, 0},
          fillPattern = FillPattern.Solid)}),
    Documentation(info="<html>
<p>Plain Modelica without any other library. All quantities are in SI units; the unit of each variable is
in its type (package <code>Units</code>). <code>UsersGuide</code> says how the parts are meant,
<code>Examples</code> has complete experiments.</p>
<p>Shown to read or compile it: rumoca 0.10.2 compiles every model, pymoca 0.12.0 reads every file
(<code>tests/fmus/test_library_language.py</code>). The same test asks OpenModelica where <code>omc</code> is
installed.</p>
<p>Which models become an FMU is in <code>fmus/axisrig/fmus/models.csv</code>. Everything else is a part of them,
a validation or an example.</p>
<p>Licence: Apache-2.0.</p>
</html>"));
end AxisRig;
