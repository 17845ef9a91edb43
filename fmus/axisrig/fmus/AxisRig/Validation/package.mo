within AxisRig;
package Validation "One experiment for each component, compared with a stored reference"
  annotation(
    Documentation(info="<html>
<p>Compared signals and tolerances: <code>tests/fmus/validation/signals.csv</code>. The references beside
it come from scripts that are written from the physics and import nothing of the exporter.</p>
</html>"));
end Validation;
