within AxisRig;
package Constants "Numbers of mathematics and nature"
  final constant Real pi(unit = "1") = 3.141592653589793
    "Half the circumference of the unit circle";
  final constant Units.Acceleration standard_gravity = 9.80665
    "Standard acceleration of free fall";
  annotation(
    Documentation(info="<html>
<p>One place for each number. Sources: pi as the nearest double; standard acceleration: 3rd CGPM
(1901), SI brochure.</p>
</html>"));
end Constants;
