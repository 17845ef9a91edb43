within AxisRig;
package Examples "Complete experiments that any Modelica tool can run"
  annotation(
    Documentation(info="<html><p>Each example states what must come out.</p></html>"));
end Examples;
