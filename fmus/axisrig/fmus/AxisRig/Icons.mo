within AxisRig;
package Icons "Icons that several classes share"
  partial class Experiment "A complete experiment: press start"
    annotation(
      Icon(graphics = {
        Ellipse(extent = {{-100, -100}, {100, 100}}, lineColor = {128, 128, 128},
          fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid),
        Polygon(points = {{-36, 60}, {64, 0}, {-36, -60}}, lineColor = {0, 0, 127},
          fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}),
      Documentation(info="<html><p>For models of Examples and Validation.</p></html>"));
  end Experiment;
  annotation(
    Documentation(info="<html><p>Classes without variables, for <code>extends</code>.</p></html>"));
end Icons;
