within AxisRig;
package Examples "Complete experiments that any Modelica tool can run"
  annotation(
    Documentation(info="<html>
<p>Each example says what must come out. Those with a file in <code>Resources/ReferenceResults</code> are
compared with it at every instant (<code>tests/fmus/test_examples.py</code>).</p>
</html>"));
end Examples;
