within AxisRig.Mechanics;
partial model PartialFriction "What every friction against the ground has in common"
  Interfaces.Flange flange "Moving side"
    annotation(Placement(transformation(extent = {{-10, -110}, {10, -90}})));
  Units.Velocity velocity "Velocity against the ground";
equation
  velocity = der(flange.s);
  annotation(
    Icon(graphics = {
      Rectangle(extent = {{-100, -100}, {100, 100}}, fillColor = {255, 255, 255},
          fillPattern = FillPattern.Solid),
      Rectangle(extent = {{-50, -50}, {50, 20}}, fillColor = {220, 220, 220},
          fillPattern = FillPattern.Solid),
      Line(points = {{-80, -60}, {80, -60}}, color = {0, 0, 0}),
      Line(points = {{-72, -74}, {-60, -60}}, color = {0, 0, 0}),
      Line(points = {{-52, -74}, {-40, -60}}, color = {0, 0, 0}),
      Line(points = {{-32, -74}, {-20, -60}}, color = {0, 0, 0}),
      Line(points = {{-12, -74}, {0, -60}}, color = {0, 0, 0}),
      Line(points = {{8, -74}, {20, -60}}, color = {0, 0, 0}),
      Line(points = {{28, -74}, {40, -60}}, color = {0, 0, 0}),
      Line(points = {{48, -74}, {60, -60}}, color = {0, 0, 0}),
      Line(points = {{68, -74}, {80, -60}}, color = {0, 0, 0}),
      Text(extent = {{-150, 150}, {150, 110}}, textColor = {0, 0, 255}, textString = "%name")}),
    Documentation(info="<html>
<p>Equation: v = ds/dt. A model that extends this one says how the force of the flange follows.</p>
<p>Assumption: the ground does not move. Limit: one axis, no lateral motion. Source: geometry.</p>
</html>"));
end PartialFriction;
