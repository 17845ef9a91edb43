within AxisRig.Workpieces;
partial block Border "Where the material ends"
  input Units.Position x "Point: x";
  input Units.Position y "Point: y";
  output Units.Position beyond "Distance from the material; negative: inside it";
  output Units.Slope beyond_x "Derivative of it by x";
  output Units.Slope beyond_y "Derivative of it by y";
  annotation(
    Documentation(info="<html>
<p>What every border offers: the signed distance in the plane x, y from the upright wall at which
the material ends.</p>
</html>"));
end Border;
