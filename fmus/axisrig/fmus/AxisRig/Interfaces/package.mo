within AxisRig;
package Interfaces "How components are joined"
  connector Flange "Point of a machine that moves along one axis"
    Units.Position s "Absolute position of the point";
    flow Units.Force f "Force into the component";
    annotation(
      Icon(graphics = {
        Rectangle(extent = {{-100, -100}, {100, 100}}, lineColor = {0, 127, 0},
          fillColor = {0, 127, 0}, fillPattern = FillPattern.Solid)}),
      Documentation(info="<html>
<p>Joined flanges have one position and their forces add up to zero. The velocity is not carried:
a component that needs it writes <code>v = der(flange.s)</code>, which keeps the connector balanced
(one flow per potential variable).</p>
</html>"));
  end Flange;
  connector PositionInput = input Units.Position "Position that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector PositionOutput = output Units.Position "Position that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector LengthOutput = output Units.Length "Length that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector VelocityInput = input Units.Velocity "Velocity that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector VelocityOutput = output Units.Velocity "Velocity that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector AccelerationInput = input Units.Acceleration "Acceleration that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector AccelerationOutput = output Units.Acceleration "Acceleration that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector TimeInput = input Units.Time "Instant or duration that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector TimeOutput = output Units.Time "Instant or duration that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector ForceInput = input Units.Force "Force that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector ForceOutput = output Units.Force "Force that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector TorqueInput = input Units.Torque "Torque that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector TorqueOutput = output Units.Torque "Torque that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector AngleInput = input Units.Angle "Angle that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector AngleOutput = output Units.Angle "Angle that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector AngularVelocityInput = input Units.AngularVelocity
    "Angular velocity that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector AngularVelocityOutput = output Units.AngularVelocity
    "Angular velocity that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector AngularAccelerationInput = input Units.AngularAcceleration
    "Angular acceleration that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector SlopeInput = input Units.Slope "Slope that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector SlopeOutput = output Units.Slope "Slope that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector ShareInput = input Units.Share "Share that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector DirectionInput = input Units.Direction
    "Component of a unit vector that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector DirectionOutput = output Units.Direction
    "Component of a unit vector that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector RealInput = input Real(unit = "1") "Number that a component takes" annotation(
    Icon(graphics = {Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
          fillColor = {0, 0, 127}, fillPattern = FillPattern.Solid)}));
  connector RealOutput = output Real(unit = "1") "Number that a component gives" annotation(
    Icon(graphics = {Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {0, 0, 127},
          fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector BooleanInput = input Boolean "Level that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {255, 0, 255},
        fillColor = {255, 0, 255}, fillPattern = FillPattern.Solid)}));
  connector BooleanOutput = output Boolean "Level that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {255, 0, 255},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  connector IntegerInput = input Integer "Whole number that a component takes"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {255, 127, 0},
        fillColor = {255, 127, 0}, fillPattern = FillPattern.Solid)}));
  connector IntegerOutput = output Integer "Whole number that a component gives"
    annotation(Icon(graphics = {
      Polygon(points = {{-100, 100}, {100, 0}, {-100, -100}}, lineColor = {255, 127, 0},
        fillColor = {255, 255, 255}, fillPattern = FillPattern.Solid)}));
  annotation(
    Documentation(info="<html>
<p>Flange joins mechanical parts. Every input and output of a block is a connector of its quantity, full
for an input, hollow for an output; blue are real numbers, pink levels, orange whole numbers. They are
plain <code>input Real</code> and <code>output Real</code> with a unit, so that blocks of other libraries can be
joined to them.</p>
</html>"));
end Interfaces;
