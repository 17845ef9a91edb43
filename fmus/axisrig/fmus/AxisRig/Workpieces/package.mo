within AxisRig;
package Workpieces "Surfaces that sensors look at: height and slope over x and y"
  annotation(
    Documentation(info="<html>
<p>Each surface gives the height h(x, y) and its analytic derivatives at several points at once, so
that one set of parameters serves a sensor that looks at more than one point. Borders say where the
material ends. <code>Workpiece</code> adds all of them; its start values leave a plane at height 0.
</p>
<p>All are algebraic and make no events: a sensor finds its own.</p>
</html>"));
end Workpieces;
