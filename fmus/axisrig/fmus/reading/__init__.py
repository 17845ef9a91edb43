"""From Modelica text to expressions: the compiler's representation, and what is refused."""
