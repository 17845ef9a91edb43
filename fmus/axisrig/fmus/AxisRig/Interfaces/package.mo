within AxisRig;
package Interfaces "How components are joined"
  connector Flange "Point of a machine that moves along one axis"
    Units.Position s "Absolute position of the point";
    flow Units.Force f "Force into the component";
    annotation(
      Documentation(info="<html>
<p>Joined flanges have one position and their forces add up to zero. The velocity is not carried:
a component that needs it writes <code>v = der(flange.s)</code>, which keeps the connector balanced
(one flow per potential variable).</p>
</html>"));
  end Flange;
  annotation(
    Documentation(info="<html><p>Connectors of the mechanical parts.</p></html>"));
end Interfaces;
